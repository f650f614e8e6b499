/* Parallel Jenkins sliders (spring and dry friction in series): loops over the return mapping of one slider, which is
 * generated from jenkins.py of the package. In any consistent units, also per area. */
#ifndef JOINTFMU_JENKINS_H
#define JOINTFMU_JENKINS_H

#include <stdbool.h>
#include <stddef.h>

#include "law.h"

enum { MAX_SLIDERS = 48 }; /* in one call; the number of sliders is always even */

/* Sliders with displacements along one direction: springs K and 1/K (0 without spring), friction limits at the start
 * and at the end of the increment, forces at the start. */
typedef struct {
    const double *K, *compliance, *limit_start, *limit_end, *force;
} Sliders1D;

/* Sliders of a patch with displacements in its plane.
 *
 * displacement       : increment along x, along y and around the centre of the patch
 * torsion_directions : displacement of each slider along x and y over that around the centre
 * retention, secant_stiffness : elastic predictor, retention times force plus secant_stiffness times displacement
 * growth_start, growth_end    : [m] friction coefficient over stiffness ratio, times the approach. The friction limit
 *                               is limit_start + K growth_start at the start of the increment, and limit_end +
 *                               K growth_end at its end, but at least 0 */
typedef struct {
    const double *force[2], *torsion_directions[2], *retention, *secant_stiffness;
    const double *K, *compliance, *limit_start, *limit_end;
    double growth_start, growth_end, displacement[3];
} Sliders2D;

/* Displacement, or its rate, of slider k along x (d = 0) or y (d = 1). */
static inline double slider_displacement(const double *const torsion_directions[2], int k, const double displacement[3],
                                         int d)
{
    return displacement[d] + displacement[2] * torsion_directions[d][k];
}

/* Friction limit of a slider, see Sliders2D; round-off would make it negative where its springs just touch. */
static inline double limit_at_growth(double limit_at_zero_growth, double K, double growth)
{
    const double new_limit = limit_at_zero_growth + K * growth;
    return new_limit > 0.0 ? new_limit : 0.0;
}

/* Sums over sliders: force along x, along y and around the centre; tangent stiffness xx, xy, yy, xr, yr, rr for a
 * further displacement, r around the centre; dissipated energy. Along one direction the tangent is xx along it and yy
 * across. */
typedef struct {
    double force[3], tangent[6], loss;
} SliderResultant;

/* Functions along one direction: the number n of sliders is a multiple of four. */

/* Return-map the sliders for a displacement. If `limit_start` and `limit_end` are the same array, the limits are
 * constant, which is faster. */
void sliders_advance_1d(bool use_avx, int n, const Sliders1D *s, double displacement, double *force_end,
                        SliderResultant *sum);
/* Sum of the forces after a displacement at constant limits, and its tangent stiffness. */
double sliders_force_1d(int n, const Sliders1D *s, double displacement, double *tangent);
/* Derivative of the dissipated energy with respect to the displacement, at constant limits. */
double sliders_loss_derivative_1d(int n, const Sliders1D *s, double displacement);
/* Rates of force and dissipated energy, from rates of the displacement and of the limits at its end. */
void sliders_advance_1d_rate(int n, const Sliders1D *s, double displacement, double displacement_rate,
                             const double *limit_end_rate, SliderResultant *rate);

/* Functions in a plane */

/* Update for a displacement along x at constant limits, fast if most sliders stick. Returns the number of the first
 * slider (even) from which on the sliders are return-mapped; tangent and loss are the sums from it on, forces are of
 * all. */
int sliders_advance_along_x(int n, const Sliders2D *s, double *force_end, SliderResultant *sum);
/* Add the resultant of an even number of sliders, from their forces x, y and torsion directions e_x, e_y. */
static inline void add_resultant(int n, const double *x, const double *y, const double *e_x, const double *e_y,
                                 double force[3])
{
    double sum[3][2] = {{0.0}};
    for (int k = 0; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            sum[0][l] += x[k + l];
            sum[1][l] += y[k + l];
            sum[2][l] += x[k + l] * e_x[k + l] + y[k + l] * e_y[k + l];
        }
    for (int d = 0; d < 3; d++)
        force[d] += sum[d][0] + sum[d][1];
}

/* Elastic predictor of all sliders. Returns the number of the first slider at its limit, rounded down to an even number;
 * `force` is the resultant of those before it. `use_avx`: see `has_avx`. */
int sliders_predict(bool use_avx, int n, const Sliders2D *s, double *const force_end[2], double force[3]);

/* Rows of the results of return mappings in a plane: force x, y; tangent xx, xy, yy; dissipated energy; slip. */
enum { MAPPING_FORCE, MAPPING_LOSS = 5, MAPPING_SLIP, N_MAPPING };

/* Return-map the sliders from `first` up to `end`, a multiple of four. `forces_only`: only the rows of the force
 * change. */
void sliders_return_map(bool use_avx, int first, int end, const Sliders2D *s, double *const results[N_MAPPING],
                        bool forces_only);
/* Sum of results of `sliders_return_map`. */
void sliders_resultant(bool use_avx, int first, int end, const Sliders2D *s, double *const results[N_MAPPING],
                       SliderResultant *sum);

/* Rates of sliders along a further variable: of their limits at the end and of their displacements; and their
 * displacement over that around the centre. */
typedef struct {
    const double *torsion_directions[2], *limit_rate, *displacement_rate[2];
} SliderRates;
/* Derivatives of the resultant with respect to displacements along x, along y, around the centre, and to the further
 * variable; n is a multiple of four. */
void sliders_force_derivatives(bool use_avx, int n, const Sliders2D *s, const SliderRates *rates,
                               double derivatives[4][3]);

#endif
