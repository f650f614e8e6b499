/* Dry friction with memory at the wave generator: sliders in parallel, spring and friction each.
 *
 * Memory: their forces, the wave generator's angle, the limit of the friction, 1 once it has begun. */
#ifndef JOINTFMU_FRICTION_H
#define JOINTFMU_FRICTION_H

#include <stdbool.h>

#include "law.h"

enum { AT_ANGLE = BRAKES, AT_LIMIT, AT_BEGUN, N_BRAKES }; /* of the memory */

typedef struct {
    bool acts;
    double spring[BRAKES]; /* of each slider */
    double compliance[BRAKES];
} Friction;

/* Angle and speed of the wave generator, and the limit of its friction; or rates of them. */
typedef struct {
    double angle, speed, limit;
} Turn;

/* What the sliders do on the straight path from a memory; or its rate. */
typedef struct {
    double torque, loss;
} Braked;

void friction_of(Friction *friction, double stiffness);
Braked friction_at(const Friction *friction, const double *memory, Turn turn);
/* Its derivative along a rate. */
Braked friction_rate(const Friction *friction, const double *memory, Turn turn, Turn rate);
/* The memory after such a path; `rest` where nothing acts. */
void friction_move(const Friction *friction, const double *before, Turn turn, double *after);
void friction_rest(double *after);

#endif
