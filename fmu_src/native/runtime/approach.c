#include "approach.h"

#include <math.h>

static const double SIDE = 1e-9; /* where a regime ends its derivative is taken this far inside, in log-area */

/* How the contact closes: from separation to the point (p, k, dk/d delta) at zero approach, so that the
 * approach does not start at minus infinity. Load p z^3 (a + b z + c z^2) over a length 4 p/k. */
static bool closing(Approach *approach, Curve *curve, double p, double k, double bend, double u)
{
    const double length = 4.0 * p / k, part = 0.5 * (bend * length * length / p) - 6.0;
    const double a = part, b = 1.0 - 2.0 * part;
    for (int i = 0; i <= CLOSING_STEPS; i++) {
        const double z = (double)i / CLOSING_STEPS;
        const Node node = {
            .x = (z - 1.0) * length,
            .y = p * z * z * z * (a + b * z + part * z * z),
            .s = p / length * z * z * (3.0 * a + 4.0 * b * z + 5.0 * part * z * z),
            .bend = p / (length * length) * z * (6.0 * a + 12.0 * b * z + 20.0 * part * z * z),
        };
        approach->u[i] = u;
        approach->rate[i] = 0.0;
        if (i == 0)
            curve_piece(curve, node);
        else if (!curve_add(curve, node))
            return false;
    }
    return true;
}

/* `rate` is that of u along the curve. */
static Node node_at(const Spots *spots, const double *c, double u, double left, double right, double x,
                    double *rate)
{
    double y[N_LAW_TABLE], side[N_LAW_TABLE];
    spots_table(spots, c, u, y);
    spots_table(spots, c, fmin(fmax(u, left + SIDE), right - SIDE), side);
    const double k = y[2] / spots->area;
    *rate = y[2] / y[1];
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

bool approach_tabulate(Approach *approach, Curve *curve, const Spots *spots, const double *c, int steps,
                       Text *why)
{
    const double first = spots->onset + log(CLOSING_RATIO);
    double last = first, slope, ends[N_LAW_ENDS + 2], y[N_LAW_TABLE];
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
    int pieces = 0;
    ends[0] = first;
    for (int i = 0; i < spots->n_ends; i++)
        if (spots->ends[i] > first && spots->ends[i] < last)
            ends[++pieces] = spots->ends[i];
    ends[++pieces] = last;
    double x = 0.0;
    for (int piece = 0; piece < pieces; piece++) {
        const double left = ends[piece], right = ends[piece + 1];
        const double pairs = ceil(0.5 * steps * (right - left));
        if (!(pairs < CURVE_NODES))
            return false;
        const int n = 2 * (int)fmax(pairs, 1.0);
        const double step = (right - left) / n;
        double rate;
        Node node = node_at(spots, c, left, left, right, x, &rate);
        if (piece == 0) {
            curve_begin(curve, 0.0);
            approach->closed = node.y;
            if (!closing(approach, curve, node.y, node.s, node.bend, first))
                return false;
        }
        curve_piece(curve, node);
        approach->rate[curve->n - 1] = rate;
        for (int i = 0; i < n; i++) {
            const double u = i + 1 == n ? right : left + (i + 1) * step;
            x += rise(spots, c, left + i * step, 0.5 * step);
            node = node_at(spots, c, u, left, right, x, &rate);
            if (!curve_add(curve, node))
                return false;
            approach->u[curve->n - 1] = u;
            approach->rate[curve->n - 1] = rate;
        }
    }
    curve_finish(curve);
    return true;
}

double approach_guess(const Approach *approach, const Curve *curve, double x)
{
    double t;
    const int i = curve_segment(curve, x, &t);
    const double h = curve->x[i + 1] - curve->x[i], rise = approach->u[i + 1] - approach->u[i];
    const double begin = h * approach->rate[i] - rise, end = h * approach->rate[i + 1] - rise;
    return approach->u[i] + t * (rise + (1.0 - t) * ((1.0 - t) * begin - t * end));
}
