/* Table of an interface law over the approach: the curve of the pressure, whose approach is the integral of dp/k, and
 * the law state (`law_state`: further quantities of the law) on the segments of the curve. */
#ifndef JOINTFMU_APPROACH_H
#define JOINTFMU_APPROACH_H

#include "curve.h"
#include "spot_distribution.h"

typedef struct {
    double closing_end_pressure; /* pressure [Pa] at zero approach, where the closing of the contact ends */
    double first_log_area,
        last_log_area; /* log-area of the largest spot at zero approach and at the end of the table */
} ApproachTable;

/* Tabulate with `steps` steps per unit of log-area. false: refused, with a reason, or without one if the table is
 * full. */
bool tabulate_approach(ApproachTable *approach, Curve *curve, const SpotDistribution *spots, const double *c, int steps,
                       Text *reason);

/* Coefficients of number q of the law state on a segment, of 1, t, ... t^5; constant in the closing. */
static inline double *state_polynomial(const Curve *curve, int segment, int q)
{
    return curve->further_coefficients[segment * N_LAW_STATE + q];
}

/* Law state and its derivative with respect to the approach, at t of a segment of the table. */
static inline void interpolate_law_state(const Curve *curve, int segment, double t, double *value, double *slope)
{
    for (int q = 0; q < N_LAW_STATE; q++) {
        const double *a = state_polynomial(curve, segment, q);
        value[q] = polynomial_value(a, t);
        slope[q] = polynomial_slope(a, t) * curve->segments[segment].inverse_length;
    }
}

/* Law state at a pressure, and its derivative with respect to the pressure, from the law instead of the table; `u` is a
 * first guess of the log-area. */
bool evaluate_law_state(const SpotDistribution *spots, const double *c, double pressure, double u, double *value,
                        double *slope, Text *reason);

#endif
