/* Bolted joint: every node follows the curve of pressure over approach from its pressure at tightening; fewer
 * patches, which follow it as well, carry the friction. */
#ifndef JOINTFMU_BOLTED_JOINT_H
#define JOINTFMU_BOLTED_JOINT_H

#include "approach.h"
#include "data.h"
#include "energy.h"
#include "friction.h"

/* The memory: 0 before it has begun, 1 after ways along x alone, 2 after others; heat so far, shift x, y and turn; then approaches, then forces. */
enum { BEGUN, LOSS, RIGID, APPROACHES = RIGID + 3, FORCES = APPROACHES + MOST_PATCHES };

typedef struct {
    Spots spots;
    Approach approach;
    Energy energy;
    Foundation foundation;
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
    bool straight;                   /* the last evaluation moved along x alone, as all did before */
    double loss;                     /* heat up to it [J] */
    double force[MOST_PATCHES][2][SLIDERS];
    Work work; /* of the patch at hand */
} Kind;

#endif
