/* Harmonic drive: odd curve of torque over wind-up (midline). Parallel Jenkins sliders model its hysteresis, and the
 * dry friction at the wave generator. */
#ifndef JOINTFMU_HARMONIC_DRIVE_H
#define JOINTFMU_HARMONIC_DRIVE_H

#include <stdbool.h>

#include "curve.h"
#include "jenkins.h"
#include "text.h"

/* Torque y[0] of the midline at a wind-up [rad] of either sign, and its derivatives up to `order`, 1 or 2. */
void midline_torque(const Curve *curve, double phi, int order, double *y);
/* Wind-up [rad] of the midline at a torque [N.m] of either sign. */
double midline_wind_up(const Curve *curve, double torque);

typedef struct {
    bool has_friction;             /* the drive has hysteresis */
    bool use_avx;                  /* see simd.h */
    double limit_torque;           /* M_f, sum of the friction limits [N.m] */
    double characteristic_wind_up; /* M_f/K_h [rad] */
    double K[HYSTERESIS_SLIDER_COUNT], compliance[HYSTERESIS_SLIDER_COUNT], limit[HYSTERESIS_SLIDER_COUNT];
} Hysteresis;

/* Sliders from `hysteresis_constants`, `slider_shares` and the midline. false: refused, with the reason. */
bool hysteresis_tabulate(Hysteresis *hysteresis, const double *constants, const double *shares, const Curve *curve,
                         Text *reason);
/* Update of the sliders from a history on a straight path to the wind-up phi; `history_end` gets their forces. */
SliderResultant hysteresis_advance(const Hysteresis *hysteresis, const double *history, double phi,
                                   double *history_end);
/* Derivative of the dissipated energy with respect to the wind-up. */
double hysteresis_loss_derivative(const Hysteresis *hysteresis, const double *history, double phi);
/* Wind-up [rad] at which midline and sliders carry a torque [N.m], from a history. */
double hysteresis_solve_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *history, double torque);

typedef struct {
    bool has_friction; /* the drive has dry friction */
    bool use_avx;      /* see simd.h */
    double K[FRICTION_SLIDER_COUNT], compliance[FRICTION_SLIDER_COUNT];
} Friction;

/* Angle [rad] and speed [rad/s] of the wave generator, and its limits [N.m] of positive and of negative friction; or
 * their rates. */
typedef struct {
    double angle, speed, limit[2];
} FrictionArguments;

/* Sliders from the total stiffness of their springs [N.m/rad]. */
void friction_tabulate(Friction *friction, double stiffness);
/* Friction torque and loss of a straight path from a history, and the history at its end. */
SliderResultant friction_advance(const Friction *friction, const double *history, FrictionArguments arguments,
                                 double *history_end);
/* Rates of torque and loss. */
SliderResultant friction_rate(const Friction *friction, const double *history, FrictionArguments arguments,
                              FrictionArguments rate);

/* Results of `periodic_terms`: kinematic error, its first and second derivative with respect to phi1, ripple of the
 * friction limits, its derivative. */
enum { ERROR, ERROR_SLOPE, ERROR_BEND, RIPPLE, RIPPLE_SLOPE, N_PERIODIC_TERMS };

typedef struct {
    Hysteresis hysteresis;
    Friction friction;
    bool has_periodic_terms;
    /* Of the last evaluation, for its derivative: wind-up [rad], results of `periodic_terms`, arguments of the friction,
     * updates of the sliders. */
    double phi, periodic[N_PERIODIC_TERMS];
    FrictionArguments friction_arguments;
    SliderResultant hysteresis_update, friction_update;
} JointModel;

#endif
