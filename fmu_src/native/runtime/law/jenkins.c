#include "jenkins.h"

#include <string.h>

#include "simd.h"

/* Sums are split into lanes, which a processor adds in parallel. */
enum { LANES = 4 };

typedef struct {
    double x[LANES], y[LANES], t[LANES];
    double xx[LANES], xy[LANES], yy[LANES], xr[LANES], yr[LANES], rr[LANES], loss[LANES];
} Lanes;

static inline double lane_sum(const double *lane)
{
    return (lane[0] + lane[2]) + (lane[1] + lane[3]);
}

static inline SliderResultant sum_lanes(const Lanes *s)
{
    return (SliderResultant){.force = {lane_sum(s->x), lane_sum(s->y), lane_sum(s->t)},
                             .tangent = {lane_sum(s->xx), lane_sum(s->xy), lane_sum(s->yy), lane_sum(s->xr),
                                         lane_sum(s->yr), lane_sum(s->rr)},
                             .loss = lane_sum(s->loss)};
}

/* First pair of sliders of which one is at its limit or above. */
static inline int first_at_limit(const double *limit_excess, int n)
{
    int k = 0;
    while (k < n && !((limit_excess[k] > limit_excess[k + 1] ? limit_excess[k] : limit_excess[k + 1]) > 0.0))
        k += 2;
    return k;
}

/* Vectorise by four: two pairs of sliders hide the latency of dependent operations. No row overlaps another. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wpass-failed" /* sanitizers prevent vectorization */
#define VECTORIZE_4 _Pragma("clang loop unroll(disable) vectorize(assume_safety) vectorize_width(4)")
#else
#define VECTORIZE_4
#endif

/* Along one direction */

enum {
    MAPPING_1D_FORCE,
    MAPPING_1D_ALONG,
    MAPPING_1D_ACROSS,
    MAPPING_1D_LOSS,
    MAPPING_1D_LOSS_DERIVATIVE,
    N_MAPPING_1D
}; /* results of `return_map_1d` and `return_map_1d_constant_limit` */

static inline void return_map_one_constant_limit(const Sliders1D *s, int k, double displacement, double *y)
{
    const double x[] = {s->force[k], s->limit_end[k], s->K[k], s->compliance[k], displacement};
    return_map_1d_constant_limit(x, NULL, y);
}

static inline void return_map_one(const Sliders1D *s, int k, double displacement, double *y)
{
    const double x[] = {s->force[k], s->limit_start[k], s->K[k], s->compliance[k], displacement, s->limit_end[k]};
    return_map_1d(x, NULL, y);
}

static inline void add_one(int l, const double *y, double *restrict force_end, Lanes *lanes)
{
    *force_end = y[MAPPING_1D_FORCE];
    lanes->x[l] += y[MAPPING_1D_FORCE];
    lanes->xx[l] += y[MAPPING_1D_ALONG];
    lanes->loss[l] += y[MAPPING_1D_LOSS];
}

ALWAYS_INLINE void advance_each_1d(int n, const Sliders1D *s, double displacement, double *restrict force_end,
                                   SliderResultant *sum)
{
    const Sliders1D own = *s; /* a copy, which no write to the results can alias */
    const bool has_constant_limits = own.limit_start == own.limit_end;
    Lanes lanes = {.x = {0.0}};
    for (int i = 0; i < n; i += LANES)
        if (has_constant_limits) {
            VECTORIZE_4
            for (int l = 0; l < LANES; l++) {
                double y[N_MAPPING_1D];
                return_map_one_constant_limit(&own, i + l, displacement, y);
                add_one(l, y, force_end + i + l, &lanes);
            }
        } else {
            VECTORIZE_4
            for (int l = 0; l < LANES; l++) {
                double y[N_MAPPING_1D];
                return_map_one(&own, i + l, displacement, y);
                add_one(l, y, force_end + i + l, &lanes);
            }
        }
    *sum = sum_lanes(&lanes);
}
DEFINE_BASELINE_AND_AVX(advance_each_1d,
                        (int n, const Sliders1D *s, double displacement, double *restrict force_end,
                         SliderResultant *sum),
                        (n, s, displacement, force_end, sum))

void sliders_advance_1d(bool use_avx, int n, const Sliders1D *s, double displacement, double *force_end,
                        SliderResultant *sum)
{
    (use_avx ? advance_each_1d_avx : advance_each_1d_baseline)(n, s, displacement, force_end, sum);
}

double sliders_force_1d(int n, const Sliders1D *s, double displacement, double *tangent)
{
    Lanes lanes = {.x = {0.0}};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            double y[N_MAPPING_1D];
            return_map_one_constant_limit(s, i + l, displacement, y);
            lanes.x[l] += y[MAPPING_1D_FORCE];
            lanes.xx[l] += y[MAPPING_1D_ALONG];
        }
    *tangent = lane_sum(lanes.xx);
    return lane_sum(lanes.x);
}

double sliders_loss_derivative_1d(int n, const Sliders1D *s, double displacement)
{
    double loss_derivative[LANES] = {0.0};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            double y[N_MAPPING_1D];
            return_map_one_constant_limit(s, i + l, displacement, y);
            loss_derivative[l] += y[MAPPING_1D_LOSS_DERIVATIVE];
        }
    return lane_sum(loss_derivative);
}

void sliders_advance_1d_rate(int n, const Sliders1D *s, double displacement, double displacement_rate,
                             const double *limit_end_rate, SliderResultant *rate)
{
    Lanes lanes = {.x = {0.0}};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            const double x[] = {s->force[k],  s->limit_start[k], s->K[k],           s->compliance[k],
                                displacement, s->limit_end[k],   displacement_rate, limit_end_rate[k]};
            double y[N_MAPPING_1D];
            return_map_1d_seed(x, NULL, y);
            lanes.x[l] += y[MAPPING_1D_FORCE];
            lanes.loss[l] += y[MAPPING_1D_LOSS];
        }
    *rate = sum_lanes(&lanes);
}

/* In a plane */

/* Results of the sliders from the first one at its limit on. */
typedef struct {
    double limit_excess[MAX_SLIDERS], loss[MAX_SLIDERS];
} AlongXResults;

/* Elastic predictor of all sliders, for a displacement along x. */
static inline void predict_all(int n, const Sliders2D *s, double *restrict force_end, double *restrict limit_excess)
{
    const Sliders2D own = *s;
    for (int k = 0; k < n; k++) {
        const double x[] = {own.force[0][k], own.displacement[0],
                            limit_at_growth(own.limit_end[k], own.K[k], own.growth_end), own.K[k]};
        double y[2];
        elastic_predictor_1d(x, NULL, y);
        force_end[k] = y[0];
        limit_excess[k] = y[1];
    }
}

/* Return-map the sliders from `first` on, for a displacement along x. */
static inline void return_map_from(int first, int n, const Sliders2D *s, double *restrict force_end,
                                   AlongXResults *restrict results)
{
    const Sliders2D own = *s;
    for (int k = first; k < n; k++) {
        const double limit = limit_at_growth(own.limit_end[k], own.K[k], own.growth_end);
        const double x[] = {own.force[0][k], limit, own.K[k], own.compliance[k], own.displacement[0]};
        double y[N_MAPPING_1D];
        return_map_1d_constant_limit(x, NULL, y);
        force_end[k] = y[MAPPING_1D_FORCE];
        results->loss[k] = y[MAPPING_1D_LOSS];
    }
}

int sliders_advance_along_x(int n, const Sliders2D *s, double *force_end, SliderResultant *sum)
{
    AlongXResults results;
    Lanes lanes = {.x = {0.0}};
    predict_all(n, s, force_end, results.limit_excess);
    const int first = first_at_limit(results.limit_excess, n);
    return_map_from(first, n, s, force_end, &results);
    for (int k = 0; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            lanes.x[l] += force_end[k + l];
            lanes.t[l] += force_end[k + l] * s->torsion_directions[0][k + l];
        }
    for (int k = first; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            const double xx = results.limit_excess[k + l] > 0.0 ? 0.0 : s->K[k + l], yy = s->K[k + l];
            const double x_r = xx * s->torsion_directions[0][k + l], y_r = yy * s->torsion_directions[1][k + l];
            lanes.xx[l] += xx;
            lanes.yy[l] += yy;
            lanes.xr[l] += x_r;
            lanes.yr[l] += y_r;
            lanes.rr[l] += x_r * s->torsion_directions[0][k + l] + y_r * s->torsion_directions[1][k + l];
            lanes.loss[l] += results.loss[k + l];
        }
    *sum = sum_lanes(&lanes);
    return first;
}

ALWAYS_INLINE void predict_each(int n, const Sliders2D *s, double *const force_end[2], double *limit_excess)
{
    const Sliders2D own = *s;
    double *const x = force_end[0], *const y = force_end[1];
    VECTORIZE_4
    for (int k = 0; k < n; k++) {
        const double u = slider_displacement(own.torsion_directions, k, own.displacement, 0),
                     v = slider_displacement(own.torsion_directions, k, own.displacement, 1);
        const double a[] = {own.force[0][k],
                            own.force[1][k],
                            own.retention[k],
                            own.secant_stiffness[k],
                            u,
                            v,
                            limit_at_growth(own.limit_end[k], own.K[k], own.growth_end)};
        double b[3];
        elastic_predictor_2d(a, NULL, b);
        x[k] = b[0];
        y[k] = b[1];
        limit_excess[k] = b[2];
    }
}
DEFINE_BASELINE_AND_AVX(predict_each, (int n, const Sliders2D *s, double *const force_end[2], double *limit_excess),
                        (n, s, force_end, limit_excess))

int sliders_predict(bool use_avx, int n, const Sliders2D *s, double *const force_end[2], double force[3])
{
    double limit_excess[MAX_SLIDERS];
    (use_avx ? predict_each_avx : predict_each_baseline)(n, s, force_end, limit_excess);
    const int first = first_at_limit(limit_excess, n);
    memset(force, 0, 3 * sizeof *force);
    add_resultant(first, force_end[0], force_end[1], s->torsion_directions[0], s->torsion_directions[1], force);
    return first;
}

enum { N_RETURN_MAP_ARGUMENTS = 10 };

/* Arguments of `return_map_2d` and `return_map_2d_force`. */
static inline void return_map_arguments(const Sliders2D *s, int k, double *x)
{
    const double K = s->K[k];
    const double all[N_RETURN_MAP_ARGUMENTS] = {s->force[0][k],
                                                s->force[1][k],
                                                s->retention[k],
                                                s->secant_stiffness[k],
                                                slider_displacement(s->torsion_directions, k, s->displacement, 0),
                                                slider_displacement(s->torsion_directions, k, s->displacement, 1),
                                                limit_at_growth(s->limit_start[k], K, s->growth_start),
                                                limit_at_growth(s->limit_end[k], K, s->growth_end),
                                                K,
                                                s->compliance[k]};
    memcpy(x, all, sizeof all);
}

ALWAYS_INLINE void return_map_each(int first, int end, const Sliders2D *s, double *const *results)
{
    const Sliders2D own = *s;
    double *const all[N_MAPPING] = {results[0], results[1], results[2], results[3], results[4], results[5], results[6]};
    for (int i = first; i < end; i += LANES) {
        VECTORIZE_4
        for (int k = i; k < i + LANES; k++) {
            double x[N_RETURN_MAP_ARGUMENTS], y[N_MAPPING];
            return_map_arguments(&own, k, x);
            return_map_2d(x, NULL, y);
            for (int r = 0; r < N_MAPPING; r++)
                all[r][k] = y[r];
        }
    }
}

ALWAYS_INLINE void return_map_force_each(int first, int end, const Sliders2D *s, double *const *results)
{
    const Sliders2D own = *s;
    double *const all[2] = {results[0], results[1]};
    for (int i = first; i < end; i += LANES) {
        VECTORIZE_4
        for (int k = i; k < i + LANES; k++) {
            double x[N_RETURN_MAP_ARGUMENTS], y[2];
            return_map_arguments(&own, k, x);
            return_map_2d_force(x, NULL, y);
            for (int r = 0; r < 2; r++)
                all[r][k] = y[r];
        }
    }
}

ALWAYS_INLINE void return_map_or_force(int first, int end, const Sliders2D *s, double *const *results, bool forces_only)
{
    if (forces_only)
        return_map_force_each(first, end, s, results);
    else
        return_map_each(first, end, s, results);
}
DEFINE_BASELINE_AND_AVX(return_map_or_force,
                        (int first, int end, const Sliders2D *s, double *const *results, bool forces_only),
                        (first, end, s, results, forces_only))

void sliders_return_map(bool use_avx, int first, int end, const Sliders2D *s, double *const results[N_MAPPING],
                        bool forces_only)
{
    (use_avx ? return_map_or_force_avx : return_map_or_force_baseline)(first, end, s, results, forces_only);
}

enum {
    DX_DX,
    DX_DY,
    DX_DLIMIT,
    DY_DX,
    DY_DY,
    DY_DLIMIT,
    N_FORCE_DERIVATIVES
}; /* results of `return_map_2d_derivatives` */

/* Derivatives as lanes, see `sliders_force_derivatives`. */
ALWAYS_INLINE void derivative_each(int n, const Sliders2D *s, const SliderRates *rates,
                                   double (*restrict sum)[3][LANES])
{
    const Sliders2D own = *s;
    for (int i = 0; i < n; i += LANES) {
        VECTORIZE_4
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            double x[N_RETURN_MAP_ARGUMENTS], y[N_FORCE_DERIVATIVES];
            return_map_arguments(&own, k, x);
            return_map_2d_derivatives(x, NULL, y);
            const double e_x = rates->torsion_directions[0][k], e_y = rates->torsion_directions[1][k];
            const double limit = rates->limit_rate[k], u = rates->displacement_rate[0][k],
                         v = rates->displacement_rate[1][k];
            const double columns[4][2] = {{y[DX_DX], y[DY_DX]},
                                          {y[DX_DY], y[DY_DY]},
                                          {y[DX_DX] * e_x + y[DX_DY] * e_y, y[DY_DX] * e_x + y[DY_DY] * e_y},
                                          {y[DX_DLIMIT] * limit + y[DX_DX] * u + y[DX_DY] * v,
                                           y[DY_DLIMIT] * limit + y[DY_DX] * u + y[DY_DY] * v}};
            for (int d = 0; d < 4; d++) {
                sum[d][0][l] += columns[d][0];
                sum[d][1][l] += columns[d][1];
                sum[d][2][l] += columns[d][0] * e_x + columns[d][1] * e_y;
            }
        }
    }
}
DEFINE_BASELINE_AND_AVX(derivative_each, (int n, const Sliders2D *s, const SliderRates *rates, double (*sum)[3][LANES]),
                        (n, s, rates, sum))

void sliders_force_derivatives(bool use_avx, int n, const Sliders2D *s, const SliderRates *rates,
                               double derivatives[4][3])
{
    double sum[4][3][LANES] = {{{0.0}}};
    (use_avx ? derivative_each_avx : derivative_each_baseline)(n, s, rates, sum);
    for (int d = 0; d < 4; d++)
        for (int t = 0; t < 3; t++)
            derivatives[d][t] = lane_sum(sum[d][t]);
}

ALWAYS_INLINE void sum_each(int first, int end, const Sliders2D *s, double *const *results, Lanes *restrict lanes)
{
    const double *const all[] = {results[0], results[1], results[2], results[3], results[4], results[5]};
    const double *const e_x = s->torsion_directions[0], *const e_y = s->torsion_directions[1];
    for (int i = first; i < end; i += LANES) {
        VECTORIZE_4
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            const double x = all[0][k], y = all[1][k], xx = all[2][k], xy = all[3][k], yy = all[4][k];
            const double x_r = xx * e_x[k] + xy * e_y[k], y_r = xy * e_x[k] + yy * e_y[k];
            lanes->x[l] += x;
            lanes->y[l] += y;
            lanes->t[l] += x * e_x[k] + y * e_y[k];
            lanes->xx[l] += xx;
            lanes->xy[l] += xy;
            lanes->yy[l] += yy;
            lanes->xr[l] += x_r;
            lanes->yr[l] += y_r;
            lanes->rr[l] += x_r * e_x[k] + y_r * e_y[k];
            lanes->loss[l] += all[MAPPING_LOSS][k];
        }
    }
}
DEFINE_BASELINE_AND_AVX(sum_each, (int first, int end, const Sliders2D *s, double *const *results, Lanes *lanes),
                        (first, end, s, results, lanes))

void sliders_resultant(bool use_avx, int first, int end, const Sliders2D *s, double *const results[N_MAPPING],
                       SliderResultant *sum)
{
    Lanes lanes = {.x = {0.0}};
    (use_avx ? sum_each_avx : sum_each_baseline)(first, end, s, results, &lanes);
    *sum = sum_lanes(&lanes);
}
