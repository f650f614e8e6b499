/* Repeats `approach_curve` of the package: the table for every parameter set; the laws in it are generated. */
#include "approach.h"

#include <math.h>
#include <string.h>

_Static_assert(N_LAW_TABLE == 4, "load and normal stiffness with slopes");
_Static_assert(CLOSING_STEPS % 2 == 0, "the error of a curve is measured on pairs of segments");

enum { STATE_ROWS = 3 * N_LAW_STATE + 1 }; /* state, its slopes, theirs, F'' - m F' */

/* A node of the table: the curve and the state beside. */
typedef struct {
    Node curve, state[APPROACH_STATES];
} Point;

/* How the contact closes: from separation to the node at zero approach, so that the approach does not start
 * at minus infinity. */
static bool close(Approach *approach, Curve *curve, const Point *end)
{
    for (int i = 0; i <= CLOSING_STEPS; i++) {
        const double at[4] = {end->curve.y, end->curve.s, end->curve.bend, (double)i / (double)CLOSING_STEPS};
        double y[4];
        closing(at, NULL, y);
        const Node node = {.x = y[0], .y = y[1], .s = y[2], .bend = y[3]};
        if (i == 0)
            curve_piece(curve, node);
        else if (!curve_add(curve, node))
            return false;
        memset(approach->state[i], 0, sizeof approach->state[i]);
        for (int q = 0; q < N_LAW_STATE; q++)
            approach->state[i][q][0] = end->state[q].y;
    }
    return true;
}

static Point point_at(const Spots *spots, const double *c, double u, double left, double right, double x)
{
    double y[N_LAW_TABLE], side[N_LAW_TABLE], law[STATE_ROWS];
    const double inside = fmin(fmax(u, left + ONE_SIDED_OFFSET), right - ONE_SIDED_OFFSET);
    spots_table(spots, c, u, y);
    if (inside != u)
        spots_table(spots, c, inside, side);
    else
        memcpy(side, y, sizeof side);
    const double k = y[2] / spots->area, rate = side[2] / side[1]; /* du/dx */
    Point point = {.curve = {.x = x, .y = y[0] / spots->area, .s = k, .bend = k * side[3] / side[1]}};
    law_state[spots_regime(spots, inside)](&inside, c, law);
    const double steepening = spots->m * side[1] + law[STATE_ROWS - 1];       /* F'' */
    const double turn = (side[3] - side[2] * steepening / side[1]) / side[1]; /* slope of `rate` in u */
    for (int q = 0; q < N_LAW_STATE; q++) {
        const double slope = law[N_LAW_STATE + q], bend = law[2 * N_LAW_STATE + q];
        point.state[q] = (Node){
            .x = x,
            .y = law[q] + (u - inside) * slope,
            .s = slope * rate,
            .bend = (bend * rate + slope * turn) * rate,
        };
    }
    return point;
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

/* One regime of the stiffness, from the approach x on, where it ends is written; false: the table is full. */
static bool add_piece(Approach *approach, Curve *curve, const Spots *spots, const double *c, double left,
                      double right, int steps, double *x)
{
    const double pairs = ceil(0.5 * steps * (right - left));
    if (!(pairs < (double)CURVE_NODES))
        return false;
    const int n = 2 * (int)fmax(pairs, 1.0);
    const double step = (right - left) / n;
    Point from = point_at(spots, c, left, left, right, *x);
    if (curve->n == 0) {
        approach->closed = from.curve.y;
        if (!close(approach, curve, &from))
            return false;
    }
    curve_piece(curve, from.curve);
    for (int i = 0; i < n; i++) {
        const double u = i + 1 == n ? right : left + (i + 1) * step;
        *x += rise(spots, c, left + i * step, 0.5 * step);
        const Point to = point_at(spots, c, u, left, right, *x);
        if (!curve_add(curve, to.curve))
            return false;
        for (int q = 0; q < N_LAW_STATE; q++)
            curve_polynomial(&from.state[q], &to.state[q], approach->state[curve->n - 2][q]);
        from = to;
    }
    return true;
}

bool approach_tabulate(Approach *approach, Curve *curve, const Spots *spots, const double *c, int steps,
                       Text *why)
{
    const double first = spots->onset + same_log(CLOSING_AREA_RATIO);
    double last = first, slope, ends[N_LAW_ENDS + 2], y[N_LAW_TABLE], x = 0.0;
    if (!spots_solve(spots, c, spots->hardness, &last, &slope, why))
        return false;
    if (!(last > first)) {
        spots_table(spots, c, first, y);
        text_print(why,
                   "the law has no stiffness below %.3g Pa, above the hardness %.3g Pa: the surface (D, G) "
                   "leaves only plastic spots",
                   y[0] / spots->area, spots->hardness);
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
    double rate, law[STATE_ROWS];
    if (!spots_solve(spots, c, pressure, &u, &rate, why))
        return false;
    law_state[spots_regime(spots, u)](&u, c, law);
    for (int q = 0; q < N_LAW_STATE; q++) {
        value[q] = law[q];
        slope[q] = law[N_LAW_STATE + q] / (rate * pressure);
    }
    return true;
}
