/* Repeats `solve_largest_spot` in interface.py of the package for a single pressure; the functions of the law are
 * generated. */
#include "spot_distribution.h"

#include <math.h>

_Static_assert(N_LAW_DISTRIBUTION == 6, "the members of SpotDistribution that set_spot_distribution reads");

int find_law_range(const SpotDistribution *spots, double u)
{
    int k = 0;
    while (k < N_LAW_RANGE_BOUNDS && u > spots->range_bounds[k])
        k++;
    return k;
}

/* Logarithm of the load at u, and its derivative with respect to u. */
static void evaluate_log_load(const SpotDistribution *spots, const double *c, double u, double *y)
{
    law_load[find_law_range(spots, u)](&u, c, y);
}

void spot_totals(const SpotDistribution *spots, const double *c, double u, double *y)
{
    law_totals[find_law_range(spots, u)](&u, c, y);
}

/* Set the ends of the regimes: sorted, without duplicates. */
static void set_regime_ends(SpotDistribution *spots, const double *log_areas)
{
    spots->n_regime_ends = 0;
    for (int i = 0; i < N_LAW_REGIME_ENDS; i++) {
        int position = 0;
        while (position < spots->n_regime_ends && spots->regime_ends[position] < log_areas[i])
            position++;
        if (position < spots->n_regime_ends && spots->regime_ends[position] == log_areas[i])
            continue;
        for (int j = spots->n_regime_ends++; j > position; j--)
            spots->regime_ends[j] = spots->regime_ends[j - 1];
        spots->regime_ends[position] = log_areas[i];
    }
}

bool set_spot_distribution(SpotDistribution *spots, const double *c, Text *reason)
{
    double values[N_LAW_DISTRIBUTION], ends[N_LAW_REGIME_ENDS], log_load[2], totals[N_LAW_TOTALS];
    law_distribution(0, c, values);
    spots->nominal_area = values[0];
    spots->max_pressure = values[1];
    spots->reference_area = values[2];
    spots->size_exponent = values[3];
    spots->stiffness_onset = values[4];
    spots->first_kink_log_area = values[5];
    law_range_bounds(0, c, spots->range_bounds);
    law_regime_ends(0, c, ends);
    set_regime_ends(spots, ends);
    bool is_representable =
        isfinite(spots->reference_area) && spots->reference_area > 0.0 && isfinite(1.0 / spots->reference_area);
    const double test_points[] = {MIN_LOG_AREA, 0.0, MAX_LOG_AREA};
    for (int i = 0; i < 3; i++) {
        evaluate_log_load(spots, c, test_points[i], log_load);
        spot_totals(spots, c, test_points[i], totals);
        is_representable = is_representable && isfinite(log_load[0]) && isfinite(log_load[1]) && isfinite(totals[0]);
        if (i == 0)
            spots->min_log_load = log_load[0];
        spots->max_log_load = log_load[0];
    }
    if (!is_representable)
        text_append_format(reason,
                           "the critical spot area, %g m2, or a contact load is too small or too large to be computed; "
                           "check the parameters: D close to an end of its interval, or an extreme value of G or h",
                           spots->reference_area);
    return is_representable;
}

bool solve_largest_spot(const SpotDistribution *spots, const double *c, double pressure, double *u, double *slope,
                        Text *reason)
{
    const double log_load = portable_log(pressure * spots->nominal_area);
    if (!(log_load >= spots->min_log_load && log_load <= spots->max_log_load)) {
        text_append_format(reason,
                           "pressure = %g Pa is outside [%.3g, %.3g]: the largest contact spot is too small or too "
                           "large to be computed (critical area of the surface: %.3g m2)",
                           pressure, portable_exp(spots->min_log_load) / spots->nominal_area,
                           portable_exp(spots->max_log_load) / spots->nominal_area, spots->reference_area);
        return false;
    }
    double x = *u, low = -INFINITY, high = INFINITY, y[2] = {0.0, 1.0};
    for (int k = 0; k < MAX_INVERSION_ITERATIONS; k++) {
        evaluate_log_load(spots, c, x, y);
        const double residual = log_load - y[0];
        const double a = residual / (MIN_LOG_LOAD_SLOPE * spots->size_exponent), b = residual / MAX_LOG_LOAD_SLOPE;
        const double min_step = fmin(a, b), max_step = fmax(a, b);
        const double step = fmin(fmax(residual / y[1], min_step), max_step);
        low = fmax(low, x + min_step);
        high = fmin(high, x + max_step);
        x = fmin(fmax(x + step, low), high);
        if (fabs(residual) <= NEWTON_TOLERANCE) {
            *u = x;
            *slope = y[1];
            return true;
        }
    }
    text_append_format(reason,
                       "the iteration for the largest contact spot did not converge at pressure = %g Pa; "
                       "check the parameters and the pressure",
                       pressure);
    return false;
}
