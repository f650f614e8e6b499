/* Dry friction with memory at the wave generator: sliders in parallel, spring and friction each. */
#ifndef JOINTFMU_FRICTION_H
#define JOINTFMU_FRICTION_H

#include <stdbool.h>

#include "sliders.h"

typedef struct {
    bool acts;
    double K[BRAKES], per_K[BRAKES]; /* of each slider */
} Friction;

/* Angle and speed of the wave generator, and the limits of its friction; or rates of them. */
typedef struct {
    double angle, speed, limit[2];
} Turn;

void friction_of(Friction *friction, double stiffness);
/* Torque and loss on the straight path from a memory, and the memory after it. */
SliderSum friction_at(const Friction *friction, const double *memory, Turn turn, double *after);
/* Their derivative along a rate. */
SliderSum friction_rate(const Friction *friction, const double *memory, Turn turn, Turn rate);

#endif
