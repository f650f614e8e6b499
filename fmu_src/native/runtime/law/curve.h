/* Monotone force law as a table: load over displacement with its exact derivatives.
 *
 * A quintic per segment through load, stiffness and the stiffness' derivative at its two nodes. Beyond
 * the ends the last tangent continues. */
#ifndef JOINTFMU_CURVE_H
#define JOINTFMU_CURVE_H

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "law.h"

enum { CURVE_BUCKETS = 1024 };
_Static_assert(CURVE_NODES <= USHRT_MAX, "a bucket holds the number of a segment");

/* Largest Newton step in t after which one of third order, with a slope that changes by no more than half,
 * is right to round-off. */
#define CURVE_NEAR 8e-6

typedef struct {
    double x;    /* displacement */
    double y;    /* load */
    double s;    /* stiffness dy/dx */
    double bend; /* ds/dx */
} Node;

typedef struct {
    int n;        /* nodes; n - 1 segments */
    double error; /* largest relative interpolation error of load and stiffness, measured when built */
    double x[CURVE_NODES];
    double a[CURVE_NODES][6]; /* of 1, t, ... t^5 on each segment, t from 0 to 1 */
    double per[CURVE_NODES];  /* segments like this one per displacement */
    struct {
        double per_load;   /* the same per load */
        double begin, end; /* dt over the part of its load, at the two ends */
    } inverse[CURVE_NODES];
    Node first, end;          /* the two ends as the polynomials have them */
    Node last[3];             /* the last nodes of the piece under construction */
    int piece;                /* nodes of this piece so far */
    double per_bucket;        /* buckets per displacement */
    unsigned short bucket[CURVE_BUCKETS + 1]; /* segment at the beginning of each bucket */
    unsigned shift;           /* bits of a load that all loads of a bucket may differ in */
    uint64_t first_bits;      /* the others, of the load where the second segment begins */
    unsigned short load_bucket[CURVE_BUCKETS + 1]; /* last segment that begins before each bucket */
} Curve;

/* A polynomial of a segment and its slope in t: in pairs, which a processor evaluates at the same time. */
static inline double curve_value(const double *a, double t)
{
    const double square = t * t;
    return (a[0] + t * a[1]) + square * ((a[2] + t * a[3]) + square * (a[4] + t * a[5]));
}

static inline double curve_slope(const double *a, double t)
{
    const double square = t * t;
    return (a[1] + t * (2.0 * a[2])) + square * ((3.0 * a[3] + t * (4.0 * a[4])) + square * (5.0 * a[5]));
}

/* Build: begin, then for each piece its first node with `curve_piece` and an even number of further ones
 * with `curve_add`, then finish. A piece begins where the one before ended; between pieces the derivative
 * of the stiffness may jump. The error is measured against the curve through every second node, halved.
 * curve_add returns false if the table is full. */
void curve_begin(Curve *curve, double error);
void curve_piece(Curve *curve, Node node);
bool curve_add(Curve *curve, Node node);
void curve_finish(Curve *curve);

/* The polynomial in t from 0 to 1 between two nodes. */
void curve_polynomial(const Node *p, const Node *q, double *a);

/* Segment that holds an x of the table, which ends with curve->end.x. */
static inline int curve_segment(const Curve *curve, double x)
{
    const double place = (x - curve->x[0]) * curve->per_bucket;
    const int k = place < (double)CURVE_BUCKETS ? (int)place : CURVE_BUCKETS - 1;
    int low = curve->bucket[k], high = curve->bucket[k + 1];
    const int near = low + ((low < high) & (x >= curve->x[low + 1])); /* most buckets hold one beginning or none */
    if (x >= curve->x[near] && x < curve->x[near + 1])
        return near;
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

/* y[0] load, y[1] ... y[order] its derivatives at t of a segment; order 1 to 4. */
static inline void curve_derivatives(const Curve *curve, int segment, double t, int order, double *y)
{
    const double *a = curve->a[segment];
    const double per = curve->per[segment];
    y[0] = curve_value(a, t);
    y[1] = curve_slope(a, t) * per;
    if (order >= 2)
        y[2] = (2.0 * a[2] + t * (6.0 * a[3] + t * (12.0 * a[4] + t * 20.0 * a[5]))) * (per * per);
    if (order >= 3)
        y[3] = (6.0 * a[3] + t * (24.0 * a[4] + t * 60.0 * a[5])) * (per * per * per);
    if (order >= 4)
        y[4] = (24.0 * a[4] + t * 120.0 * a[5]) * (per * per * per * per);
}

/* y[0] load, y[1] ... y[order] its derivatives at x; order 1 to 4. */
void curve_at(const Curve *curve, double x, int order, double *y);

/* Number of the bucket of a load from the second segment on: its bits grow with it. */
static inline uint64_t curve_load_bucket(const Curve *curve, double load)
{
    uint64_t bits;
    memcpy(&bits, &load, sizeof bits);
    return (bits >> curve->shift) - curve->first_bits;
}

static inline int curve_segment_of_load(const Curve *curve, double load)
{
    if (!(curve->n > 2 && load >= curve->a[1][0]))
        return 0;
    const uint64_t k = curve_load_bucket(curve, load);
    int low = curve->load_bucket[k], high = curve->load_bucket[k + 1];
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        if (load < curve->a[middle][0])
            high = middle - 1;
        else
            low = middle;
    }
    return low;
}

/* Where a segment has a load, by the cubic of the inverse. */
static inline double curve_guess(const Curve *curve, int i, double load)
{
    const double part = (load - curve->a[i][0]) * curve->inverse[i].per_load;
    const double begin = curve->inverse[i].begin, end = curve->inverse[i].end;
    const double t = part * (begin + part * ((3.0 - 2.0 * begin - end) + part * (begin + end - 2.0)));
    return t > 0.0 ? (t < 1.0 ? t : 1.0) : 0.0;
}

/* Displacement at which the table carries a load, to round-off; the first node below the table if it
 * begins flat. By Newton steps that cannot leave the segment. */
double curve_inverse_safe(const Curve *curve, double load);

/* The same, and the load at the displacement as it is rounded: one step of third order from the cubic, or two, where
 * that is near enough for round-off. The search begins at a segment, 0 if none is known, and leaves its own. */
static inline double curve_inverse(const Curve *curve, double load, int *segment, double *carried)
{
    if (load > curve->first.y && load < curve->end.y) {
        int i = *segment;
        if (!(load >= curve->a[i][0] && load < curve->a[i + 1][0]))
            *segment = i = curve_segment_of_load(curve, load);
        const double *a = curve->a[i];
        double t = curve_guess(curve, i, load);
        for (int n = 0; n < 2; n++) {
            const double s = curve_slope(a, t);
            const double bend = (a[2] + t * 3.0 * a[3]) + t * t * (6.0 * a[4] + t * 10.0 * a[5]); /* half of it */
            const double per = 1.0 / s, step = (load - curve_value(a, t)) * per;
            const double next = t + step * (1.0 - step * bend * per);
            if (!(fabs(bend) <= 0.25 * s && next >= 0.0 && next <= 1.0))
                break;
            if (fabs(step) <= CURVE_NEAR) {
                const double x = curve->x[i] + next * (curve->x[i + 1] - curve->x[i]);
                *carried = load + s * ((x - curve->x[i]) * curve->per[i] - next);
                return x;
            }
            t = next;
        }
    }
    double y[2];
    const double x = curve_inverse_safe(curve, load);
    curve_at(curve, x, 1, y);
    *carried = y[0];
    return x;
}

/* Energy of a curve: the integral of its load from its first node. */
typedef struct {
    double at[CURVE_NODES]; /* at the nodes */
} Energy;

void energy_tabulate(Energy *energy, const Curve *curve);

/* At t of a segment. */
static inline double energy_inside(const Energy *energy, const Curve *curve, int segment, double t)
{
    const double *a = curve->a[segment];
    const double square = t * t; /* in pairs, as `curve_value` */
    const double mean = (a[0] + t * (a[1] * 0.5)) +
        square * ((a[2] * (1.0 / 3.0) + t * (a[3] * 0.25)) + square * (a[4] * 0.2 + t * (a[5] * (1.0 / 6.0))));
    return energy->at[segment] + (curve->x[segment + 1] - curve->x[segment]) * t * mean;
}

#endif
