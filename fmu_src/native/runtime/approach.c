#include "approach.h"

#include <math.h>
#include <string.h>

_Static_assert(N_LAW_TABLE == 4, "load and normal stiffness with slopes");
_Static_assert(CLOSING_STEPS % 2 == 0, "the error of a curve is measured on pairs of segments");

/* The law at a node of the table. */
typedef struct {
    double x, value[N_LAW_STATE], slope[N_LAW_STATE]; /* slopes in the approach x */
} StateNode;

static void set_state(Approach *approach, int segment, const double *value)
{
    memset(approach->state[segment], 0, sizeof approach->state[segment]);
    for (int q = 0; q < N_LAW_STATE; q++)
        approach->state[segment][q][0] = value[q];
}

/* How the contact closes: from separation to the node at zero approach, so that the approach does not start
 * at minus infinity. */
static bool close(Approach *approach, Curve *curve, const Node *end, const double *state)
{
    for (int i = 0; i <= CLOSING_STEPS; i++) {
        const double at[4] = {end->y, end->s, end->bend, (double)i / CLOSING_STEPS};
        double y[4];
        closing(at, NULL, y);
        const Node node = {.x = y[0], .y = y[1], .s = y[2], .bend = y[3]};
        if (i == 0)
            curve_piece(curve, node);
        else if (!curve_add(curve, node))
            return false;
        set_state(approach, i, state);
    }
    return true;
}

static Node node_at(const Spots *spots, const double *c, double u, double left, double right, double x,
                    StateNode *state)
{
    double y[N_LAW_TABLE], side[N_LAW_TABLE], law[2 * N_LAW_STATE];
    const double inside = fmin(fmax(u, left + SIDE), right - SIDE);
    spots_table(spots, c, u, y);
    if (inside != u)
        spots_table(spots, c, inside, side);
    else
        memcpy(side, y, sizeof side);
    const double k = y[2] / spots->area;
    state->x = x;
    law_state[spots_regime(spots, inside)](&inside, c, law);
    for (int q = 0; q < N_LAW_STATE; q++) {
        state->value[q] = law[q] + (u - inside) * law[N_LAW_STATE + q];
        state->slope[q] = law[N_LAW_STATE + q] * side[2] / side[1];
    }
    return (Node){.x = x, .y = y[0] / spots->area, .s = k, .bend = k * side[3] / side[1]};
}

/* Approach between two log-areas [m]. */
static double rise(const Spots *spots, const double *c, double u, double half)
{
    double sum = 0.0, y[N_LAW_TABLE];
    for (int i = 0; i < N_APPROACH_GAUSS; i++) {
        spots_table(spots, c, u + half * (1.0 + APPROACH_GAUSS[i]), y);
        sum += APPROACH_GAUSS_WEIGHTS[i] * y[1] / y[2];
    }
    return half * sum;
}

/* The quintic through value and slope at three places, 0, `middle` and 1, by divided differences; then its
 * powers on the first part or the second. */
static void quintic(const double *y, const double *s, double middle, double *first, double *second)
{
    const double z[6] = {0.0, 0.0, middle, middle, 1.0, 1.0};
    double d[6] = {y[0], y[0], y[1], y[1], y[2], y[2]};
    for (int order = 1; order < 6; order++)
        for (int i = 5; i >= order; i--)
            d[i] = z[i] == z[i - order] ? s[i / 2] : (d[i] - d[i - 1]) / (z[i] - z[i - order]);
    double a[6] = {d[5]};
    for (int i = 4; i >= 0; i--) {
        for (int k = 5; k > 0; k--)
            a[k] = a[k - 1] - z[i] * a[k];
        a[0] = d[i] - z[i] * a[0];
    }
    double power = 1.0;
    for (int k = 0; k < 6; k++, power *= middle)
        first[k] = a[k] * power;
    for (int k = 0; k < 5; k++)
        for (int i = 4; i >= k; i--)
            a[i] += middle * a[i + 1];
    power = 1.0;
    for (int k = 0; k < 6; k++, power *= 1.0 - middle)
        second[k] = a[k] * power;
}

/* The state on the last two segments, from the nodes at their ends. */
static void add_state(Approach *approach, const Curve *curve, const StateNode *three)
{
    const double length = three[2].x - three[0].x;
    const int segment = curve->n - 3;
    for (int q = 0; q < N_LAW_STATE; q++) {
        double y[3], s[3];
        for (int k = 0; k < 3; k++) {
            y[k] = three[k].value[q];
            s[k] = three[k].slope[q] * length;
        }
        quintic(y, s, (three[1].x - three[0].x) / length, approach->state[segment][q],
                approach->state[segment + 1][q]);
    }
}

/* One regime of the stiffness, from the approach x on, where it ends is written; false: the table is full. */
static bool add_piece(Approach *approach, Curve *curve, const Spots *spots, const double *c, double left,
                      double right, int steps, double *x)
{
    const double pairs = ceil(0.5 * steps * (right - left));
    if (!(pairs < CURVE_NODES))
        return false;
    const int n = 2 * (int)fmax(pairs, 1.0);
    const double step = (right - left) / n;
    StateNode three[3];
    const Node begin = node_at(spots, c, left, left, right, *x, &three[0]);
    if (curve->n == 0) {
        approach->closed = begin.y;
        if (!close(approach, curve, &begin, three[0].value))
            return false;
    }
    curve_piece(curve, begin);
    for (int i = 0; i < n; i++) {
        const double u = i + 1 == n ? right : left + (i + 1) * step;
        *x += rise(spots, c, left + i * step, 0.5 * step);
        if (!curve_add(curve, node_at(spots, c, u, left, right, *x, &three[i % 2 + 1])))
            return false;
        if (i % 2 == 1) {
            add_state(approach, curve, three);
            three[0] = three[2];
        }
    }
    return true;
}

bool approach_tabulate(Approach *approach, Curve *curve, const Spots *spots, const double *c, int steps,
                       Text *why)
{
    const double first = spots->onset + log(CLOSING_RATIO);
    double last = first, slope, ends[N_LAW_ENDS + 2], y[N_LAW_TABLE], x = 0.0;
    if (!spots_solve(spots, c, spots->hardness, &last, &slope, why))
        return false;
    if (!(last > first)) {
        spots_table(spots, c, first, y);
        text_add(why, "the law has no stiffness below ");
        text_number(why, y[0] / spots->area, 3);
        text_add(why, " Pa, above the hardness ");
        text_number(why, spots->hardness, 3);
        text_add(why, " Pa: the surface (D, G) leaves only plastic spots");
        return false;
    }
    approach->first = first;
    approach->last = last;
    int pieces = 0;
    ends[0] = first;
    for (int i = 0; i < spots->n_ends; i++)
        if (spots->ends[i] > first && spots->ends[i] < last)
            ends[++pieces] = spots->ends[i];
    ends[++pieces] = last;
    curve_begin(curve, 0.0);
    for (int i = 0; i < pieces; i++)
        if (!add_piece(approach, curve, spots, c, ends[i], ends[i + 1], steps, &x))
            return false;
    curve_finish(curve);
    return true;
}

bool approach_exact(const Spots *spots, const double *c, double pressure, double u, double *value,
                    double *slope, Text *why)
{
    double rate, law[2 * N_LAW_STATE];
    if (!spots_solve(spots, c, pressure, &u, &rate, why))
        return false;
    law_state[spots_regime(spots, u)](&u, c, law);
    for (int q = 0; q < N_LAW_STATE; q++) {
        value[q] = law[q];
        slope[q] = law[N_LAW_STATE + q] / (rate * pressure);
    }
    return true;
}
