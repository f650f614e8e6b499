#include "curve.h"

#include <math.h>

static const double CLOSE = 1e-8; /* relative change by a Newton step that leaves round-off */

static void polynomial(const Node *p, const Node *q, double *a)
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

/* In pairs, which a processor evaluates at the same time. */

static double value(const double *a, double t)
{
    const double square = t * t;
    return (a[0] + t * a[1]) + square * ((a[2] + t * a[3]) + square * (a[4] + t * a[5]));
}

static double slope(const double *a, double t)
{
    const double square = t * t;
    return (a[1] + t * (2.0 * a[2])) + square * ((3.0 * a[3] + t * (4.0 * a[4])) + square * (5.0 * a[5]));
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
    polynomial(&last[0], &last[2], coarse);
    const double length = last[2].x - last[0].x;
    for (int k = 0; k < 2; k++) {
        const double *fine = curve->a[curve->n - 3 + k];
        const double h = last[k + 1].x - last[k].x;
        for (int i = 1; i < 4; i++) {
            const double t = 0.25 * i, far = (last[k].x - last[0].x + t * h) / length;
            if (value(fine, t) > 0.0)
                deviation(curve, value(fine, t), value(coarse, far));
            if (slope(fine, t) > 0.0)
                deviation(curve, slope(fine, t) / h, slope(coarse, far) / length);
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
    polynomial(&curve->last[1], &curve->last[2], curve->a[curve->n - 1]);
    curve->x[curve->n++] = node.x;
    if (++curve->piece % 2 == 1)
        measure(curve);
    return true;
}

/* A node from the polynomial of a segment, at its beginning (t = 0) or end (1). */
static Node node_of(const Curve *curve, int i, double t)
{
    const double h = curve->x[i + 1] - curve->x[i];
    return (Node){.x = curve->x[i + (t > 0.0)], .y = value(curve->a[i], t), .s = slope(curve->a[i], t) / h};
}

void curve_finish(Curve *curve)
{
    const double first = curve->x[0], length = curve->x[curve->n - 1] - first;
    curve->first = node_of(curve, 0, 0.0);
    curve->end = node_of(curve, curve->n - 2, 1.0);
    curve->per_bucket = CURVE_BUCKETS / length;
    int segment = 0;
    for (int k = 0; k <= CURVE_BUCKETS; k++) {
        while (segment < curve->n - 2 && curve->x[segment + 1] - first <= k * (length / CURVE_BUCKETS))
            segment++;
        curve->bucket[k] = (unsigned short)segment;
    }
}

/* Segment that holds x; x is inside the table. */
static int find(const Curve *curve, double x)
{
    const double place = (x - curve->x[0]) * curve->per_bucket;
    const int k = place < CURVE_BUCKETS ? (int)place : CURVE_BUCKETS - 1;
    int low = curve->bucket[k], high = curve->bucket[k + 1];
    while (low > 0 && x < curve->x[low]) /* round-off at the beginning of a bucket */
        low--;
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (x < curve->x[middle])
            high = middle - 1;
        else
            low = middle;
    }
    return low;
}

/* `per` is the number of segments like this one per displacement. */
static void derivatives(const double *a, double t, double per, int order, double *y)
{
    y[0] = value(a, t);
    y[1] = slope(a, t) * per;
    if (order >= 2)
        y[2] = (2.0 * a[2] + t * (6.0 * a[3] + t * (12.0 * a[4] + t * 20.0 * a[5]))) * (per * per);
    if (order >= 3)
        y[3] = (6.0 * a[3] + t * (24.0 * a[4] + t * 60.0 * a[5])) * (per * per * per);
    if (order >= 4)
        y[4] = (24.0 * a[4] + t * 120.0 * a[5]) * (per * per * per * per);
}

static double inside(const Curve *curve, double x)
{
    return x < curve->first.x ? curve->first.x : (x > curve->end.x ? curve->end.x : x);
}

int curve_segment(const Curve *curve, double x, double *t)
{
    const double at = inside(curve, x);
    const int i = find(curve, at);
    *t = (at - curve->x[i]) / (curve->x[i + 1] - curve->x[i]);
    return i;
}

void curve_at(const Curve *curve, double x, int order, double *y)
{
    const double at = inside(curve, x);
    const int i = find(curve, at);
    const double per = 1.0 / (curve->x[i + 1] - curve->x[i]);
    derivatives(curve->a[i], (at - curve->x[i]) * per, per, order, y);
    if (x != at) {
        y[0] += (x - at) * y[1];
        for (int k = 2; k <= order; k++)
            y[k] = 0.0;
    }
}

double curve_inverse(const Curve *curve, double load)
{
    const Node *first = &curve->first, *end = &curve->end;
    if (load <= first->y)
        return first->s == 0.0 ? first->x : first->x + (load - first->y) / first->s;
    if (load >= end->y)
        return end->x + (load - end->y) / end->s;
    int i = 0;
    for (int n = curve->n - 1; n > 1; n -= n / 2) /* i is among n segments */
        i += load < curve->a[i + n / 2][0] ? 0 : n / 2;
    const double *a = curve->a[i];
    const double h = curve->x[i + 1] - curve->x[i], top = value(a, 1.0);
    double low = 0.0, high = 1.0, t = top > a[0] ? (load - a[0]) / (top - a[0]) : 0.0;
    for (int k = 0; k < 60; k++) {
        const double rest = load - value(a, t), s = slope(a, t);
        if (rest > 0.0)
            low = t;
        else
            high = t;
        const double step = s > 0.0 ? t + rest / s : -1.0;
        const bool newton = step >= low && step <= high;
        const double next = newton ? step : 0.5 * (low + high);
        const double change = fabs(next - t);
        t = next;
        if (change <= (newton ? CLOSE : 4e-16) * t)
            break;
    }
    return curve->x[i] + t * h;
}
