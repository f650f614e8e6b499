/* Table of an interface law over the approach: the curve of the pressure, whose approach is the integral of dp/k, and
 * the law state (`law_state`: further quantities of the law) on the segments of the curve. */
#ifndef JOINTFMU_APPROACH_H
#define JOINTFMU_APPROACH_H

#include "curve.h"
#include "spot_distribution.h"

enum { LAW_STATE_SIZE = N_LAW_STATE > 0 ? N_LAW_STATE : 1 }; /* C has no empty arrays */

typedef struct {
    double closing_end_pressure; /* pressure [Pa] at zero approach, where the closing of the contact ends */
    double first_log_area,
        last_log_area; /* log-area of the largest spot at zero approach and at the end of the table */
    double state_polynomial[CURVE_NODES][LAW_STATE_SIZE]
                           [6]; /* coefficients of 1, t, ... t^5 on each segment; constant in the closing */
} ApproachTable;

/* Tabulate with `steps` steps per unit of log-area. false: refused, with a reason, or without one if the table is
 * full. */
bool tabulate_approach(ApproachTable *approach, Curve *curve, const SpotDistribution *spots, const double *c, int steps,
                       Text *reason);

/* Law state and its derivative with respect to the approach, at t of a segment of the table. */
static inline void interpolate_law_state(const ApproachTable *approach, const Curve *curve, int segment, double t,
                                         double *value, double *slope)
{
    for (int q = 0; q < N_LAW_STATE; q++) {
        const double *a = approach->state_polynomial[segment][q];
        value[q] = polynomial_value(a, t);
        slope[q] = polynomial_slope(a, t) * curve->inverse_length[segment];
    }
}

/* Law state at a pressure, and its derivative with respect to the pressure, from the law instead of the table; `u` is a
 * first guess of the log-area. */
bool evaluate_law_state(const SpotDistribution *spots, const double *c, double pressure, double u, double *value,
                        double *slope, Text *reason);

#endif
