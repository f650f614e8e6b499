#include "sliders.h"

#include <string.h>

#include "vectors.h"

/* The sums go in lanes, which a processor adds side by side. */
enum { LANES = 4 };

typedef struct {
    double x[LANES], t[LANES], xx[LANES], yy[LANES], xt[LANES], yt[LANES], tt[LANES], loss[LANES];
} Lanes;

static inline double sum_of(const double *lane)
{
    return (lane[0] + lane[2]) + (lane[1] + lane[3]);
}

static inline SliderSum total(const Lanes *s)
{
    return (SliderSum){
        .force = {sum_of(s->x), 0.0, sum_of(s->t)},
        .tangent = {sum_of(s->xx), 0.0, sum_of(s->yy), sum_of(s->xt), sum_of(s->yt), sum_of(s->tt)},
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
    const double x[] = {s->force[0][k], s->after[k], s->K[k], s->per_K[k], shift};
    slide_steady(x, NULL, y);
}

static inline void one_line(const Sliders *s, int k, double shift, double *y)
{
    const double x[] = {s->force[0][k], s->before[k], s->K[k], s->per_K[k], shift, s->after[k]};
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

/* What sliders from the first at its limit on give. */
typedef struct {
    double reaches[MOST_SLIDERS], loss[MOST_SLIDERS];
} Each;

static inline void stick_all(int n, const double *restrict K, const double *restrict limit,
                             const double *restrict force, double shift, double *restrict moved,
                             double *restrict reaches)
{
    for (int k = 0; k < n; k++) {
        const double x[] = {force[k], shift, limit[k], K[k]};
        double y[2];
        stick_line(x, NULL, y);
        moved[k] = y[0];
        reaches[k] = y[1];
    }
}

static inline void slide_all(int first, int n, const double *restrict K, const double *restrict per_K,
                             const double *restrict limit, const double *restrict force, double shift,
                             double *restrict moved, Each *restrict each)
{
    for (int k = first; k < n; k++) {
        const double x[] = {force[k], limit[k], K[k], per_K[k], shift};
        double y[N_LINE];
        slide_steady(x, NULL, y);
        moved[k] = y[L_FORCE];
        each->loss[k] = y[L_LOSS];
    }
}

int sliders_sticking(int n, const Sliders *s, double shift, double *moved, SliderSum *sum)
{
    Each each;
    Lanes lanes = {.x = {0.0}};
    stick_all(n, s->K, s->after, s->force[0], shift, moved, each.reaches);
    const int first = first_at_limit(each.reaches, n);
    slide_all(first, n, s->K, s->per_K, s->after, s->force[0], shift, moved, &each);
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

void sliders_line_rate(int n, const Sliders *s, double shift, double shift_rate, const double *after_rate,
                       SliderSum *rate)
{
    Lanes lanes = {.x = {0.0}};
    for (int i = 0; i < n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            const int k = i + l;
            const double x[] = {s->force[0][k], s->before[k], s->K[k],    s->per_K[k],
                                shift,          s->after[k],  shift_rate, after_rate[k]};
            double y[N_LINE];
            slide_line_seed(x, NULL, y);
            lanes.x[l] += y[L_FORCE];
            lanes.loss[l] += y[L_LOSS];
        }
    *rate = total(&lanes);
}

/* In a plane */

WITHIN void stick_each(int n, const double *restrict K, const double *restrict limit, const double *restrict q_x,
                       const double *restrict q_y, const double *restrict e_x, const double *restrict e_y,
                       const double *restrict shift, double *restrict x, double *restrict y, double *restrict reaches)
{
    const double u = shift[0], v = shift[1], w = shift[2];
    for (int k = 0; k < n; k++) {
        const double a[] = {q_x[k], q_y[k], 1.0, K[k], u + w * e_x[k], v + w * e_y[k], limit[k]};
        double b[3];
        stick_plane(a, NULL, b);
        x[k] = b[0];
        y[k] = b[1];
        reaches[k] = b[2];
    }
}
COMPILED_TWICE(stick_each,
               (int n, const double *K, const double *limit, const double *q_x, const double *q_y, const double *e_x,
                const double *e_y, const double *shift, double *x, double *y, double *reaches),
               (n, K, limit, q_x, q_y, e_x, e_y, shift, x, y, reaches))

int sliders_stick(bool fours, int n, const Sliders *s, const double shift[3], double *const moved[2], double force[3])
{
    double reaches[MOST_SLIDERS], x[2] = {0.0}, y[2] = {0.0}, t[2] = {0.0};
    const double *e_x = s->turning[0], *e_y = s->turning[1];
    (fours ? stick_each_fours : stick_each_any)(n, s->K, s->after, s->force[0], s->force[1], e_x, e_y, shift, moved[0],
                                                moved[1], reaches);
    const int first = first_at_limit(reaches, n);
    for (int k = 0; k < first; k += 2)
        for (int l = 0; l < 2; l++) {
            x[l] += moved[0][k + l];
            y[l] += moved[1][k + l];
            t[l] += moved[0][k + l] * e_x[k + l] + moved[1][k + l] * e_y[k + l];
        }
    force[0] = x[0] + x[1];
    force[1] = y[0] + y[1];
    force[2] = t[0] + t[1];
    return first;
}

/* Four at a time, two pairs, as operations that follow one another take long. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wpass-failed" /* sanitizers do not let it */
#define ALL_FOUR _Pragma("clang loop vectorize_width(4)")
#else
#define ALL_FOUR
#endif

WITHIN void slide_each(int n, const double (*restrict given)[ABREAST], double (*restrict found)[ABREAST])
{
    for (int i = 0; i < n; i += LANES) {
        ALL_FOUR
        for (int k = i; k < i + LANES; k++) {
            double x[N_SLIDER], y[N_SLID];
            for (int r = 0; r < N_SLIDER; r++)
                x[r] = given[r][k];
            slide_plane(x, NULL, y);
            for (int r = 0; r < N_SLID; r++)
                found[r][k] = y[r];
        }
    }
}

WITHIN void return_each(int n, const double (*restrict given)[ABREAST], double (*restrict found)[ABREAST])
{
    for (int i = 0; i < n; i += LANES) {
        ALL_FOUR
        for (int k = i; k < i + LANES; k++) {
            double x[N_SLIDER], y[2];
            for (int r = 0; r < N_SLIDER; r++)
                x[r] = given[r][k];
            return_plane(x, NULL, y);
            for (int r = 0; r < 2; r++)
                found[r][k] = y[r];
        }
    }
}

WITHIN void slide_or_return(int n, Abreast *abreast, bool forces)
{
    const double(*given)[ABREAST] = (const double(*)[ABREAST])abreast->given;
    if (forces)
        return_each(n, given, abreast->found);
    else
        slide_each(n, given, abreast->found);
}
COMPILED_TWICE(slide_or_return, (int n, Abreast *abreast, bool forces), (n, abreast, forces))

void sliders_slide(Abreast *abreast, bool forces)
{
    int n = abreast->n;
    for (; n % LANES != 0; n++) /* none has hardly any limit */
        for (int r = 0; r < N_SLIDER; r++)
            abreast->given[r][n] = 0.0;
    (abreast->fours ? slide_or_return_fours : slide_or_return_any)(n, abreast, forces);
}
