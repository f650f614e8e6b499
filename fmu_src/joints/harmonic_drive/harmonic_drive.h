/* Harmonic drive: torque over wind-up, odd. */
#ifndef JOINTFMU_HARMONIC_DRIVE_H
#define JOINTFMU_HARMONIC_DRIVE_H

#include "hysteresis.h"

typedef struct {
    double smoothing, max_torque, K_FTS0; /* of the drive */
    Hysteresis hysteresis;
    bool errs;  /* there is a kinematic error */
    double phi; /* wind-up of the last evaluation */
} Kind;

#endif
