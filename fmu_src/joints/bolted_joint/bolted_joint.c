#include "bolted_joint.h"

#include <math.h>

#include "tabulated.h"

enum { PRELOAD, MOMENT, S_REL, V_REL = S_REL + 3 }; /* places of the inputs */

static bool tabulate(Joint *joint, int steps, Text *why)
{
    Kind *kind = &joint->kind;
    return approach_tabulate(&kind->approach, &joint->curve, &kind->spots, joint->c, steps, why);
}

bool kind_tabulate(Joint *joint, Text *why)
{
    joint->kind.tight = joint->kind.pressed = false;
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
    kind->pressed = false;
}

/* The curve at an approach, with the works of the law; inside the closing those at its end are kept. */
static bool press_node(const Joint *joint, double x, NodeState *node, Text *why)
{
    const Kind *kind = &joint->kind;
    curve_at(&joint->curve, x, 4, node->curve);
    const bool closed = node->curve[0] > kind->approach.closed;
    const double p = closed ? node->curve[0] : kind->approach.closed;
    double u = approach_guess(&kind->approach, &joint->curve, closed ? x : 0.0), state[2 * N_LAW_STATE], rate;
    if (!spots_solve(&kind->spots, joint->c, p, &u, &rate, why))
        return false;
    law_state[spots_regime(&kind->spots, u)](&u, joint->c, state);
    for (int i = 0; i < N_LAW_STATE; i++) {
        node->works[i] = state[i];
        node->slopes[i] = closed ? state[N_LAW_STATE + i] / (rate * p) : 0.0;
    }
    return true;
}

/* The nodes at a displacement; kept while it and the tightening stay. */
static bool press(Joint *joint, const double *inputs, Text *why)
{
    Kind *kind = &joint->kind;
    const double apart = inputs[S_REL + 2];
    tighten(joint, inputs);
    if (kind->pressed && kind->apart == apart)
        return true;
    kind->pressed = false;
    for (int i = 0; i < N_NODES; i++)
        if (!press_node(joint, kind->start[i] - apart, &kind->nodes[i], why))
            return false;
    kind->apart = apart;
    kind->pressed = true;
    return true;
}

/* A node's arguments of node_parts: squares of position, s_rel, tightened, p, k, bend, twist, works. */
enum { X_FIXED = 2, X_TIGHT = 5, X_CURVE = 6, X_WORKS = 10, N_X = 12, N_MOVING = N_X - X_FIXED };

static void node_arguments(const Joint *joint, int i, const double *inputs, double *x)
{
    const NodeState *node = &joint->kind.nodes[i];
    x[0] = NODES[i][X2];
    x[1] = NODES[i][Y2];
    for (int k = 0; k < 3; k++)
        x[X_FIXED + k] = inputs[S_REL + k];
    x[X_TIGHT] = joint->kind.tightened[i];
    for (int k = 0; k < 4; k++)
        x[X_CURVE + k] = node->curve[k];
    for (int k = 0; k < N_LAW_STATE; k++)
        x[X_WORKS + k] = node->works[k];
}

bool joint_evaluate(Joint *joint, const double *inputs, double *out, Text *why)
{
    double x[N_OUTPUTS_X] = {0.0}, node[N_X], parts[N_PARTS], largest = 0.0;
    if (!press(joint, inputs, why))
        return false;
    for (int i = 0; i < N_NODES; i++) {
        node_arguments(joint, i, inputs, node);
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
static double node_seed(const Joint *joint, int i, const double *inputs, const double *seed, double *rate)
{
    const NodeState *node = &joint->kind.nodes[i];
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
    for (int k = 0; k < 4; k++)
        rate[4 + k] = node->curve[k + 1] * approach;
    for (int k = 0; k < N_LAW_STATE; k++)
        rate[8 + k] = node->slopes[k] * rate[4];
    return rate[4];
}

void joint_derivative(Joint *joint, const double *inputs, const double *seed, double *result)
{
    enum { N = N_OUTPUTS_X };
    double x[2 * N] = {0.0}, node[N_X + N_MOVING], parts[N_PARTS], largest = 0.0, largest_rate = 0.0;
    Text ignored;
    text_clear(&ignored);
    if (!press(joint, inputs, &ignored))
        return;
    for (int i = 0; i < N_NODES; i++) {
        node_arguments(joint, i, inputs, node);
        node_parts(node, joint->c, parts);
        for (int k = 0; k < N_PARTS; k++)
            x[k] += NODES[i][SHARE] * parts[k];
        const double rate = node_seed(joint, i, inputs, seed, node + N_X);
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
