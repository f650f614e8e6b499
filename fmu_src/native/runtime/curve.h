/* Monotone force law as a table: load over displacement with its exact derivatives.
 *
 * A quintic per segment through load, stiffness and the stiffness' derivative at its two nodes. Beyond
 * the ends the last tangent continues. */
#ifndef JOINTFMU_CURVE_H
#define JOINTFMU_CURVE_H

#include <stdbool.h>

enum { CURVE_NODES = 2600, CURVE_BUCKETS = 1024 };

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
    Node first, end;          /* the two ends as the polynomials have them */
    Node last[3];             /* the last nodes of the piece under construction */
    int piece;                /* nodes of this piece so far */
    double per_bucket;        /* buckets per displacement */
    unsigned short bucket[CURVE_BUCKETS + 1]; /* segment at the beginning of each bucket */
} Curve;

/* Build: begin, then for each piece its first node with `curve_piece` and an even number of further ones
 * with `curve_add`, then finish. A piece begins where the one before ended; between pieces the derivative
 * of the stiffness may jump. The error is measured against the curve through every second node, halved.
 * curve_add returns false if the table is full. */
void curve_begin(Curve *curve, double error);
void curve_piece(Curve *curve, Node node);
bool curve_add(Curve *curve, Node node);
void curve_finish(Curve *curve);

/* Segment that holds x, and where in it (0 to 1); of an x beyond the table that at its end. */
int curve_segment(const Curve *curve, double x, double *t);

/* y[0] load, y[1] ... y[order] its derivatives at x; order 1 to 4. */
void curve_at(const Curve *curve, double x, int order, double *y);

/* Displacement at which the table carries a load, to round-off; the first node below the table if it
 * begins flat. */
double curve_inverse(const Curve *curve, double load);

#endif
