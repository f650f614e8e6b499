/* Harmonic drive: torque over wind-up, odd; sliders in parallel, spring and friction each, give the hysteresis beside
 * it and the dry friction at the wave generator. */
#ifndef JOINTFMU_HARMONIC_DRIVE_H
#define JOINTFMU_HARMONIC_DRIVE_H

#include <stdbool.h>

#include "curve.h"
#include "sliders.h"
#include "text.h"

/* Torque, and its derivatives up to an order (2 at most), of the odd midline at a wind-up. */
void midline(const Curve *curve, double phi, int order, double *y);
/* Wind-up at which it carries a torque. */
double midline_inverse(const Curve *curve, double torque);

typedef struct {
    bool acts;
    double most;            /* friction of all */
    double length;          /* wind-up over which the sliders begin to slip */
    double K[HYSTERESIS_SLIDERS], per_K[HYSTERESIS_SLIDERS], limit[HYSTERESIS_SLIDERS]; /* of each slider */
} Hysteresis;

/* Numbers of a drive and of its sliders, and its midline; false: refused. */
bool hysteresis_of(Hysteresis *hysteresis, const double *head, const double *share, const Curve *curve,
                   Text *why);
/* What the sliders give on the straight path from a memory to a wind-up, and their forces after it. */
SliderSum hysteresis_at(const Hysteresis *hysteresis, const double *memory, double phi, double *after);
/* Derivative of the loss in the wind-up. */
double hysteresis_heat(const Hysteresis *hysteresis, const double *memory, double phi);
/* Wind-up at which midline and sliders carry a torque, coming from a memory. */
double hysteresis_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *memory,
                          double torque);

typedef struct {
    bool acts;
    double K[FRICTION_SLIDERS], per_K[FRICTION_SLIDERS]; /* of each slider */
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

typedef struct {
    Hysteresis hysteresis;
    Friction friction;
    bool errs;  /* there is a kinematic error */
    double phi; /* of the last evaluation, for its derivative: wind-up, what moves the friction, both sums */
    Turn turn;
    SliderSum slid, braked;
} Kind;

#endif
