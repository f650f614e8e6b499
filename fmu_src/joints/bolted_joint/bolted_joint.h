/* Bolted joint: every node follows the curve of pressure over approach from its pressure at tightening; fewer
 * patches, which follow it as well, carry the friction. */
#ifndef JOINTFMU_BOLTED_JOINT_H
#define JOINTFMU_BOLTED_JOINT_H

#include "approach.h"
#include "data.h"
#include "energy.h"
#include "friction.h"

/* Arguments of `outputs`. */
enum { X_S_REL = N_SUMS, X_THETA = X_S_REL + 3, X_RATES = X_THETA + 3, X_P_MAX = X_RATES + 6, N_X };

typedef struct {
    Spots spots;
    Approach approach;
    Energy energy;
    Foundation foundation[MOST_PATCHES];
    bool memory;
    double mu, ratio, area;
    double weight[MOST_NODES][6]; /* share of a node alone, times x, y, y^2, x^2, x y */
    bool tight; /* the values at tightening are those of this preload and moment */
    double preload, moment;
    double start[MOST_NODES];           /* approach of each node at tightening */
    double tightened[MOST_NODES];       /* its pressure */
    double patch_start[MOST_PATCHES];   /* approach of each patch */
    double sums[3];                  /* of the pressures at tightening: alone, times x, times y */
    bool pressed;                    /* the normal sums below are those at tightening and this displacement */
    double apart[3], normal[N_SUMS], p_max;
    Point from[MOST_PATCHES], to[MOST_PATCHES]; /* of the last evaluation */
    int moved;                       /* how it has moved up to the last evaluation */
    double known[N_X];               /* arguments of `outputs` in it, for its derivative */
    double traction[MOST_PATCHES][2], along[3]; /* of the patches in it, and what `Further` has there */
    Work work; /* of the patch at hand */
} Kind;

#endif
