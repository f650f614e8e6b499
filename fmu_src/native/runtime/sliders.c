#include "sliders.h"

#include <string.h>

/* The sums go in lanes, which a processor adds side by side. */
enum { LANES = 4 };

typedef struct {
    double x[LANES], y[LANES], xx[LANES], xy[LANES], yy[LANES], loss[LANES];
} Lanes;

static inline double sum_of(const double *lane)
{
    return (lane[0] + lane[2]) + (lane[1] + lane[3]);
}

static inline SliderSum total(const Lanes *s)
{
    return (SliderSum){.force = {sum_of(s->x), sum_of(s->y)},
                       .tangent = {sum_of(s->xx), sum_of(s->xy), sum_of(s->yy)},
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
        for (int l = 0; l < 2; l++)
            lanes.x[l] += moved[k + l];
    for (int k = first; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            lanes.xx[l] += each.reaches[k + l] > 0.0 ? 0.0 : s->K[k + l];
            lanes.yy[l] += s->K[k + l];
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

enum { P_FORCE, P_TANGENT = 2, P_LOSS = 5, N_PLANE = 7 }; /* results of slide_plane */

static inline void stick_plane_all(int n, const double *restrict K, const double *restrict limit,
                                   const double *restrict q_x, const double *restrict q_y, double u, double v,
                                   double *restrict x, double *restrict y, double *restrict reaches)
{
    for (int k = 0; k < n; k++) {
        const double a[] = {q_x[k], q_y[k], 1.0, K[k], u, v, limit[k]};
        double b[3];
        stick_plane(a, NULL, b);
        x[k] = b[0];
        y[k] = b[1];
        reaches[k] = b[2];
    }
}

/* Sliders at their limits, gathered side by side, and what they give. */
typedef struct {
    double K[MOST_SLIDERS], per_K[MOST_SLIDERS], before[MOST_SLIDERS], after[MOST_SLIDERS], x[MOST_SLIDERS],
        y[MOST_SLIDERS];
} Slipping;
typedef struct {
    double x[MOST_SLIDERS], y[MOST_SLIDERS], xx[MOST_SLIDERS], xy[MOST_SLIDERS], yy[MOST_SLIDERS], loss[MOST_SLIDERS];
} Slipped;

static inline int gather(int first, int n, const Sliders *s, const double *reaches, int *at, Slipping *some)
{
    int i = 0;
    for (int k = first; k < n; k++) {
        at[i] = k;
        some->K[i] = s->K[k];
        some->per_K[i] = s->per_K[k];
        some->before[i] = s->before[k];
        some->after[i] = s->after[k];
        some->x[i] = s->force[0][k];
        some->y[i] = s->force[1][k];
        i += reaches[k] > 0.0;
    }
    return i;
}

static inline void slide_some(int n, double u, double v, const Slipping *restrict s, Slipped *restrict to)
{
    const double shift[2] = {u, v};
    double e[3];
    direction(shift, NULL, e);
    const double e_x = e[0], e_y = e[1], way = e[2];
    for (int i = 0; i < n; i++) {
        const double x[] = {s->x[i], s->y[i],      1.0,         s->K[i], u,          v, e_x, e_y,
                            way,     s->before[i], s->after[i], s->K[i], s->per_K[i]};
        double y[N_PLANE];
        slide_plane(x, NULL, y);
        to->x[i] = y[P_FORCE];
        to->y[i] = y[P_FORCE + 1];
        to->xx[i] = y[P_TANGENT];
        to->xy[i] = y[P_TANGENT + 1];
        to->yy[i] = y[P_TANGENT + 2];
        to->loss[i] = y[P_LOSS];
    }
}

static inline void add_forces(int n, const double *x, const double *y, Lanes *lanes)
{
    int i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int l = 0; l < LANES; l++) {
            lanes->x[l] += x[i + l];
            lanes->y[l] += y[i + l];
        }
    for (; i < n; i++) {
        lanes->x[i % 2] += x[i];
        lanes->y[i % 2] += y[i];
    }
}

int sliders_plane(int n, const Sliders *s, const double shift[2], double *const moved[2], SliderSum *sum)
{
    int at[MOST_SLIDERS];
    double reaches[MOST_SLIDERS];
    Slipping some;
    Slipped to;
    Lanes lanes = {.x = {0.0}};
    stick_plane_all(n, s->K, s->after, s->force[0], s->force[1], shift[0], shift[1], moved[0], moved[1], reaches);
    const int first = first_at_limit(reaches, n), slip = gather(first, n, s, reaches, at, &some);
    slide_some(slip, shift[0], shift[1], &some, &to);
    for (int k = first; k < n; k++)
        lanes.xx[k % 2] += s->K[k];
    memcpy(lanes.yy, lanes.xx, sizeof lanes.yy);
    for (int i = 0; i < slip; i++) {
        const int l = i % 2;
        moved[0][at[i]] = to.x[i];
        moved[1][at[i]] = to.y[i];
        lanes.xx[l] += to.xx[i] - some.K[i];
        lanes.xy[l] += to.xy[i];
        lanes.yy[l] += to.yy[i] - some.K[i];
        lanes.loss[l] += to.loss[i];
    }
    add_forces(n, moved[0], moved[1], &lanes);
    *sum = total(&lanes);
    return first;
}
