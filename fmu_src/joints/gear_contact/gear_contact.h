/* Gear contact: approach over load, with the real contact area of the law at that load. */
#ifndef JOINTFMU_GEAR_CONTACT_H
#define JOINTFMU_GEAR_CONTACT_H

#include "approach.h"

typedef struct {
    Spots spots;
    Approach approach;
} Kind;

#endif
