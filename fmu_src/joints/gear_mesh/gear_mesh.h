/* Gear mesh: load over deflection of a tooth pair, with its rough flanks and bending teeth in series. */
#ifndef JOINTFMU_GEAR_MESH_H
#define JOINTFMU_GEAR_MESH_H

#include "approach.h"

typedef struct {
    SpotDistribution spots;
    ApproachTable approach;
    Curve flanks;       /* pressure over approach of the flanks, while the curve of the pair is computed from it */
    double closing_end_deflection; /* deflection of a pair [m] at which the closing of its contact ends */
} JointModel;

#endif
