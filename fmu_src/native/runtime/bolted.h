/* Bolted joint: every node follows the curve of pressure over approach from its pressure at tightening. */
#ifndef JOINTFMU_BOLTED_H
#define JOINTFMU_BOLTED_H

#include "approach.h"

typedef struct {
    Spots spots;
    Approach approach;
    bool tight;                            /* the node values below are those of this preload and moment */
    double preload, moment;
    double start[N_NODES], tightened[N_NODES]; /* approach and pressure of each node at tightening */
} Kind;

#endif
