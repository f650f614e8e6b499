/* The curve of pressure over approach of an interface: the integral of dp/k from separation, and what the
 * law has beside at the same approach (law_state), on the segments of the curve. */
#ifndef JOINTFMU_APPROACH_H
#define JOINTFMU_APPROACH_H

#include "curve.h"
#include "spots.h"

enum { APPROACH_STATES = N_LAW_STATE > 0 ? N_LAW_STATE : 1 }; /* an array has an element */

typedef struct {
    double closed;      /* pressure [Pa] at the end of the closing, at zero approach */
    double first, last; /* log-areas of the largest spot there and at the end of the table */
    double state[CURVE_NODES][APPROACH_STATES][6]; /* of 1, t, ... t^5; in the closing that at its end */
} Approach;

/* Build with so many steps per unit of log-area; false: refused with a reason, or the table is full. */
bool approach_tabulate(Approach *approach, Curve *curve, const Spots *spots, const double *c, int steps,
                       Text *why);

/* The state and its slope in the approach inside the table, at t of a segment. */
static inline void approach_state(const Approach *approach, const Curve *curve, int segment, double t,
                                  double *value, double *slope)
{
    for (int q = 0; q < N_LAW_STATE; q++) {
        const double *a = approach->state[segment][q];
        value[q] = curve_value(a, t);
        slope[q] = curve_slope(a, t) * curve->per[segment];
    }
}

/* The state under a pressure and its slope in the pressure by the law itself; `u` is a first guess. */
bool approach_exact(const Spots *spots, const double *c, double pressure, double u, double *value,
                    double *slope, Text *why);

#endif
