/* Gear contact: approach, stiffness and real contact area at a load. */
#ifndef JOINTFMU_GEAR_CONTACT_H
#define JOINTFMU_GEAR_CONTACT_H

#include "approach.h"

typedef struct {
    SpotDistribution spots;
    ApproachTable approach;
} JointModel;

#endif
