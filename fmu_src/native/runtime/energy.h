/* Energy of a curve: the integral of its load from its first node. */
#ifndef JOINTFMU_ENERGY_H
#define JOINTFMU_ENERGY_H

#include "curve.h"

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
