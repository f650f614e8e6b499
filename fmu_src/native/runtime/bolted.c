#include "bolted.h"

#include <math.h>

#include "tables.h"

enum { PRELOAD, MOMENT, S_REL, V_REL = S_REL + 3 }; /* places of the inputs */

static bool tabulate(Joint *joint, int steps, Text *why)
{
    Kind *kind = &joint->kind;
    return approach_tabulate(&kind->approach, &joint->curve, &kind->spots, joint->c, steps, why);
}

bool kind_tabulate(Joint *joint, Text *why)
{
    joint->kind.tight = false;
    return spots_begin(&joint->kind.spots, joint->c, why) && refined(joint, tabulate, APPROACH_STEPS, why);
}

static double tightening(const Joint *joint, int i, const double *inputs)
{
    const double x[4] = {NODES[i][EQUAL], NODES[i][TILT], inputs[PRELOAD], inputs[MOMENT]};
    double pressure;
    node_pressure(x, joint->c, &pressure);
    return pressure;
}

/* Approach and pressure of the nodes at tightening; kept while preload and moment stay. */
static void tighten(Joint *joint, const double *inputs)
{
    Kind *kind = &joint->kind;
    if (kind->tight && kind->preload == inputs[PRELOAD] && kind->moment == inputs[MOMENT])
        return;
    for (int i = 0; i < N_NODES; i++) {
        double y[2];
        kind->start[i] = curve_inverse(&joint->curve, tightening(joint, i, inputs));
        curve_at(&joint->curve, kind->start[i], 1, y);
        kind->tightened[i] = y[0];
    }
    kind->preload = inputs[PRELOAD];
    kind->moment = inputs[MOMENT];
    kind->tight = true;
}

/* Works of the law at a pressure and their slopes in it; inside the closing those at its end are kept. */
static bool works_at(const Joint *joint, double pressure, double *works, double *slopes, Text *why)
{
    const Kind *kind = &joint->kind;
    const bool closed = pressure > kind->approach.closed;
    const double p = closed ? pressure : kind->approach.closed;
    double u = approach_guess(&kind->approach, &joint->curve, p), state[2 * N_LAW_STATE], rate;
    if (!spots_solve(&kind->spots, joint->c, p, &u, &rate, why))
        return false;
    law_state[spots_regime(&kind->spots, u)](&u, joint->c, state);
    for (int i = 0; i < N_LAW_STATE; i++) {
        works[i] = state[i];
        slopes[i] = closed ? state[N_LAW_STATE + i] / (rate * p) : 0.0;
    }
    return true;
}

/* A node's arguments of node_parts: squares of position, s_rel, tightened, p, k, bend, twist, works. */
enum { X_FIXED = 2, X_TIGHT = 5, X_CURVE = 6, X_WORKS = 10, N_X = 12, N_MOVING = N_X - X_FIXED };

static bool node_state(const Joint *joint, int i, const double *inputs, double *x, double *next, double *slopes,
                       Text *why)
{
    double y[5];
    const double *s_rel = inputs + S_REL;
    curve_at(&joint->curve, joint->kind.start[i] - s_rel[2], 4, y);
    x[0] = NODES[i][X2];
    x[1] = NODES[i][Y2];
    for (int k = 0; k < 3; k++)
        x[X_FIXED + k] = s_rel[k];
    x[X_TIGHT] = joint->kind.tightened[i];
    for (int k = 0; k < 4; k++)
        x[X_CURVE + k] = y[k];
    *next = y[4];
    return works_at(joint, y[0], &x[X_WORKS], slopes, why);
}

bool joint_evaluate(Joint *joint, const double *inputs, double *out, Text *why)
{
    double x[N_OUTPUTS_X] = {0.0}, node[N_X], parts[N_PARTS], next, slopes[N_LAW_STATE], largest = 0.0;
    tighten(joint, inputs);
    for (int i = 0; i < N_NODES; i++) {
        if (!node_state(joint, i, inputs, node, &next, slopes, why))
            return false;
        node_parts(node, joint->c, parts);
        for (int k = 0; k < N_PARTS; k++)
            x[k] += NODES[i][SHARE] * parts[k];
        if (node[X_CURVE] > largest || i == 0)
            largest = node[X_CURVE];
    }
    for (int k = 0; k < 6; k++)
        x[N_PARTS + k] = inputs[S_REL + k];
    x[N_PARTS + 6] = largest;
    outputs(x, joint->c, out);
    return true;
}

/* Derivative of a node's arguments along a seed; returns that of its pressure. */
static double node_seed(const Joint *joint, int i, const double *inputs, const double *seed, const double *x,
                        double next, const double *slopes, double *rate)
{
    const double *curve = x + X_CURVE;
    const double at[6] = {NODES[i][EQUAL], NODES[i][TILT], inputs[PRELOAD], inputs[MOMENT], seed[PRELOAD], seed[MOMENT]};
    double tight, y[2];
    node_pressure_seed(at, joint->c, &tight);
    curve_at(&joint->curve, joint->kind.start[i], 1, y);
    if (!(y[1] > 0.0))
        tight = 0.0; /* an open node stays open */
    const double approach = (y[1] > 0.0 ? tight / y[1] : 0.0) - seed[S_REL + 2];
    for (int k = 0; k < 3; k++)
        rate[k] = seed[S_REL + k];
    rate[3] = tight;
    for (int k = 0; k < 3; k++)
        rate[4 + k] = curve[k + 1] * approach;
    rate[7] = next * approach;
    for (int k = 0; k < N_LAW_STATE; k++)
        rate[8 + k] = slopes[k] * rate[4];
    return rate[4];
}

void joint_derivative(Joint *joint, const double *inputs, const double *seed, double *result)
{
    enum { N = N_OUTPUTS_X };
    double x[2 * N] = {0.0}, node[N_X + N_MOVING], parts[N_PARTS], next, slopes[N_LAW_STATE];
    double largest = 0.0, largest_rate = 0.0;
    Text ignored;
    text_clear(&ignored);
    tighten(joint, inputs);
    for (int i = 0; i < N_NODES; i++) {
        if (!node_state(joint, i, inputs, node, &next, slopes, &ignored))
            return;
        node_parts(node, joint->c, parts);
        for (int k = 0; k < N_PARTS; k++)
            x[k] += NODES[i][SHARE] * parts[k];
        const double rate = node_seed(joint, i, inputs, seed, node, next, slopes, node + N_X);
        node_parts_seed(node, joint->c, parts);
        for (int k = 0; k < N_PARTS; k++)
            x[N + k] += NODES[i][SHARE] * parts[k];
        if (node[X_CURVE] > largest || i == 0) {
            largest = node[X_CURVE];
            largest_rate = rate;
        }
    }
    for (int k = 0; k < 6; k++) {
        x[N_PARTS + k] = inputs[S_REL + k];
        x[N + N_PARTS + k] = seed[S_REL + k];
    }
    x[N_PARTS + 6] = largest;
    x[N + N_PARTS + 6] = largest_rate;
    outputs_seed(x, joint->c, result);
}
