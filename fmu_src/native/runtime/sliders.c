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

/* What sliders at their limits give. */
typedef struct {
    double x[MOST_SLIDERS], y[MOST_SLIDERS], xx[MOST_SLIDERS], xy[MOST_SLIDERS], yy[MOST_SLIDERS], loss[MOST_SLIDERS];
} Slipped;

/* Which they are, with another one after the last: a processor takes two at once. */
static inline int at_limit(int n, const double *reaches, int *at)
{
    int i = 0;
    for (int k = 0; k < n; k++) {
        at[i] = k;
        i += reaches[k] > 0.0;
    }
    at[i] = n - 1;
    return i;
}

static inline void slide_some(int n, const int *restrict at, const double *restrict K, const double *restrict per_K,
                              const double *restrict before, const double *restrict after, const double *restrict q_x,
                              const double *restrict q_y, double u, double v, Slipped *restrict to)
{
    const double shift[2] = {u, v};
    double e[3];
    direction(shift, NULL, e);
    const double e_x = e[0], e_y = e[1], way = e[2];
    for (int i = 0; i < n; i++) {
        const int k = at[i];
        const double a[] = {q_x[k], q_y[k], 1.0, K[k], u, v, e_x, e_y, way, before[k], after[k], K[k], per_K[k]};
        double b[N_PLANE];
        slide_plane(a, NULL, b);
        to->x[i] = b[P_FORCE];
        to->y[i] = b[P_FORCE + 1];
        to->xx[i] = b[P_TANGENT] - K[k];
        to->xy[i] = b[P_TANGENT + 1];
        to->yy[i] = b[P_TANGENT + 2] - K[k];
        to->loss[i] = b[P_LOSS];
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

void sliders_plane(int n, const Sliders *s, const double shift[2], double *const moved[2], SliderSum *sum)
{
    int at[MOST_SLIDERS + 1];
    double reaches[MOST_SLIDERS];
    Slipped to;
    Lanes lanes = {.x = {0.0}};
    stick_plane_all(n, s->K, s->after, s->force[0], s->force[1], shift[0], shift[1], moved[0], moved[1], reaches);
    const int slip = n > 0 ? at_limit(n, reaches, at) : 0;
    slide_some(slip + slip % 2, at, s->K, s->per_K, s->before, s->after, s->force[0], s->force[1], shift[0], shift[1], &to);
    for (int i = 0; i < slip; i++) {
        moved[0][at[i]] = to.x[i];
        moved[1][at[i]] = to.y[i];
    }
    for (int i = 0; i < slip; i++) {
        const int l = i % 2;
        lanes.xx[l] += to.xx[i];
        lanes.xy[l] += to.xy[i];
        lanes.yy[l] += to.yy[i];
        lanes.loss[l] += to.loss[i];
    }
    add_forces(n, moved[0], moved[1], &lanes);
    *sum = total(&lanes);
}
