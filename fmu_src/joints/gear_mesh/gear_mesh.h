/* Gear mesh: load over deflection of a tooth pair, whose rough flanks and bending teeth are in series. */
#ifndef JOINTFMU_MESH_H
#define JOINTFMU_MESH_H

#include "approach.h"

typedef struct {
    Spots spots;
    Approach approach;
    Curve flanks;               /* pressure over approach; the pair's table is made of it */
    double closing;             /* [m] deflection of a pair at which the closing of its contact ends */
    Energy energy;              /* [J] of a pair */
} Kind;

#endif
