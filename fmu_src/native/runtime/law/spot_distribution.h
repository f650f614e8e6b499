/* Interface law for one parameter set: distribution of the contact spots, and log-area u of the largest spot at a
 * pressure. Log-areas are logarithms of the area of the largest spot over a reference area.
 *
 * The functions law_... are generated from the Python package into law.c. The log-areas of `law_range_bounds` separate
 * ranges of u with different terms of the sums over the spots; each range has its own functions law_..._0,
 * law_..._1. */
#ifndef JOINTFMU_SPOT_DISTRIBUTION_H
#define JOINTFMU_SPOT_DISTRIBUTION_H

#include <stdbool.h>

#include "law.h"
#include "text.h"

typedef struct {
    double nominal_area;    /* A_0 [m2] */
    double max_pressure;    /* [Pa] of the law */
    double reference_area;  /* spot area [m2] at log-area 0 */
    double size_exponent;   /* exponent m of the size distribution of the spots [1] */
    double stiffness_onset; /* log-area up to which all spots are plastic: no stiffness */
    double first_kink_log_area;      /* log-area from which the stiffness is a spline; infinity: nowhere */
    int n_regime_ends;
    double
        regime_ends[N_LAW_REGIME_ENDS + 1]; /* log-areas, ascending, at which the derivative of the stiffness jumps */
    double range_bounds[N_LAW_RANGE_BOUNDS + 1]; /* log-areas that separate the ranges of the functions law_... */
    double min_log_load, max_log_load;           /* logarithms of the smallest and largest representable load [N] */
} SpotDistribution;

/* Set all members from the constants c of the joint; false: loads are not representable, with the reason. */
bool set_spot_distribution(SpotDistribution *spots, const double *c, Text *reason);

/* Sums over all spots at u, each with its derivative with respect to u: y = F, F', K_n, K_n', ... */
void spot_totals(const SpotDistribution *spots, const double *c, double u, double *y);

/* Number of the range of u: law_..._0, law_..._1, ... */
int find_law_range(const SpotDistribution *spots, double u);

/* Log-area u of the largest spot at a nominal pressure > 0 [Pa], from a first guess u; `slope` is d(ln F)/du there.
 * false: refused, with the reason. */
bool solve_largest_spot(const SpotDistribution *spots, const double *c, double pressure, double *u, double *slope,
                        Text *reason);

#endif
