/* Harmonic drive: torque over wind-up, odd. */
#ifndef JOINTFMU_HARMONIC_DRIVE_H
#define JOINTFMU_HARMONIC_DRIVE_H

#include "friction.h"
#include "hysteresis.h"

typedef struct {
    Hysteresis hysteresis;
    Friction friction;
    bool errs;  /* there is a kinematic error */
    double phi; /* of the last evaluation, for its derivative: wind-up, what moves the friction, both sums */
    Turn turn;
    SliderSum slid, braked;
} Kind;

#endif
