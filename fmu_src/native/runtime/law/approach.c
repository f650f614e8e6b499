/* Repeats `tabulate_approach` in curve.py of the package, for one parameter set; the functions of the law are
 * generated. */
#include "approach.h"

#include <math.h>
#include <string.h>

_Static_assert(N_LAW_TOTALS == 4, "load and normal stiffness with slopes");
_Static_assert(CONTACT_CLOSING_STEPS % 2 == 0, "the error of a curve is measured on pairs of segments");

enum {
    LAW_STATE_RESULTS = 3 * N_LAW_STATE + 1
}; /* law state, its first and second derivatives with respect to u, F'' - m F' */

enum { LAW_STATE_SIZE = N_LAW_STATE > 0 ? N_LAW_STATE : 1 }; /* C has no empty arrays */

/* Node of the table: pressure and law state over the approach. */
typedef struct {
    Node curve, state[LAW_STATE_SIZE];
} TableNode;

/* Add the closing of the contact, from first contact to the node at zero approach, see `closing_pressure` in curve.py:
 * without it the approach would start at minus infinity. The law state is constant there. */
static bool tabulate_closing(Curve *curve, const TableNode *end)
{
    for (int i = 0; i <= CONTACT_CLOSING_STEPS; i++) {
        const double arguments[4] = {end->curve.y, end->curve.stiffness, end->curve.stiffness_slope,
                                     (double)i / (double)CONTACT_CLOSING_STEPS};
        double y[4];
        closing_pressure(arguments, NULL, y);
        const Node node = {.x = y[0], .y = y[1], .stiffness = y[2], .stiffness_slope = y[3]};
        if (i == 0)
            curve_begin_piece(curve, node);
        else if (!curve_add_node(curve, node))
            return false;
        for (int q = 0; q < N_LAW_STATE; q++) {
            memset(state_polynomial(curve, i, q), 0, 6 * sizeof(double));
            state_polynomial(curve, i, q)[0] = end->state[q].y;
        }
    }
    return true;
}

/* Node at the log-area u and the approach x. Derivatives are one-sided at the ends of a regime of the stiffness. */
static TableNode table_node(const SpotDistribution *spots, const double *c, double u, double regime_start,
                            double regime_end, double x)
{
    double y[N_LAW_TOTALS], one_sided[N_LAW_TOTALS], state[LAW_STATE_RESULTS];
    const double one_sided_u =
        fmin(fmax(u, regime_start + ONE_SIDED_DERIVATIVE_OFFSET), regime_end - ONE_SIDED_DERIVATIVE_OFFSET);
    spot_totals(spots, c, u, y);
    if (one_sided_u != u)
        spot_totals(spots, c, one_sided_u, one_sided);
    else
        memcpy(one_sided, y, sizeof one_sided);
    const double k = y[2] / spots->nominal_area, rate = one_sided[2] / one_sided[1]; /* du/dx */
    TableNode node = {.curve = {.x = x,
                                .y = y[0] / spots->nominal_area,
                                .stiffness = k,
                                .stiffness_slope = k * one_sided[3] / one_sided[1]}};
    law_state[find_law_range(spots, one_sided_u)](&one_sided_u, c, state);
    const double load_curvature = spots->size_exponent * one_sided[1] + state[LAW_STATE_RESULTS - 1]; /* F'' */
    const double rate_slope = (one_sided[3] - one_sided[2] * load_curvature / one_sided[1]) /
                              one_sided[1]; /* derivative of `rate` with respect to u */
    for (int q = 0; q < N_LAW_STATE; q++) {
        const double slope = state[N_LAW_STATE + q], curvature = state[2 * N_LAW_STATE + q];
        node.state[q] = (Node){
            .x = x,
            .y = state[q] + (u - one_sided_u) * slope,
            .stiffness = slope * rate,
            .stiffness_slope = (curvature * rate + slope * rate_slope) * rate,
        };
    }
    return node;
}

/* Increment of the approach [m] over log-areas from u to u + 2 half, by Gauss-Legendre quadrature. */
static double approach_increment(const SpotDistribution *spots, const double *c, double u, double half)
{
    double sum = 0.0, y[N_LAW_TOTALS];
    for (int i = 0; i < N_APPROACH_GAUSS; i++) {
        spot_totals(spots, c, u + half * (1.0 + APPROACH_GAUSS[i]), y);
        sum += APPROACH_GAUSS_WEIGHTS[i] * y[1] / y[2];
    }
    return half * sum;
}

/* Number of segments of one regime of the stiffness; CURVE_NODES stands for all larger numbers. */
static int count_segments(const SpotDistribution *spots, double regime_start, double regime_end, int steps)
{
    const double pairs = ceil(0.5 * steps * (regime_end - regime_start));
    const int least = regime_start >= spots->first_kink_log_area ? MIN_STEP_FACTOR_BETWEEN_KINKS * steps : 2;
    return pairs < (double)CURVE_NODES ? (int)fmax(2.0 * pairs, least) : CURVE_NODES;
}

/* Add the nodes of one regime of the stiffness; x is the approach at its start, and at its end after the call.
 * false: the table is full. */
static bool add_piece(ApproachTable *approach, Curve *curve, const SpotDistribution *spots, const double *c,
                      double regime_start, double regime_end, int steps, double *x)
{
    const int n = count_segments(spots, regime_start, regime_end, steps);
    const double step = (regime_end - regime_start) / n;
    TableNode from = table_node(spots, c, regime_start, regime_start, regime_end, *x);
    if (curve->n == 0) {
        approach->closing_end_pressure = from.curve.y;
        if (!tabulate_closing(curve, &from))
            return false;
    }
    curve_begin_piece(curve, from.curve);
    for (int i = 0; i < n; i++) {
        const double u = i + 1 == n ? regime_end : regime_start + (i + 1) * step;
        *x += approach_increment(spots, c, regime_start + i * step, 0.5 * step);
        const TableNode to = table_node(spots, c, u, regime_start, regime_end, *x);
        if (!curve_add_node(curve, to.curve))
            return false;
        for (int q = 0; q < N_LAW_STATE; q++)
            hermite_polynomial(&from.state[q], &to.state[q], state_polynomial(curve, curve->n - 2, q));
        from = to;
    }
    return true;
}

bool tabulate_approach(ApproachTable *approach, Curve *curve, const SpotDistribution *spots, const double *c, int steps,
                       Text *reason)
{
    const double first = spots->stiffness_onset + portable_log(CLOSING_END_OVER_PLASTIC_SPOT_AREA);
    double last = first, slope, ends[N_LAW_REGIME_ENDS + 2], y[N_LAW_TOTALS], x = 0.0;
    if (!solve_largest_spot(spots, c, spots->max_pressure, &last, &slope, reason))
        return false;
    if (!(last > first)) {
        spot_totals(spots, c, first, y);
        text_append_format(reason,
                           "at every pressure up to the hardness, %.3g Pa, all contact spots are plastic, so the "
                           "interface has no stiffness (it would start at %.3g Pa); check surface.D and surface.G (G "
                           "in m)",
                           spots->max_pressure, y[0] / spots->nominal_area);
        return false;
    }
    approach->first_log_area = first;
    approach->last_log_area = last;
    int pieces = 0, n_nodes = CONTACT_CLOSING_STEPS + 1;
    ends[0] = first;
    for (int i = 0; i < spots->n_regime_ends; i++)
        if (spots->regime_ends[i] > first && spots->regime_ends[i] < last)
            ends[++pieces] = spots->regime_ends[i];
    ends[++pieces] = last;
    for (int i = 0; i < pieces; i++)
        n_nodes += count_segments(spots, ends[i], ends[i + 1], steps);
    if (!curve_begin(curve, n_nodes, N_LAW_STATE, 0.0, reason))
        return false;
    for (int i = 0; i < pieces; i++)
        if (!add_piece(approach, curve, spots, c, ends[i], ends[i + 1], steps, &x))
            return false;
    curve_finish(curve);
    return true;
}

bool evaluate_law_state(const SpotDistribution *spots, const double *c, double pressure, double u, double *value,
                        double *slope, Text *reason)
{
    double rate, state[LAW_STATE_RESULTS];
    if (!solve_largest_spot(spots, c, pressure, &u, &rate, reason))
        return false;
    law_state[find_law_range(spots, u)](&u, c, state);
    for (int q = 0; q < N_LAW_STATE; q++) {
        value[q] = state[q];
        slope[q] = state[N_LAW_STATE + q] / (rate * pressure);
    }
    return true;
}
