/* Bolted joint: every node follows the curve of pressure over approach from its pressure at tightening. */
#ifndef JOINTFMU_BOLTED_JOINT_H
#define JOINTFMU_BOLTED_JOINT_H

#include "approach.h"

/* A node at a displacement. */
typedef struct {
    double curve[5];                                 /* pressure and its derivatives by the approach */
    double works[N_LAW_STATE], slopes[N_LAW_STATE]; /* works of the law and their slopes in the pressure */
} NodeState;

typedef struct {
    Spots spots;
    Approach approach;
    bool tight;                            /* the node values below are those of this preload and moment */
    double preload, moment;
    double start[N_NODES], tightened[N_NODES]; /* approach and pressure of each node at tightening */
    bool pressed;                              /* and these of this normal displacement */
    double apart;
    NodeState nodes[N_NODES];
} Kind;

#endif
