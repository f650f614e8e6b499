/* Tabulated monotone force law: load y over displacement x, with exact derivatives.
 *
 * Each segment is a quintic Hermite polynomial of t, which runs from 0 to 1: load, stiffness and derivative of the
 * stiffness at both nodes are exact. Beyond the table the curve continues with its end tangents. */
#ifndef JOINTFMU_CURVE_H
#define JOINTFMU_CURVE_H

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "law.h"
#include "text.h"

enum { CURVE_BUCKETS = 1024 }; /* equal ranges of displacement, or of load, that narrow the search for a segment */
_Static_assert(CURVE_NODES <= USHRT_MAX, "a bucket holds the number of a segment");

/* Largest Newton step in t for which a step of third order is accurate to round-off, if the slope of the segment
 * changes by at most half over t. */
#define MAX_FINAL_NEWTON_STEP 8e-6

typedef struct {
    double x;               /* displacement */
    double y;               /* load */
    double stiffness;       /* dy/dx */
    double stiffness_slope; /* derivative of the stiffness, d2y/dx2 */
} Node;

/* Segment from a node to the next one. The last node has a segment of which only x is used. */
typedef struct {
    double x;               /* displacement of its first node */
    double inverse_length;  /* 1 over its length, dt/dx */
    double coefficients[6]; /* of 1, t, ... t^5 */
} Segment;

/* Cubic estimate of t at a load of a segment. */
typedef struct {
    double inverse_load_rise;      /* 1 over the increase of the load in the segment */
    double start_slope, end_slope; /* derivative of t with respect to the fraction of this increase, at both ends */
} SegmentInverse;

typedef struct {
    int n;         /* number of nodes; there are n - 1 segments */
    int max_nodes; /* number of nodes for which there is memory: one block, which starts at `segments` */
    double error;  /* largest relative interpolation error of load and stiffness, see `assemble_curve` in curve.py */
    Segment *segments;
    SegmentInverse *inverse;           /* of each segment */
    double *node_energy;               /* integral of the load from the first node to each node, by `tabulate_energy` */
    double (*further_coefficients)[6]; /* of further quantities on each segment, as in `Segment` */
    Node start, end;      /* ends of the table, computed from the polynomials */
    Node recent_nodes[3]; /* while the table is built: last three nodes of the piece */
    int piece_nodes;      /* while the table is built: nodes of the piece so far */
    double buckets_per_displacement;
    unsigned short displacement_bucket[CURVE_BUCKETS + 1]; /* segment that contains the start of each bucket */
    unsigned bucket_shift;                         /* number of low bits of a load that may differ inside a bucket */
    uint64_t first_bucket;                         /* high bits of the load at the start of the second segment */
    unsigned short load_bucket[CURVE_BUCKETS + 1]; /* last segment that starts before each bucket */
} Curve;

/* Polynomial of a segment, and its derivative with respect to t. Terms are added in pairs that a processor evaluates in
 * parallel. */
static inline double polynomial_value(const double *a, double t)
{
    const double t2 = t * t;
    return (a[0] + t * a[1]) + t2 * ((a[2] + t * a[3]) + t2 * (a[4] + t * a[5]));
}

static inline double polynomial_slope(const double *a, double t)
{
    const double t2 = t * t;
    return (a[1] + t * (2.0 * a[2])) + t2 * ((3.0 * a[3] + t * (4.0 * a[4])) + t2 * (5.0 * a[5]));
}

/* t of a segment at a displacement x. */
static inline double segment_parameter(const Curve *curve, int segment, double x)
{
    return (x - curve->segments[segment].x) * curve->segments[segment].inverse_length;
}

/* Building a table: `curve_begin`; for each piece `curve_begin_piece` with its first node, then `curve_add_node` for an
 * even number of further nodes; `curve_finish`. A piece starts at the last node of the one before; the derivative of
 * the stiffness may jump between them. */

/* Memory for at least `n_nodes` nodes, with `n_quantities` further quantities on each segment: memory of the table
 * before, if it suffices. `error` is the relative error of the data themselves. false: no memory is left, with the
 * reason; or, without a reason, more than CURVE_NODES nodes. */
bool curve_begin(Curve *curve, int n_nodes, int n_quantities, double error, Text *reason);
void curve_begin_piece(Curve *curve, Node node);
/* false: the table has no memory for a further node. */
bool curve_add_node(Curve *curve, Node node);
void curve_finish(Curve *curve);
/* Free the memory of a table. */
void curve_free(Curve *curve);

/* Coefficients a of the polynomial between two nodes. */
void hermite_polynomial(const Node *p, const Node *q, double *a);

/* Segment that contains a displacement x inside the table. */
static inline int curve_find_segment(const Curve *curve, double x)
{
    const double position = (x - curve->segments[0].x) * curve->buckets_per_displacement;
    const int k = position < (double)CURVE_BUCKETS ? (int)position : CURVE_BUCKETS - 1;
    int low = curve->displacement_bucket[k], high = curve->displacement_bucket[k + 1];
    const int next_segment =
        low + ((low < high) & (x >= curve->segments[low + 1].x)); /* in most buckets at most one segment starts */
    if (x >= curve->segments[next_segment].x && x < curve->segments[next_segment + 1].x)
        return next_segment;
    while (low > 0 && x < curve->segments[low].x) /* round-off at the start of a bucket */
        low--;
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (x < curve->segments[middle].x)
            high = middle - 1;
        else
            low = middle;
    }
    return low;
}

/* Load y[0] and its derivatives y[1], ... y[order] with respect to x, at t of a segment; order 1 to 4. */
static inline void segment_derivatives(const Curve *curve, int segment, double t, int order, double *y)
{
    const double *a = curve->segments[segment].coefficients;
    const double inverse_length = curve->segments[segment].inverse_length;
    y[0] = polynomial_value(a, t);
    y[1] = polynomial_slope(a, t) * inverse_length;
    if (order >= 2)
        y[2] =
            (2.0 * a[2] + t * (6.0 * a[3] + t * (12.0 * a[4] + t * 20.0 * a[5]))) * (inverse_length * inverse_length);
    if (order >= 3)
        y[3] = (6.0 * a[3] + t * (24.0 * a[4] + t * 60.0 * a[5])) * (inverse_length * inverse_length * inverse_length);
    if (order >= 4)
        y[4] = (24.0 * a[4] + t * 120.0 * a[5]) * (inverse_length * inverse_length * inverse_length * inverse_length);
}

/* Load y[0] and its derivatives up to `order` at any displacement x, also beyond the table. */
void curve_evaluate(const Curve *curve, double x, int order, double *y);

/* Bucket of a load, from the second segment on: the bit pattern of a positive number increases with it. */
static inline uint64_t curve_bucket_of_load(const Curve *curve, double load)
{
    uint64_t bits;
    memcpy(&bits, &load, sizeof bits);
    return (bits >> curve->bucket_shift) - curve->first_bucket;
}

/* Segment that contains a load inside the table. */
static inline int curve_find_segment_of_load(const Curve *curve, double load)
{
    if (!(curve->n > 2 && load >= curve->segments[1].coefficients[0]))
        return 0;
    const uint64_t k = curve_bucket_of_load(curve, load);
    int low = curve->load_bucket[k], high = curve->load_bucket[k + 1];
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (load < curve->segments[middle].coefficients[0])
            high = middle - 1;
        else
            low = middle;
    }
    return low;
}

/* Estimate of t at which segment i has a load, by a cubic. */
static inline double curve_estimate_inverse(const Curve *curve, int i, double load)
{
    const double load_fraction = (load - curve->segments[i].coefficients[0]) * curve->inverse[i].inverse_load_rise;
    const double start_slope = curve->inverse[i].start_slope, end_slope = curve->inverse[i].end_slope;
    const double t = load_fraction * (start_slope + load_fraction * ((3.0 - 2.0 * start_slope - end_slope) +
                                                                     load_fraction * (start_slope + end_slope - 2.0)));
    return t > 0.0 ? (t < 1.0 ? t : 1.0) : 0.0;
}

/* Displacement at a load, accurate to round-off, by a safeguarded Newton iteration inside the segment. Loads at or
 * below the first node give the first node if the stiffness there is zero. */
double curve_inverse_safeguarded(const Curve *curve, double load);

/* The same, faster: one or two steps of third order from the cubic estimate, if they are accurate to round-off.
 * `load_at_result` is the load of the table at the rounded displacement. `segment` is where the search starts (0: not
 * known), and after the call the segment of the load. */
static inline double curve_inverse(const Curve *curve, double load, int *segment, double *load_at_result)
{
    if (load > curve->start.y && load < curve->end.y) {
        int i = *segment;
        if (!(load >= curve->segments[i].coefficients[0] && load < curve->segments[i + 1].coefficients[0]))
            *segment = i = curve_find_segment_of_load(curve, load);
        const double *a = curve->segments[i].coefficients;
        double t = curve_estimate_inverse(curve, i, load);
        for (int n = 0; n < 2; n++) {
            const double slope = polynomial_slope(a, t);
            const double half_curvature = (a[2] + t * 3.0 * a[3]) + t * t * (6.0 * a[4] + t * 10.0 * a[5]);
            const double inverse_slope = 1.0 / slope, step = (load - polynomial_value(a, t)) * inverse_slope;
            const double next = t + step * (1.0 - step * half_curvature * inverse_slope);
            if (!(fabs(half_curvature) <= 0.25 * slope && next >= 0.0 && next <= 1.0))
                break;
            if (fabs(step) <= MAX_FINAL_NEWTON_STEP) {
                const double x = curve->segments[i].x + next * (curve->segments[i + 1].x - curve->segments[i].x);
                *load_at_result = load + slope * (segment_parameter(curve, i, x) - next);
                return x;
            }
            t = next;
        }
    }
    double y[2];
    const double x = curve_inverse_safeguarded(curve, load);
    curve_evaluate(curve, x, 1, y);
    *load_at_result = y[0];
    return x;
}

/* Energy at all nodes: integral of the load over the displacement, from the first node. */
void tabulate_energy(Curve *curve);

/* Energy at t of a segment. */
static inline double segment_energy(const Curve *curve, int segment, double t)
{
    const double *a = curve->segments[segment].coefficients;
    const double t2 = t * t; /* in pairs, as in `polynomial_value` */
    const double mean = (a[0] + t * (a[1] * 0.5)) +
                        t2 * ((a[2] * (1.0 / 3.0) + t * (a[3] * 0.25)) + t2 * (a[4] * 0.2 + t * (a[5] * (1.0 / 6.0))));
    return curve->node_energy[segment] + (curve->segments[segment + 1].x - curve->segments[segment].x) * t * mean;
}

/* Energy at any displacement x, also beyond the table: integral of the load from the first node to x. Sets also the
 * load y[0] and its derivatives with respect to x up to `order` (1 to 4) there. */
static inline double curve_energy(const Curve *curve, double x, int order, double *y)
{
    const double inside = x < curve->start.x ? curve->start.x : (x > curve->end.x ? curve->end.x : x);
    const int segment = curve_find_segment(curve, inside);
    const double t = segment_parameter(curve, segment, inside), excess = x - inside;
    segment_derivatives(curve, segment, t, order, y);
    const double energy = segment_energy(curve, segment, t) + excess * (y[0] + 0.5 * excess * y[1]);
    y[0] += excess * y[1];
    for (int k = 2; k <= order && excess != 0.0; k++)
        y[k] = 0.0;
    return energy;
}

#endif
