/* Repeats `Curve` and `assemble_curve` in curve.py of the package, with a faster search for the segment. */
#include "curve.h"

#include <math.h>
#include <stdlib.h>

void hermite_polynomial(const Node *p, const Node *q, double *a)
{
    const double h = q->x - p->x;
    const double s0 = p->stiffness * h, c0 = p->stiffness_slope * h * h, s1 = q->stiffness * h,
                 c1 = q->stiffness_slope * h * h;
    const double rise = q->y - p->y;
    a[0] = p->y;
    a[1] = s0;
    a[2] = 0.5 * c0;
    a[3] = 10.0 * rise - 6.0 * s0 - 4.0 * s1 - 1.5 * c0 + 0.5 * c1;
    a[4] = -15.0 * rise + 8.0 * s0 + 7.0 * s1 + 1.5 * c0 - c1;
    a[5] = 6.0 * rise - 3.0 * s0 - 3.0 * s1 - 0.5 * c0 + 0.5 * c1;
}

void curve_free(Curve *curve)
{
    free(curve->segments);
    curve->segments = NULL;
    curve->max_nodes = 0;
}

/* New memory for a number of nodes; false: no memory is left. */
static bool allocate_nodes(Curve *curve, int n_nodes, int n_quantities)
{
    const size_t n = (size_t)n_nodes, n_further = n * (size_t)n_quantities;
    curve_free(curve);
    curve->segments = calloc(1, n * (sizeof(Segment) + sizeof(SegmentInverse) + sizeof(double)) +
                                    n_further * sizeof *curve->further_coefficients);
    if (!curve->segments)
        return false;
    curve->max_nodes = n_nodes;
    curve->inverse = (SegmentInverse *)(void *)(curve->segments + n);
    curve->node_energy = (double *)(void *)(curve->inverse + n);
    curve->further_coefficients = (double (*)[6])(void *)(curve->node_energy + n);
    return true;
}

bool curve_begin(Curve *curve, int n_nodes, int n_quantities, double error, Text *reason)
{
    curve->n = 0;
    curve->error = error;
    if (n_nodes > CURVE_NODES)
        return false;
    if (n_nodes <= curve->max_nodes || allocate_nodes(curve, n_nodes, n_quantities))
        return true;
    text_append_format(reason, "no memory is left; expected some for a table of %zu nodes", (size_t)n_nodes);
    return false;
}

void curve_begin_piece(Curve *curve, Node node)
{
    if (curve->n == 0) {
        curve->segments[0].x = node.x;
        curve->n = 1;
    }
    curve->recent_nodes[2] = node;
    curve->piece_nodes = 1;
}

/* Update the largest relative error; it is half the deviation between the fine and the coarse curve. */
static void update_error(Curve *curve, double fine, double coarse)
{
    const double relative = 0.5 * fabs(coarse - fine) / fine;
    if (relative > curve->error)
        curve->error = relative;
}

/* Compare the last two segments with one segment through their outer nodes, at their quarter points. */
static void measure_error(Curve *curve)
{
    const Node *last = curve->recent_nodes;
    double coarse[6];
    hermite_polynomial(&last[0], &last[2], coarse);
    const double length = last[2].x - last[0].x;
    for (int k = 0; k < 2; k++) {
        const double *a = curve->segments[curve->n - 3 + k].coefficients;
        const double h = last[k + 1].x - last[k].x;
        for (int i = 1; i < 4; i++) {
            const double t = 0.25 * i, coarse_t = (last[k].x - last[0].x + t * h) / length;
            if (polynomial_value(a, t) > 0.0)
                update_error(curve, polynomial_value(a, t), polynomial_value(coarse, coarse_t));
            if (polynomial_slope(a, t) > 0.0)
                update_error(curve, polynomial_slope(a, t) / h, polynomial_slope(coarse, coarse_t) / length);
        }
    }
}

bool curve_add_node(Curve *curve, Node node)
{
    if (curve->n == curve->max_nodes)
        return false;
    curve->recent_nodes[0] = curve->recent_nodes[1];
    curve->recent_nodes[1] = curve->recent_nodes[2];
    curve->recent_nodes[2] = node;
    hermite_polynomial(&curve->recent_nodes[1], &curve->recent_nodes[2], curve->segments[curve->n - 1].coefficients);
    curve->segments[curve->n++].x = node.x;
    if (++curve->piece_nodes % 2 == 1)
        measure_error(curve);
    return true;
}

/* Node at the start (t = 0) or end (t = 1) of a segment, from its polynomial. */
static Node end_node(const Curve *curve, int i, double t)
{
    const double h = curve->segments[i + 1].x - curve->segments[i].x;
    return (Node){.x = curve->segments[i + (t > 0.0)].x,
                  .y = polynomial_value(curve->segments[i].coefficients, t),
                  .stiffness = polynomial_slope(curve->segments[i].coefficients, t) / h};
}

/* Coefficients of `curve_estimate_inverse`; linear interpolation if the cubic would not be monotone. */
static void set_segment_inverse(Curve *curve, int i)
{
    const double *a = curve->segments[i].coefficients;
    const double rise = polynomial_value(a, 1.0) - a[0], start_slope = a[1], end_slope = polynomial_slope(a, 1.0);
    const bool is_monotone = rise > 0.0 && start_slope > 0.125 * rise && end_slope > 0.125 * rise;
    curve->segments[i].inverse_length = 1.0 / (curve->segments[i + 1].x - curve->segments[i].x);
    curve->inverse[i].inverse_load_rise = rise > 0.0 ? 1.0 / rise : 0.0;
    curve->inverse[i].start_slope = is_monotone ? rise / start_slope : 1.0;
    curve->inverse[i].end_slope = is_monotone ? rise / end_slope : 1.0;
}

/* Buckets for the search of a load from the second segment on, as fine as their number allows. */
static void set_load_buckets(Curve *curve)
{
    curve->first_bucket = 0;
    if (curve->n == 2)
        return;
    curve->bucket_shift = 40;
    const double second_load = curve->segments[1].coefficients[0];
    while (curve_bucket_of_load(curve, curve->end.y) - curve_bucket_of_load(curve, second_load) >= CURVE_BUCKETS)
        curve->bucket_shift++;
    curve->first_bucket = curve_bucket_of_load(curve, second_load);
    int segment = 1;
    curve->load_bucket[0] = 1;
    for (unsigned k = 0; k < CURVE_BUCKETS; k++) {
        while (segment < curve->n - 2 && curve_bucket_of_load(curve, curve->segments[segment + 1].coefficients[0]) <= k)
            segment++;
        curve->load_bucket[k + 1] = (unsigned short)segment;
    }
}

void curve_finish(Curve *curve)
{
    const double first = curve->segments[0].x, length = curve->segments[curve->n - 1].x - first;
    curve->start = end_node(curve, 0, 0.0);
    curve->end = end_node(curve, curve->n - 2, 1.0);
    curve->buckets_per_displacement = (double)CURVE_BUCKETS / length;
    int segment = 0;
    for (int k = 0; k <= CURVE_BUCKETS; k++) {
        while (segment < curve->n - 2 && curve->segments[segment + 1].x - first <= k * (length / (double)CURVE_BUCKETS))
            segment++;
        curve->displacement_bucket[k] = (unsigned short)segment;
    }
    for (int i = 0; i < curve->n - 1; i++)
        set_segment_inverse(curve, i);
    set_load_buckets(curve);
}

/* Nearest displacement of the table. */
static double clip_to_table(const Curve *curve, double x)
{
    return x < curve->start.x ? curve->start.x : (x > curve->end.x ? curve->end.x : x);
}

void curve_evaluate(const Curve *curve, double x, int order, double *y)
{
    const double inside = clip_to_table(curve, x);
    const int i = curve_find_segment(curve, inside);
    segment_derivatives(curve, i, segment_parameter(curve, i, inside), order, y);
    if (x != inside) {
        y[0] += (x - inside) * y[1];
        for (int k = 2; k <= order; k++)
            y[k] = 0.0;
    }
}

double curve_inverse_safeguarded(const Curve *curve, double load)
{
    const Node *start = &curve->start, *end = &curve->end;
    if (load <= start->y)
        return start->stiffness == 0.0 ? start->x : start->x + (load - start->y) / start->stiffness;
    if (load >= end->y)
        return end->x + (load - end->y) / end->stiffness;
    const int i = curve_find_segment_of_load(curve, load);
    const double *a = curve->segments[i].coefficients;
    double low = 0.0, high = 1.0, t = curve_estimate_inverse(curve, i, load);
    for (int k = 0; k < MAX_INVERSION_ITERATIONS; k++) {
        const double residual = load - polynomial_value(a, t), s = polynomial_slope(a, t);
        if (residual > 0.0)
            low = t;
        else
            high = t;
        const double step = s > 0.0 ? t + residual / s : -1.0;
        const bool is_newton_step = step >= low && step <= high;
        const double next = is_newton_step ? step : 0.5 * (low + high);
        const double change = fabs(next - t);
        t = next;
        if (change <= (is_newton_step ? NEWTON_TOLERANCE : 4e-16) * t)
            break;
    }
    return curve->segments[i].x + t * (curve->segments[i + 1].x - curve->segments[i].x);
}

void tabulate_energy(Curve *curve)
{
    curve->node_energy[0] = 0.0;
    for (int i = 0; i + 1 < curve->n; i++)
        curve->node_energy[i + 1] = segment_energy(curve, i, 1.0);
}
