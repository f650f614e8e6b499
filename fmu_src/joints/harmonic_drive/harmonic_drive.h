/* Harmonic drive: torque over wind-up, odd. */
#ifndef JOINTFMU_HARMONIC_DRIVE_H
#define JOINTFMU_HARMONIC_DRIVE_H

#include "hysteresis.h"

typedef struct {
    Hysteresis hysteresis;
    double phi; /* wind-up of the last evaluation */
} Kind;

#endif
