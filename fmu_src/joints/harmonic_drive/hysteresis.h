/* Friction torque with memory of a harmonic drive: sliders in parallel, spring and friction each. */
#ifndef JOINTFMU_HYSTERESIS_H
#define JOINTFMU_HYSTERESIS_H

#include "curve.h"
#include "sliders.h"
#include "text.h"

typedef struct {
    bool acts;
    double most;            /* friction of all */
    double length;          /* wind-up over which the sliders begin to slip */
    double K[SLIDERS], per_K[SLIDERS], limit[SLIDERS]; /* of each slider */
} Hysteresis;

/* Numbers of a drive and of its sliders, and its midline; false: refused. */
bool hysteresis_of(Hysteresis *hysteresis, const double *head, const double *share, const Curve *curve,
                   Text *why);

/* Torque, and its derivatives up to an order (2 at most), of the odd midline at a wind-up. */
void midline(const Curve *curve, double phi, int order, double *y);
/* Wind-up at which it carries a torque. */
double midline_inverse(const Curve *curve, double torque);

/* Those on the straight path from a memory to a wind-up: what they give, and their forces after it. */
SliderSum hysteresis_at(const Hysteresis *hysteresis, const double *memory, double phi, double *after);
/* Derivative of the loss in the wind-up. */
double hysteresis_heat(const Hysteresis *hysteresis, const double *memory, double phi);

/* Wind-up at which midline and sliders carry a torque, coming from a memory. */
double hysteresis_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *memory,
                          double torque);

#endif
