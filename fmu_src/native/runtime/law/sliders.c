#include "sliders.h"

#include <string.h>

#include "vectors.h"

/* The sums go in lanes, which a processor adds side by side. */
enum { LANES = 4 };

typedef struct {
    double x[LANES], y[LANES], t[LANES];
    double xx[LANES], xy[LANES], yy[LANES], xt[LANES], yt[LANES], tt[LANES], loss[LANES];
} Lanes;

static inline double sum_of(const double *lane)
{
    return (lane[0] + lane[2]) + (lane[1] + lane[3]);
}

static inline SliderSum total(const Lanes *s)
{
    return (SliderSum){
        .force = {sum_of(s->x), sum_of(s->y), sum_of(s->t)},
        .tangent = {sum_of(s->xx), sum_of(s->xy), sum_of(s->yy), sum_of(s->xt), sum_of(s->yt), sum_of(s->tt)},
        .loss = sum_of(s->loss)};
}

/* The first pair of which one is at its limit or beyond. */
static inline int first_at_limit(const double *reaches, int n)
{
    int k = 0;
    while (k < n && !((reaches[k] > reaches[k + 1] ? reaches[k] : reaches[k + 1]) > 0.0))
        k += 2;
    return k;
}

/* Along one direction */

enum { L_FORCE, L_ALONG, L_ACROSS, L_LOSS, L_HEAT, N_LINE }; /* results of slide_line and slide_steady */

static inline void one_steady(const Sliders *s, int k, double shift, double *y)
{
    const double x[] = {s->force[k], s->after[k], s->K[k], s->per_K[k], shift};
    slide_steady(x, NULL, y);
}

static inline void one_line(const Sliders *s, int k, double shift, double *y)
{
    const double x[] = {s->force[k], s->before[k], s->K[k], s->per_K[k], shift, s->after[k]};
    slide_line(x, NULL, y);
}

static inline void add_line(int l, const double *y, double *restrict moved, Lanes *lanes)
{
    *moved = y[L_FORCE];
    lanes->x[l] += y[L_FORCE];
    lanes->xx[l] += y[L_ALONG];
    lanes->loss[l] += y[L_LOSS];
}

void sliders_line(int n, const Sliders *s, double shift, double *restrict moved, SliderSum *sum)
{
    const Sliders own = *s; /* which nothing that is written can change */
    double y[N_LINE];
    Lanes lanes = {.x = {0.0}};
    if (own.before == own.after)
        for (int i = 0; i < n; i += LANES)
            for (int l = 0; l < LANES; l++) {
                one_steady(&own, i + l, shift, y);
                add_line(l, y, moved + i + l, &lanes);
            }
    else
        for (int i = 0; i < n; i += LANES)
            for (int l = 0; l < LANES; l++) {
                one_line(&own, i + l, shift, y);
                add_line(l, y, moved + i + l, &lanes);
            }
    *sum = total(&lanes);
}

double sliders_force(int n, const Sliders *s, double shift, double *tangent)
{
    Lanes lanes = {.x = {0.0}};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            double y[N_LINE];
            one_steady(s, i + l, shift, y);
            lanes.x[l] += y[L_FORCE];
            lanes.xx[l] += y[L_ALONG];
        }
    *tangent = sum_of(lanes.xx);
    return sum_of(lanes.x);
}

double sliders_heat(int n, const Sliders *s, double shift)
{
    double heat[LANES] = {0.0};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            double y[N_LINE];
            one_steady(s, i + l, shift, y);
            heat[l] += y[L_HEAT];
        }
    return sum_of(heat);
}

void sliders_line_rate(int n, const Sliders *s, double shift, double shift_rate, const double *after_rate,
                       SliderSum *rate)
{
    Lanes lanes = {.x = {0.0}};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            const double x[] = {s->force[k], s->before[k], s->K[k],    s->per_K[k],
                                shift,          s->after[k],  shift_rate, after_rate[k]};
            double y[N_LINE];
            slide_line_seed(x, NULL, y);
            lanes.x[l] += y[L_FORCE];
            lanes.loss[l] += y[L_LOSS];
        }
    *rate = total(&lanes);
}

/* In a plane */

/* What sliders from the first at its limit on give. */
typedef struct {
    double reaches[MOST_SLIDERS], loss[MOST_SLIDERS];
} Each;

static inline void stick_all(int n, const PlaneSliders *s, double *restrict moved, double *restrict reaches)
{
    const PlaneSliders own = *s;
    for (int k = 0; k < n; k++) {
        const double x[] = {own.force[0][k], own.shift[0], limit_at(own.after[k], own.K[k], own.to), own.K[k]};
        double y[2];
        stick_line(x, NULL, y);
        moved[k] = y[0];
        reaches[k] = y[1];
    }
}

static inline void slide_all(int first, int n, const PlaneSliders *s, double *restrict moved, Each *restrict each)
{
    const PlaneSliders own = *s;
    for (int k = first; k < n; k++) {
        const double limit = limit_at(own.after[k], own.K[k], own.to);
        const double x[] = {own.force[0][k], limit, own.K[k], own.per_K[k], own.shift[0]};
        double y[N_LINE];
        slide_steady(x, NULL, y);
        moved[k] = y[L_FORCE];
        each->loss[k] = y[L_LOSS];
    }
}

int sliders_sticking(int n, const PlaneSliders *s, double *moved, SliderSum *sum)
{
    Each each;
    Lanes lanes = {.x = {0.0}};
    stick_all(n, s, moved, each.reaches);
    const int first = first_at_limit(each.reaches, n);
    slide_all(first, n, s, moved, &each);
    for (int k = 0; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            lanes.x[l] += moved[k + l];
            lanes.t[l] += moved[k + l] * s->turning[0][k + l];
        }
    for (int k = first; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            const double xx = each.reaches[k + l] > 0.0 ? 0.0 : s->K[k + l], yy = s->K[k + l];
            const double x_t = xx * s->turning[0][k + l], y_t = yy * s->turning[1][k + l];
            lanes.xx[l] += xx;
            lanes.yy[l] += yy;
            lanes.xt[l] += x_t;
            lanes.yt[l] += y_t;
            lanes.tt[l] += x_t * s->turning[0][k + l] + y_t * s->turning[1][k + l];
            lanes.loss[l] += each.loss[k + l];
        }
    *sum = total(&lanes);
    return first;
}

/* Four at a time, two pairs, as operations that follow one another take long; no row overlaps another. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wpass-failed" /* sanitizers do not let it */
#define ALL_FOUR _Pragma("clang loop vectorize(assume_safety) vectorize_width(4)")
#else
#define ALL_FOUR
#endif

WITHIN void stick_each(int n, const PlaneSliders *s, double *const moved[2], double *reaches)
{
    const PlaneSliders own = *s;
    double *const x = moved[0], *const y = moved[1];
    ALL_FOUR
    for (int k = 0; k < n; k++) {
        const double u = shift_of(own.turning, k, own.shift, 0), v = shift_of(own.turning, k, own.shift, 1);
        const double a[] = {own.force[0][k], own.force[1][k], own.keeps[k], own.carries[k], u, v,
                            limit_at(own.after[k], own.K[k], own.to)};
        double b[3];
        stick_plane(a, NULL, b);
        x[k] = b[0];
        y[k] = b[1];
        reaches[k] = b[2];
    }
}
COMPILED_TWICE(stick_each, (int n, const PlaneSliders *s, double *const moved[2], double *reaches),
               (n, s, moved, reaches))

int sliders_stick(bool fours, int n, const PlaneSliders *s, double *const moved[2], double force[3])
{
    double reaches[MOST_SLIDERS];
    (fours ? stick_each_fours : stick_each_any)(n, s, moved, reaches);
    const int first = first_at_limit(reaches, n);
    memset(force, 0, 3 * sizeof *force);
    add_forces(first, moved[0], moved[1], s->turning[0], s->turning[1], force);
    return first;
}

enum { N_SLIDER = 10 };

/* Arguments of `slide_plane` and `return_plane`. */
static inline void arguments(const PlaneSliders *s, int k, double *x)
{
    const double K = s->K[k];
    const double all[N_SLIDER] = {s->force[0][k], s->force[1][k], s->keeps[k], s->carries[k],
                                  shift_of(s->turning, k, s->shift, 0), shift_of(s->turning, k, s->shift, 1),
                                  limit_at(s->before[k], K, s->from), limit_at(s->after[k], K, s->to), K, s->per_K[k]};
    memcpy(x, all, sizeof all);
}

WITHIN void slide_each(int first, int end, const PlaneSliders *s, double *const *slid)
{
    const PlaneSliders own = *s;
    double *const all[N_SLID] = {slid[0], slid[1], slid[2], slid[3], slid[4], slid[5], slid[6]};
    for (int i = first; i < end; i += LANES) {
        ALL_FOUR
        for (int k = i; k < i + LANES; k++) {
            double x[N_SLIDER], y[N_SLID];
            arguments(&own, k, x);
            slide_plane(x, NULL, y);
            for (int r = 0; r < N_SLID; r++)
                all[r][k] = y[r];
        }
    }
}

WITHIN void return_each(int first, int end, const PlaneSliders *s, double *const *slid)
{
    const PlaneSliders own = *s;
    double *const all[2] = {slid[0], slid[1]};
    for (int i = first; i < end; i += LANES) {
        ALL_FOUR
        for (int k = i; k < i + LANES; k++) {
            double x[N_SLIDER], y[2];
            arguments(&own, k, x);
            return_plane(x, NULL, y);
            for (int r = 0; r < 2; r++)
                all[r][k] = y[r];
        }
    }
}

WITHIN void slide_or_return(int first, int end, const PlaneSliders *s, double *const *slid, bool forces)
{
    if (forces)
        return_each(first, end, s, slid);
    else
        slide_each(first, end, s, slid);
}
COMPILED_TWICE(slide_or_return, (int first, int end, const PlaneSliders *s, double *const *slid, bool forces),
               (first, end, s, slid, forces))

void sliders_slide(bool fours, int first, int end, const PlaneSliders *s, double *const slid[N_SLID], bool forces)
{
    (fours ? slide_or_return_fours : slide_or_return_any)(first, end, s, slid, forces);
}

enum { X_X, X_Y, X_LIMIT, Y_X, Y_Y, Y_LIMIT, N_SLOPES }; /* results of `return_slopes` */

/* Sums in lanes of the slopes of sliders, see `sliders_slopes`. */
WITHIN void slope_each(int n, const PlaneSliders *s, const SliderRates *rates, double (*restrict sum)[3][LANES])
{
    const PlaneSliders own = *s;
    for (int i = 0; i < n; i += LANES) {
        ALL_FOUR
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            double x[N_SLIDER], y[N_SLOPES];
            arguments(&own, k, x);
            return_slopes(x, NULL, y);
            const double e_x = rates->turning[0][k], e_y = rates->turning[1][k];
            const double limit = rates->limit[k], u = rates->shift[0][k], v = rates->shift[1][k];
            const double columns[4][2] = {{y[X_X], y[Y_X]},
                                          {y[X_Y], y[Y_Y]},
                                          {y[X_X] * e_x + y[X_Y] * e_y, y[Y_X] * e_x + y[Y_Y] * e_y},
                                          {y[X_LIMIT] * limit + y[X_X] * u + y[X_Y] * v,
                                           y[Y_LIMIT] * limit + y[Y_X] * u + y[Y_Y] * v}};
            for (int d = 0; d < 4; d++) {
                sum[d][0][l] += columns[d][0];
                sum[d][1][l] += columns[d][1];
                sum[d][2][l] += columns[d][0] * e_x + columns[d][1] * e_y;
            }
        }
    }
}
COMPILED_TWICE(slope_each, (int n, const PlaneSliders *s, const SliderRates *rates, double (*sum)[3][LANES]),
               (n, s, rates, sum))

void sliders_slopes(bool fours, int n, const PlaneSliders *s, const SliderRates *rates, double slope[4][3])
{
    double sum[4][3][LANES] = {{{0.0}}};
    (fours ? slope_each_fours : slope_each_any)(n, s, rates, sum);
    for (int d = 0; d < 4; d++)
        for (int t = 0; t < 3; t++)
            slope[d][t] = sum_of(sum[d][t]);
}

WITHIN void sum_each(int first, int end, const PlaneSliders *s, double *const *slid, Lanes *restrict lanes)
{
    const double *const all[] = {slid[0], slid[1], slid[2], slid[3], slid[4], slid[5]};
    const double *const e_x = s->turning[0], *const e_y = s->turning[1];
    for (int i = first; i < end; i += LANES) {
        ALL_FOUR
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            const double x = all[0][k], y = all[1][k], xx = all[2][k], xy = all[3][k], yy = all[4][k];
            const double x_t = xx * e_x[k] + xy * e_y[k], y_t = xy * e_x[k] + yy * e_y[k];
            lanes->x[l] += x;
            lanes->y[l] += y;
            lanes->t[l] += x * e_x[k] + y * e_y[k];
            lanes->xx[l] += xx;
            lanes->xy[l] += xy;
            lanes->yy[l] += yy;
            lanes->xt[l] += x_t;
            lanes->yt[l] += y_t;
            lanes->tt[l] += x_t * e_x[k] + y_t * e_y[k];
            lanes->loss[l] += all[SLID_LOSS][k];
        }
    }
}
COMPILED_TWICE(sum_each, (int first, int end, const PlaneSliders *s, double *const *slid, Lanes *lanes),
               (first, end, s, slid, lanes))

void sliders_sum(bool fours, int first, int end, const PlaneSliders *s, double *const slid[N_SLID], SliderSum *sum)
{
    Lanes lanes = {.x = {0.0}};
    (fours ? sum_each_fours : sum_each_any)(first, end, s, slid, &lanes);
    *sum = total(&lanes);
}
