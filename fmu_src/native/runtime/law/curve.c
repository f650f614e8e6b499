/* Repeats `Curve` and `assemble` of the package, with faster ways to find a segment. */
#include "curve.h"

#include <math.h>

void curve_polynomial(const Node *p, const Node *q, double *a)
{
    const double h = q->x - p->x;
    const double s0 = p->s * h, c0 = p->bend * h * h, s1 = q->s * h, c1 = q->bend * h * h;
    const double rise = q->y - p->y;
    a[0] = p->y;
    a[1] = s0;
    a[2] = 0.5 * c0;
    a[3] = 10.0 * rise - 6.0 * s0 - 4.0 * s1 - 1.5 * c0 + 0.5 * c1;
    a[4] = -15.0 * rise + 8.0 * s0 + 7.0 * s1 + 1.5 * c0 - c1;
    a[5] = 6.0 * rise - 3.0 * s0 - 3.0 * s1 - 0.5 * c0 + 0.5 * c1;
}

void curve_begin(Curve *curve, double error)
{
    curve->n = 0;
    curve->error = error;
}

void curve_piece(Curve *curve, Node node)
{
    if (curve->n == 0) {
        curve->x[0] = node.x;
        curve->n = 1;
    }
    curve->last[2] = node;
    curve->piece = 1;
}

static void deviation(Curve *curve, double exact, double rough)
{
    const double relative = 0.5 * fabs(rough - exact) / exact;
    if (relative > curve->error)
        curve->error = relative;
}

/* The last two segments against one segment in their place, at their quarter points. */
static void measure(Curve *curve)
{
    const Node *last = curve->last;
    double coarse[6];
    curve_polynomial(&last[0], &last[2], coarse);
    const double length = last[2].x - last[0].x;
    for (int k = 0; k < 2; k++) {
        const double *fine = curve->a[curve->n - 3 + k];
        const double h = last[k + 1].x - last[k].x;
        for (int i = 1; i < 4; i++) {
            const double t = 0.25 * i, far = (last[k].x - last[0].x + t * h) / length;
            if (curve_value(fine, t) > 0.0)
                deviation(curve, curve_value(fine, t), curve_value(coarse, far));
            if (curve_slope(fine, t) > 0.0)
                deviation(curve, curve_slope(fine, t) / h, curve_slope(coarse, far) / length);
        }
    }
}

bool curve_add(Curve *curve, Node node)
{
    if (curve->n == CURVE_NODES)
        return false;
    curve->last[0] = curve->last[1];
    curve->last[1] = curve->last[2];
    curve->last[2] = node;
    curve_polynomial(&curve->last[1], &curve->last[2], curve->a[curve->n - 1]);
    curve->x[curve->n++] = node.x;
    if (++curve->piece % 2 == 1)
        measure(curve);
    return true;
}

/* A node from the polynomial of a segment, at its beginning (t = 0) or end (1). */
static Node node_of(const Curve *curve, int i, double t)
{
    const double h = curve->x[i + 1] - curve->x[i];
    return (Node){.x = curve->x[i + (t > 0.0)], .y = curve_value(curve->a[i], t), .s = curve_slope(curve->a[i], t) / h};
}

static void finish_segment(Curve *curve, int i)
{
    const double *a = curve->a[i];
    const double rise = curve_value(a, 1.0) - a[0], begin = a[1], end = curve_slope(a, 1.0);
    const bool bent = rise > 0.0 && begin > 0.125 * rise && end > 0.125 * rise;
    curve->per[i] = 1.0 / (curve->x[i + 1] - curve->x[i]);
    curve->inverse[i].per_load = rise > 0.0 ? 1.0 / rise : 0.0;
    curve->inverse[i].begin = bent ? rise / begin : 1.0;
    curve->inverse[i].end = bent ? rise / end : 1.0;
}

/* Buckets of the loads from the second segment on, as fine as their number allows. */
static void finish_loads(Curve *curve)
{
    curve->first_bits = 0;
    if (curve->n == 2)
        return;
    curve->shift = 40;
    while (curve_load_bucket(curve, curve->end.y) - curve_load_bucket(curve, curve->a[1][0]) >= CURVE_BUCKETS)
        curve->shift++;
    curve->first_bits = curve_load_bucket(curve, curve->a[1][0]);
    int segment = 1;
    curve->load_bucket[0] = 1;
    for (unsigned k = 0; k < CURVE_BUCKETS; k++) {
        while (segment < curve->n - 2 && curve_load_bucket(curve, curve->a[segment + 1][0]) <= k)
            segment++;
        curve->load_bucket[k + 1] = (unsigned short)segment;
    }
}

void curve_finish(Curve *curve)
{
    const double first = curve->x[0], length = curve->x[curve->n - 1] - first;
    curve->first = node_of(curve, 0, 0.0);
    curve->end = node_of(curve, curve->n - 2, 1.0);
    curve->per_bucket = (double)CURVE_BUCKETS / length;
    int segment = 0;
    for (int k = 0; k <= CURVE_BUCKETS; k++) {
        while (segment < curve->n - 2 && curve->x[segment + 1] - first <= k * (length / (double)CURVE_BUCKETS))
            segment++;
        curve->bucket[k] = (unsigned short)segment;
    }
    for (int i = 0; i < curve->n - 1; i++)
        finish_segment(curve, i);
    finish_loads(curve);
}

static double inside(const Curve *curve, double x)
{
    return x < curve->first.x ? curve->first.x : (x > curve->end.x ? curve->end.x : x);
}

void curve_at(const Curve *curve, double x, int order, double *y)
{
    const double at = inside(curve, x);
    const int i = curve_segment(curve, at);
    curve_derivatives(curve, i, (at - curve->x[i]) * curve->per[i], order, y);
    if (x != at) {
        y[0] += (x - at) * y[1];
        for (int k = 2; k <= order; k++)
            y[k] = 0.0;
    }
}

double curve_inverse_safe(const Curve *curve, double load)
{
    const Node *first = &curve->first, *end = &curve->end;
    if (load <= first->y)
        return first->s == 0.0 ? first->x : first->x + (load - first->y) / first->s;
    if (load >= end->y)
        return end->x + (load - end->y) / end->s;
    const int i = curve_segment_of_load(curve, load);
    const double *a = curve->a[i];
    double low = 0.0, high = 1.0, t = curve_guess(curve, i, load);
    for (int k = 0; k < MAX_ITERATIONS; k++) {
        const double rest = load - curve_value(a, t), s = curve_slope(a, t);
        if (rest > 0.0)
            low = t;
        else
            high = t;
        const double step = s > 0.0 ? t + rest / s : -1.0;
        const bool newton = step >= low && step <= high;
        const double next = newton ? step : 0.5 * (low + high);
        const double change = fabs(next - t);
        t = next;
        if (change <= (newton ? NEWTON_TOLERANCE : 4e-16) * t)
            break;
    }
    return curve->x[i] + t * (curve->x[i + 1] - curve->x[i]);
}

void energy_tabulate(Energy *energy, const Curve *curve)
{
    energy->at[0] = 0.0;
    for (int i = 0; i + 1 < curve->n; i++)
        energy->at[i + 1] = energy_inside(energy, curve, i, 1.0);
}
