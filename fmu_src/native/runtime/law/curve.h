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

typedef struct {
    int n;        /* number of nodes; there are n - 1 segments */
    double error; /* largest relative interpolation error of load and stiffness, see `assemble_curve` in curve.py */
    double x[CURVE_NODES];               /* displacement of the nodes */
    double coefficients[CURVE_NODES][6]; /* of 1, t, ... t^5 on each segment */
    double inverse_length[CURVE_NODES];  /* 1 over the length of each segment, dt/dx */
    struct {
        double inverse_load_rise;      /* 1 over the increase of the load in the segment */
        double start_slope, end_slope; /* derivative of t with respect to the fraction of this increase, at both ends */
    } inverse[CURVE_NODES];            /* cubic estimate of t at a load */
    Node start, end;                   /* ends of the table, computed from the polynomials */
    Node recent_nodes[3];              /* while the table is built: last three nodes of the piece */
    int piece_nodes;                   /* while the table is built: nodes of the piece so far */
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

/* Building a table: `curve_begin`; for each piece `curve_begin_piece` with its first node, then `curve_add_node` for an
 * even number of further nodes; `curve_finish`. A piece starts at the last node of the one before; the derivative of
 * the stiffness may jump between them. `error` is the relative error of the data themselves. `curve_add_node` returns
 * false if the table is full. */
void curve_begin(Curve *curve, double error);
void curve_begin_piece(Curve *curve, Node node);
bool curve_add_node(Curve *curve, Node node);
void curve_finish(Curve *curve);

/* Coefficients a of the polynomial between two nodes. */
void hermite_polynomial(const Node *p, const Node *q, double *a);

/* Segment that contains a displacement x inside the table. */
static inline int curve_find_segment(const Curve *curve, double x)
{
    const double position = (x - curve->x[0]) * curve->buckets_per_displacement;
    const int k = position < (double)CURVE_BUCKETS ? (int)position : CURVE_BUCKETS - 1;
    int low = curve->displacement_bucket[k], high = curve->displacement_bucket[k + 1];
    const int next_segment =
        low + ((low < high) & (x >= curve->x[low + 1])); /* in most buckets at most one segment starts */
    if (x >= curve->x[next_segment] && x < curve->x[next_segment + 1])
        return next_segment;
    while (low > 0 && x < curve->x[low]) /* round-off at the start of a bucket */
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

/* Load y[0] and its derivatives y[1], ... y[order] with respect to x, at t of a segment; order 1 to 4. */
static inline void segment_derivatives(const Curve *curve, int segment, double t, int order, double *y)
{
    const double *a = curve->coefficients[segment];
    const double inverse_length = curve->inverse_length[segment];
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

/* The same at any displacement x, also beyond the table. */
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
    if (!(curve->n > 2 && load >= curve->coefficients[1][0]))
        return 0;
    const uint64_t k = curve_bucket_of_load(curve, load);
    int low = curve->load_bucket[k], high = curve->load_bucket[k + 1];
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (load < curve->coefficients[middle][0])
            high = middle - 1;
        else
            low = middle;
    }
    return low;
}

/* Estimate of t at which segment i has a load, by a cubic. */
static inline double curve_estimate_inverse(const Curve *curve, int i, double load)
{
    const double load_fraction = (load - curve->coefficients[i][0]) * curve->inverse[i].inverse_load_rise;
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
        if (!(load >= curve->coefficients[i][0] && load < curve->coefficients[i + 1][0]))
            *segment = i = curve_find_segment_of_load(curve, load);
        const double *a = curve->coefficients[i];
        double t = curve_estimate_inverse(curve, i, load);
        for (int n = 0; n < 2; n++) {
            const double slope = polynomial_slope(a, t);
            const double half_curvature = (a[2] + t * 3.0 * a[3]) + t * t * (6.0 * a[4] + t * 10.0 * a[5]);
            const double inverse_slope = 1.0 / slope, step = (load - polynomial_value(a, t)) * inverse_slope;
            const double next = t + step * (1.0 - step * half_curvature * inverse_slope);
            if (!(fabs(half_curvature) <= 0.25 * slope && next >= 0.0 && next <= 1.0))
                break;
            if (fabs(step) <= MAX_FINAL_NEWTON_STEP) {
                const double x = curve->x[i] + next * (curve->x[i + 1] - curve->x[i]);
                *load_at_result = load + slope * ((x - curve->x[i]) * curve->inverse_length[i] - next);
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

/* Energy of a curve: integral of its load over the displacement, from the first node. */
typedef struct {
    double node_energy[CURVE_NODES];
} CurveEnergy;

void tabulate_energy(CurveEnergy *energy, const Curve *curve);

/* Energy at t of a segment. */
static inline double segment_energy(const CurveEnergy *energy, const Curve *curve, int segment, double t)
{
    const double *a = curve->coefficients[segment];
    const double t2 = t * t; /* in pairs, as in `polynomial_value` */
    const double mean = (a[0] + t * (a[1] * 0.5)) +
                        t2 * ((a[2] * (1.0 / 3.0) + t * (a[3] * 0.25)) + t2 * (a[4] * 0.2 + t * (a[5] * (1.0 / 6.0))));
    return energy->node_energy[segment] + (curve->x[segment + 1] - curve->x[segment]) * t * mean;
}

#endif
