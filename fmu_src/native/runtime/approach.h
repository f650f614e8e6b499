/* The curve of pressure over approach of an interface: the integral of dp/k from separation. */
#ifndef JOINTFMU_APPROACH_H
#define JOINTFMU_APPROACH_H

#include "curve.h"
#include "spots.h"

typedef struct {
    double closed;            /* pressure [Pa] at the end of the closing, at zero approach */
    double u[CURVE_NODES];    /* log-area of the largest spot at each node of the curve ... */
    double rate[CURVE_NODES]; /* ... and its derivative by the approach */
} Approach;

/* Build with so many steps per unit of log-area; false: refused with a reason, or the table is full. */
bool approach_tabulate(Approach *approach, Curve *curve, const Spots *spots, const double *c, int steps,
                       Text *why);

/* A first guess of the log-area of the largest spot at an approach: a cubic on each segment. */
double approach_guess(const Approach *approach, const Curve *curve, double x);

#endif
