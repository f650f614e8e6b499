#include "friction.h"

/* What each slider of a range has at a point, the early and the late one, and derivatives in the approach. */
typedef struct {
    double K, slope, limit[2], change[2];
} Pair;

static double inverse(const Foundation *f, double load)
{
    int segment = 0;
    double carried;
    return curve_inverse(f->curve, load, &segment, &carried);
}

/* As `around` of the package. */
static void lay_heights(Foundation *f, double reference)
{
    const double end = f->curve->end.y;
    double y[2], *h = f->height;
    curve_at(f->curve, reference, 0, y);
    const bool touches = y[0] > SLIDER_LOWEST * end, given = touches && y[0] < SLIDER_HIGHEST * end;
    const double load = touches ? fmin(y[0], SLIDER_HIGHEST * end) : SLIDER_USUAL * end, over = same_log(end / load);
    *h++ = f->curve->first.x;
    for (int k = N_BELOW - 1; k >= 0; k--) {
        const double part = (k + f->offset) / (double)N_BELOW, rest = (1.0 - part) * (1.0 - part);
        *h++ = inverse(f, load * rest / (part * part + rest));
    }
    *h++ = given ? reference : inverse(f, load);
    for (int k = 0; k < N_ABOVE; k++) {
        const double part = (k + f->offset) / (double)N_ABOVE;
        *h++ = inverse(f, load * same_exp(over * (part * part)));
    }
    *h = f->curve->end.x;
}

void foundation_lay(Foundation *f, double reference)
{
    double y[2];
    f->reference = reference;
    lay_heights(f, reference);
    for (int i = 0; i < N_HEIGHTS; i++) {
        curve_at(f->curve, f->height[i], 1, y);
        f->load[i] = y[0];
        f->stiffness[i] = y[1];
    }
    for (int i = 0; i < HEIGHTS; i++) {
        const double width = f->height[i + 1] - f->height[i];
        f->springs[i] = fmax(f->stiffness[i + 1] - f->stiffness[i], 0.0);
        f->normal[i] = f->load[i + 1] - f->load[i] - f->stiffness[i] * width;
        f->apart[i] = fmin(f->springs[i] * (SLIDER_SPREAD * width), f->normal[i]);
        f->stick[i] = f->ratio * f->springs[i] + (i > 0 ? f->stick[i - 1] : 0.0);
        for (int late = 0; late < 2; late++) {
            const int k = 2 * i + late;
            const double first = f->normal[i] + (late ? f->apart[i] : -f->apart[i]);
            f->K[k] = 0.5 * f->ratio * f->springs[i];
            f->per_K[k] = f->K[k] > 0.0 ? 1.0 / f->K[k] : 0.0;
            f->limit[k] = 0.5 * f->mu * (first - f->springs[i] * f->height[i + 1]);
        }
    }
}

/* Place, load with two derivatives and energy where the curve goes on as its tangent, or before it begins. */
static void point_beyond(const Curve *curve, const Energy *energy, Point *p)
{
    const bool after = p->approach >= curve->end.x;
    const double beyond = p->approach - (after ? curve->end.x : curve->first.x);
    curve_at(curve, p->approach, 2, p->y);
    p->energy = energy->at[after ? curve->n - 1 : 0] + beyond * (p->y[0] - 0.5 * beyond * p->y[1]);
}

Point foundation_point(const Foundation *f, double approach, int near)
{
    const Curve *curve = f->curve;
    const Energy *energy = f->energy;
    Point p = {.approach = approach, .full = near};
    if (approach >= curve->first.x && approach < curve->end.x) {
        const int segment = curve_segment(curve, approach);
        const double t = (approach - curve->x[segment]) * curve->per[segment];
        curve_derivatives(curve, segment, t, 2, p.y);
        p.energy = energy_inside(energy, curve, segment, t);
    } else {
        point_beyond(curve, energy, &p);
    }
    while (p.full > 0 && approach < f->height[p.full])
        p.full--;
    while (p.full < HEIGHTS && approach >= f->height[p.full + 1])
        p.full++;
    p.touched = p.full + (p.full < HEIGHTS && approach > f->height[p.full]);
    return p;
}

/* Those of a range at a point, see `Foundation.carried`. */
static inline Pair pair_at(const Foundation *f, int i, const Point *p)
{
    const double half = 0.5 * f->mu;
    if (p->approach < f->height[i])
        return (Pair){.K = 0.0};
    if (i < p->full) {
        const double *limit = f->limit + 2 * i, grows = half * f->springs[i];
        return (Pair){.K = f->K[2 * i],
                      .limit = {limit[0] + grows * p->approach, limit[1] + grows * p->approach},
                      .change = {grows, grows}};
    }
    const double width = p->approach - f->height[i], springs = fmax(p->y[1] - f->stiffness[i], 0.0);
    const double normal = fmax(p->y[0] - f->load[i] - f->stiffness[i] * width, 0.0), spread = SLIDER_SPREAD * width;
    const bool narrow = springs * spread < normal;
    const double apart = narrow ? springs * spread : normal;
    const double parts = narrow ? p->y[2] * spread + springs * SLIDER_SPREAD : springs;
    return (Pair){.K = 0.5 * f->ratio * springs,
                  .slope = 0.5 * f->ratio * p->y[2],
                  .limit = {half * (normal - apart), half * (normal + apart)},
                  .change = {half * (springs - parts), half * (springs + parts)}};
}

/* Whether all, some or none of the springs of a range touch at both points alike. */
static bool stays(int i, const Point *from, const Point *to)
{
    return (i < from->touched) == (i < to->touched) && (i < from->full) == (i < to->full);
}

/* What the sliders of a range keep of their forces on a way, what they gain by the shift, and both by the
 * approaches at its ends. */
typedef struct {
    double keeps, carries, keeps_by[2], carries_by[2];
} Gain;

static Gain gain_on(const Foundation *f, int i, const Point *from, const Point *to, const Pair *start, const Pair *end)
{
    const double change = to->approach - from->approach;
    if (change < 0.0) {
        const bool loses = start->K > 0.0 && end->K < start->K;
        const double keeps = loses ? end->K / start->K : (start->K > 0.0 ? 1.0 : 0.0);
        return (Gain){.keeps = keeps,
                      .carries = end->K,
                      .keeps_by = {loses ? -keeps * start->slope / start->K : 0.0, loses ? end->slope / start->K : 0.0},
                      .carries_by = {0.0, end->slope}};
    }
    const double width = f->height[i + 1] - f->height[i];
    if (start->K == end->K || change == 0.0 || (stays(i, from, to) && change < SLIDER_SMALL * width)) {
        const double ends = 0.5 * (start->K + end->K) + change * (start->slope - end->slope) / 12.0;
        return (Gain){.keeps = 1.0,
                      .carries = start->K == end->K ? end->K : ends,
                      .carries_by = {start->slope / 3.0 + end->slope / 6.0, start->slope / 6.0 + end->slope / 3.0}};
    }
    const double rise = end->limit[0] + end->limit[1] - start->limit[0] - start->limit[1];
    const double mean = 0.5 * f->ratio * rise / (f->mu * change);
    return (Gain){.keeps = 1.0, .carries = mean, .carries_by = {(mean - start->K) / change, (end->K - mean) / change}};
}

static double square_of(const double v[2])
{
    return v[0] * v[0] + v[1] * v[1];
}

static double elastic(const double q[2], double K)
{
    return K > 0.0 ? square_of(q) / (2.0 * K) : 0.0;
}

/* The two points of Lobatto's rule on a way, looked up when they are first needed. */
typedef struct {
    bool known;
    Point at[2];
} Inner;

static const double lobatto[2] = {0.5 - SLIDER_LOBATTO, 0.5 + SLIDER_LOBATTO};

static const Point *inner_points(const Foundation *f, const PatchPath *path, Inner *inner)
{
    for (int p = 0; p < 2 && !inner->known; p++) {
        const double approach = path->from->approach + lobatto[p] * (path->to->approach - path->from->approach);
        inner->at[p] = foundation_point(f, approach, path->to->full);
    }
    inner->known = true;
    return inner->at;
}

/* Sums over the sliders, over the early and the late ones. */
typedef struct {
    double x[2], y[2], xx[2], xy[2], yy[2], heat[2];
} Sums;

/* Trial forces x, y, their limits, and whether they are beyond these. */
static inline void try_forces(const Foundation *restrict f, int n, double u, double v, double to,
                              const double *restrict q_x, const double *restrict q_y, double *restrict x,
                              double *restrict y, Work *restrict w)
{
    const double grown = f->mu / f->ratio * to;
    for (int k = 0; k < n; k++) {
        w->limit[k] = f->limit[k] + f->K[k] * grown;
        x[k] = q_x[k] + f->K[k] * u;
        y[k] = q_y[k] + f->K[k] * v;
        w->over[k] = x[k] * x[k] + y[k] * y[k] - w->limit[k] * w->limit[k];
    }
}

/* Those from the first that slips on: trial forces x, y become forces on the friction circle where they are
 * beyond it. Written are the changes of the tangent and the heat. */
static inline void slip_all(const double *restrict K, const double *restrict per_K, const double *restrict fixed,
                            double grown, int first, int n, const double *restrict q_x,
                            const double *restrict q_y, double *restrict x, double *restrict y, Work *restrict w)
{
    for (int k = first; k < n; k++) {
        const double limit = w->limit[k], before = fixed[k] + K[k] * grown, square = x[k] * x[k] + y[k] * y[k];
        const bool slips = square > limit * limit;
        const double size = sqrt(slips ? square : 1.0), beyond = slips ? size - limit : 1.0;
        const double early = before * size - (q_x[k] * x[k] + q_y[k] * y[k]); /* margin times size */
        const double margin = early > 0.0 ? early : 0.0, all = margin + beyond * size, per_all = 1.0 / (size * all);
        const double per = slips ? all * per_all : 0.0, onset = margin * size * per_all;
        const double part = slips ? limit * per : 1.0, n_x = x[k] * per, n_y = y[k] * per;
        const double stiffness = part * K[k], gone = stiffness - K[k];
        const double heat = 0.5 * (limit + before + onset * (limit - before)) * beyond * per_K[k];
        w->xx[k] = gone - stiffness * n_x * n_x;
        w->xy[k] = stiffness * n_x * n_y;
        w->yy[k] = gone - stiffness * n_y * n_y;
        w->heat[k] = slips ? heat : 0.0;
        x[k] *= part;
        y[k] *= part;
    }
}

/* The first pair of which one is beyond its limit. */
static inline int first_over(const double *over, int n)
{
    int k = 0;
    while (k < n && !((over[k] > over[k + 1] ? over[k] : over[k + 1]) > 0.0))
        k += 2;
    return k;
}

/* Add forces, and from the first that slips on changes of the tangent and heat. */
static inline void add_up(const double *x, const double *y, const Work *w, int first, int n, Sums *sum)
{
    Sums s = *sum;
    double next[2][2] = {{0.0, 0.0}, {0.0, 0.0}}; /* every second range has sums of its own, to be added meanwhile */
    int i = 0;
    for (; i + 4 <= n; i += 4) {
        s.x[0] += x[i];
        s.x[1] += x[i + 1];
        s.y[0] += y[i];
        s.y[1] += y[i + 1];
        next[0][0] += x[i + 2];
        next[0][1] += x[i + 3];
        next[1][0] += y[i + 2];
        next[1][1] += y[i + 3];
    }
    for (; i < n; i++) {
        next[0][i % 2] += x[i];
        next[1][i % 2] += y[i];
    }
    for (int l = 0; l < 2; l++) {
        s.x[l] += next[0][l];
        s.y[l] += next[1][l];
    }
    for (int k = first; k < n; k += 2) {
        s.xx[0] += w->xx[k];
        s.xx[1] += w->xx[k + 1];
        s.xy[0] -= w->xy[k];
        s.xy[1] -= w->xy[k + 1];
        s.yy[0] += w->yy[k];
        s.yy[1] += w->yy[k + 1];
        s.heat[0] += w->heat[k];
        s.heat[1] += w->heat[k + 1];
    }
    *sum = s;
}

/* The first `n` sliders, of ranges all in contact. Those that stick take no more than a trial force. */
static void move_full(const Foundation *f, int n, const PatchPath *path, double *const moved[2], Work *w, Sums *sum)
{
    const double *q_x = path->force[0], *q_y = path->force[1], to = path->to->approach, from = path->from->approach;
    try_forces(f, n, path->shift[0], path->shift[1], to, q_x, q_y, moved[0], moved[1], w);
    const int first = first_over(w->over, n);
    slip_all(f->K, f->per_K, f->limit, f->mu / f->ratio * from, first, n, q_x, q_y, moved[0], moved[1], w);
    add_up(moved[0], moved[1], w, first, n, sum);
}

/* The same along x alone and under a load that stays. */
static inline void try_along(const Foundation *restrict f, int n, double u, double to, const double *restrict q,
                             double *restrict x, Work *restrict w)
{
    const double grown = f->mu / f->ratio * to;
    for (int k = 0; k < n; k++) {
        w->limit[k] = f->limit[k] + f->K[k] * grown;
        x[k] = q[k] + f->K[k] * u;
        w->over[k] = fabs(x[k]) - w->limit[k];
    }
}

static inline void slip_along(const Foundation *restrict f, int first, int n, double *restrict x, Work *restrict w)
{
    for (int k = first; k < n; k++) {
        const bool slips = w->over[k] > 0.0;
        const double beyond = slips ? w->over[k] : 0.0, size = fabs(x[k]), part = slips ? w->limit[k] / size : 1.0;
        w->xx[k] = slips ? -f->K[k] : 0.0;
        w->yy[k] = (part - 1.0) * f->K[k];
        w->heat[k] = w->limit[k] * beyond * f->per_K[k];
        x[k] *= part;
    }
}

static void move_along(const Foundation *f, int n, const PatchPath *path, double *x, Work *w, Sums *sum)
{
    double force[2] = {0.0, 0.0};
    try_along(f, n, path->shift[0], path->to->approach, path->force[0], x, w);
    const int first = first_over(w->over, n);
    slip_along(f, first, n, x, w);
    for (int k = 0; k < n; k += 2) {
        force[0] += x[k];
        force[1] += x[k + 1];
    }
    for (int l = 0; l < 2; l++) {
        sum->x[l] += force[l];
        for (int k = first + l; k < n; k += 2) {
            sum->xx[l] += w->xx[k];
            sum->yy[l] += w->yy[k];
            sum->heat[l] += w->heat[k];
        }
    }
}

/* The range in which springs begin to touch, along x alone and while the load stays. */
static void rest_along(const Foundation *f, int i, const PatchPath *path, double *x, Sums *sum)
{
    const Pair here = pair_at(f, i, path->to);
    const double soft = here.K > 0.0 ? 1.0 / here.K : 0.0;
    for (int l = 0; l < 2; l++) {
        const double trial = path->force[0][2 * i + l] + here.K * path->shift[0], size = fabs(trial);
        const bool slips = size > here.limit[l];
        const double part = slips ? here.limit[l] / size : 1.0;
        x[2 * i + l] = part * trial;
        sum->x[l] += part * trial;
        sum->xx[l] += slips ? 0.0 : here.K;
        sum->yy[l] += part * here.K;
        sum->heat[l] += slips ? here.limit[l] * (size - here.limit[l]) * soft : 0.0;
    }
}

/* The range in which springs begin to touch, while the load stays. */
static void move_resting(const Foundation *f, int i, const PatchPath *path, double *const moved[2], Work *w,
                         Sums *sum)
{
    const Pair here = pair_at(f, i, path->to);
    const double soft = here.K > 0.0 ? 1.0 / here.K : 0.0, K[2] = {here.K, here.K}, per_K[2] = {soft, soft};
    const double *q_x = path->force[0] + 2 * i, *q_y = path->force[1] + 2 * i;
    double *x = moved[0] + 2 * i, *y = moved[1] + 2 * i;
    for (int l = 0; l < 2; l++) {
        w->limit[l] = here.limit[l];
        x[l] = q_x[l] + here.K * path->shift[0];
        y[l] = q_y[l] + here.K * path->shift[1];
        w->over[l] = x[l] * x[l] + y[l] * y[l] - here.limit[l] * here.limit[l];
        sum->xx[l] += here.K;
        sum->yy[l] += here.K;
    }
    const int first = first_over(w->over, 2);
    if (first < 2)
        slip_all(K, per_K, here.limit, 0.0, first, 2, q_x, q_y, x, y, w);
    add_up(x, y, w, first, 2, sum);
}

/* A range whose stiffness changes on the way. */
typedef struct {
    Pair start, end;
    double per_start, per_end; /* 1/K, 0 without springs */
    double per_rise;           /* mean stiffness over the rise of the limits */
    bool across;               /* its springs begin or cease to touch */
} Range;

static Range range_on(const Foundation *f, int i, const PatchPath *path)
{
    const Pair start = pair_at(f, i, path->from), end = pair_at(f, i, path->to);
    const double change = path->to->approach - path->from->approach;
    return (Range){.start = start,
                   .end = end,
                   .per_start = start.K > 0.0 ? 1.0 / start.K : 0.0,
                   .per_end = end.K > 0.0 ? 1.0 / end.K : 0.0,
                   .per_rise = 0.5 * f->ratio / (f->mu * change),
                   .across = !stays(i, path->from, path->to)};
}

/* Stiffness by which sliders gain force on a part of the way, and what they keep. */
static inline void carrying(const Foundation *f, int i, const PatchPath *path, const Range *r, const Point *at,
                            const Pair *to, double part, double *keeps, double *carries)
{
    const double change = part * (path->to->approach - path->from->approach);
    const bool small = change < SLIDER_SMALL * (f->height[i + 1] - f->height[i]);
    *keeps = 1.0;
    *carries = to->K;
    if (change < 0.0) {
        const double kept = to->K * r->per_start;
        *keeps = kept < 1.0 ? kept : 1.0;
    } else if (to->K != r->start.K && small && stays(i, path->from, at)) {
        *carries = 0.5 * (r->start.K + to->K) + change * (r->start.slope - to->slope) / 12.0;
    } else if (to->K != r->start.K) {
        const double rise = to->limit[0] + to->limit[1] - r->start.limit[0] - r->start.limit[1];
        *carries = rise * r->per_rise / part;
    }
}

/* A slider after a way, as `slide` of the package; returned is 1 over the size of the trial force, 0 if it sticks. */
static inline double slid(double q_x, double q_y, double keeps, double carries, const double shift[2], double limit,
                          double y[2])
{
    y[0] = keeps * q_x + carries * shift[0];
    y[1] = keeps * q_y + carries * shift[1];
    const double square = y[0] * y[0] + y[1] * y[1];
    if (!(square > limit * limit))
        return 0.0;
    const double per = 1.0 / sqrt(square);
    y[0] *= limit * per;
    y[1] *= limit * per;
    return per;
}

/* Work of the two sliders by Lobatto's rule. */
static void work_across(const Foundation *f, int i, const PatchPath *path, const Range *r, const Point *inner,
                        const double *x, const double *y, double work[2])
{
    const double *q_x = path->force[0] + 2 * i, *q_y = path->force[1] + 2 * i, *u = path->shift;
    for (int l = 0; l < 2; l++)
        work[l] = ((q_x[l] + x[l]) * u[0] + (q_y[l] + y[l]) * u[1]) / 12.0;
    for (int p = 0; p < 2; p++) {
        const Pair there = pair_at(f, i, &inner[p]);
        const double shift[2] = {lobatto[p] * u[0], lobatto[p] * u[1]};
        double keeps, carries, force[2];
        carrying(f, i, path, r, &inner[p], &there, lobatto[p], &keeps, &carries);
        for (int l = 0; l < 2; l++) {
            slid(q_x[l], q_y[l], keeps, carries, shift, there.limit[l], force);
            work[l] += 5.0 / 12.0 * (force[0] * u[0] + force[1] * u[1]);
        }
    }
}

/* The sliders of a range that changes, or is not all in contact. */
static void move_range(const Foundation *f, int i, const PatchPath *path, Inner *inner, double *const moved[2],
                       Sums *sum)
{
    const Range r = range_on(f, i, path);
    const double *q_x = path->force[0] + 2 * i, *q_y = path->force[1] + 2 * i, *u = path->shift;
    const double bent = square_of(u) * (r.start.K - r.end.K) / 12.0;
    double *x = moved[0] + 2 * i, *y = moved[1] + 2 * i, work[2], keeps, carries, per[2];
    carrying(f, i, path, &r, path->to, &r.end, 1.0, &keeps, &carries);
    for (int l = 0; l < 2; l++) {
        double force[2];
        per[l] = slid(q_x[l], q_y[l], keeps, carries, u, r.end.limit[l], force);
        x[l] = force[0];
        y[l] = force[1];
        const double part = per[l] > 0.0 ? r.end.limit[l] * per[l] : 1.0, stiffness = part * r.end.K;
        const double turned = per[l] > 0.0 && r.end.limit[l] > 0.0 ? r.end.K * per[l] / r.end.limit[l] : 0.0;
        sum->x[l] += x[l];
        sum->y[l] += y[l];
        sum->xx[l] += stiffness - turned * x[l] * x[l];
        sum->xy[l] -= turned * x[l] * y[l];
        sum->yy[l] += stiffness - turned * y[l] * y[l];
        work[l] = 0.5 * ((q_x[l] + x[l]) * u[0] + (q_y[l] + y[l]) * u[1]) + (per[l] > 0.0 ? 0.0 : bent);
    }
    if (r.across)
        work_across(f, i, path, &r, inner_points(f, path, inner), x, y, work);
    for (int l = 0; l < 2; l++) {
        const double stored = x[l] * x[l] + y[l] * y[l], was = q_x[l] * q_x[l] + q_y[l] * q_y[l];
        const double heat = work[l] - 0.5 * (stored * r.per_end - was * r.per_start);
        sum->heat[l] += heat > 0.0 ? heat : 0.0;
    }
}

static int touched_on(const PatchPath *path)
{
    return path->from->touched > path->to->touched ? path->from->touched : path->to->touched;
}

void foundation_move(const Foundation *f, const PatchPath *path, double *const moved[2], Work *work, Shear *shear)
{
    const int full = path->from->full < path->to->full ? path->from->full : path->to->full, touched = touched_on(path);
    const bool rests = path->from->approach == path->to->approach;
    const double stick = full > 0 ? 0.5 * f->stick[full - 1] : 0.0;
    Sums sum = {.xx = {stick, stick}, .yy = {stick, stick}};
    Inner inner = {.known = false};
    if (rests && path->straight)
        move_along(f, 2 * full, path, moved[0], work, &sum);
    else
        move_full(f, 2 * full, path, moved, work, &sum);
    for (int i = full; i < touched; i++) {
        if (rests && path->straight)
            rest_along(f, i, path, moved[0], &sum);
        else if (rests)
            move_resting(f, i, path, moved, work, &sum);
        else
            move_range(f, i, path, &inner, moved, &sum);
    }
    *shear = (Shear){.traction = {sum.x[0] + sum.x[1], sum.y[0] + sum.y[1]},
                     .tangent = {sum.xx[0] + sum.xx[1], sum.xy[0] + sum.xy[1], sum.yy[0] + sum.yy[1]},
                     .loss = sum.heat[0] + sum.heat[1]};
}

Shear foundation_at_rest(const Foundation *f, const Point *at)
{
    const double K = f->ratio * fmax(at->y[1] - f->stiffness[0], 0.0);
    return (Shear){.tangent = {K, 0.0, K}};
}

/* Rates */

enum { KEEPS = 2, CARRIES, SHIFT, LIMIT = SHIFT + 2, STIFFNESS, N_SLIDE }; /* arguments of `slide`: force, then these */
enum { BEYOND = 2, TANGENT, N_SLID = TANGENT + 3 };             /* its results: force, then these */

/* Arguments of `slide` for the part of a path up to a point, and their rates. */
static void arguments(const Foundation *f, int i, int late, const PatchPath *path, const Point *to, double part,
                      const double rates[2], const double shift[2], double *x)
{
    const Pair start = pair_at(f, i, path->from), end = pair_at(f, i, to);
    const Gain gain = gain_on(f, i, path->from, to, &start, &end);
    const double first = rates[0], last = first + part * (rates[1] - first);
    double *dx = x + N_SLIDE - KEEPS; /* none of the force */
    for (int d = 0; d < 2; d++) {
        x[d] = path->force[d][2 * i + late];
        x[SHIFT + d] = part * path->shift[d];
        dx[SHIFT + d] = part * shift[d];
    }
    x[KEEPS] = gain.keeps;
    x[CARRIES] = gain.carries;
    x[STIFFNESS] = end.K;
    x[LIMIT] = end.limit[late];
    dx[KEEPS] = gain.keeps_by[0] * first + gain.keeps_by[1] * last;
    dx[CARRIES] = gain.carries_by[0] * first + gain.carries_by[1] * last;
    dx[STIFFNESS] = end.slope * last;
    dx[LIMIT] = end.change[late] * last;
}

/* Work on a slider that changes, and its rate, as in `move_range`. */
static void work_rate(const Foundation *f, const Point *inner, int i, int late, const PatchPath *path,
                      const double rates[2], const double shift[2], const double *y, const double *dy, double *work)
{
    const double *u = path->shift;
    const int k = 2 * i + late;
    work[0] = work[1] = 0.0;
    if (stays(i, path->from, path->to)) {
        const Pair start = pair_at(f, i, path->from), end = pair_at(f, i, path->to);
        const double softens = y[BEYOND] > 0.0 ? 0.0 : (start.K - end.K) / 12.0;
        const double softens_rate = y[BEYOND] > 0.0 ? 0.0 : (start.slope * rates[0] - end.slope * rates[1]) / 12.0;
        for (int d = 0; d < 2; d++) {
            const double total = path->force[d][k] + y[d];
            work[0] += 0.5 * total * u[d] + u[d] * u[d] * softens;
            work[1] += 0.5 * (total * shift[d] + dy[d] * u[d]) + 2.0 * u[d] * shift[d] * softens + u[d] * u[d] * softens_rate;
        }
        return;
    }
    for (int d = 0; d < 2; d++) {
        work[0] += (path->force[d][k] + y[d]) / 12.0 * u[d];
        work[1] += ((path->force[d][k] + y[d]) * shift[d] + dy[d] * u[d]) / 12.0;
    }
    for (int p = 0; p < 2; p++) {
        double x[2 * N_SLIDE], there[N_SLID], rate[N_SLID];
        arguments(f, i, late, path, &inner[p], lobatto[p], rates, shift, x);
        slide(x, NULL, there);
        slide_seed(x, NULL, rate);
        for (int d = 0; d < 2; d++) {
            work[0] += 5.0 / 12.0 * there[d] * u[d];
            work[1] += 5.0 / 12.0 * (there[d] * shift[d] + rate[d] * u[d]);
        }
    }
}

/* Rate of the heat of a slider. */
static double heat_rate(const Foundation *f, const Point *inner, int i, int late, const PatchPath *path,
                        const double rates[2], const double shift[2], const double *y, const double *dy)
{
    const Pair start = pair_at(f, i, path->from), end = pair_at(f, i, path->to);
    const double q[2] = {path->force[0][2 * i + late], path->force[1][2 * i + late]};
    if (start.K == end.K) {
        const double x[14] = {q[0], q[1], y[0], y[1], y[BEYOND], start.limit[late], end.limit[late], end.K,
                              dy[0], dy[1], dy[BEYOND], start.change[late] * rates[0], end.change[late] * rates[1],
                              end.slope * rates[1]};
        double rate;
        slip_loss_seed(x, NULL, &rate);
        return rate;
    }
    double work[2];
    work_rate(f, inner, i, late, path, rates, shift, y, dy, work);
    if (!(work[0] > elastic(y, end.K) - elastic(q, start.K)))
        return 0.0;
    const double after = end.K > 0.0 ? (y[0] * dy[0] + y[1] * dy[1]) / end.K - elastic(y, end.K) * end.slope * rates[1] / end.K : 0.0;
    const double before = start.K > 0.0 ? elastic(q, start.K) * start.slope * rates[0] / start.K : 0.0;
    return work[1] - after - before;
}

/* Whether a slider of a range whose springs all touch sticks. */
static bool sticks(const Foundation *f, int k, const PatchPath *path)
{
    const double x = path->force[0][k] + f->K[k] * path->shift[0], y = path->force[1][k] + f->K[k] * path->shift[1];
    const double limit = f->limit[k] + f->K[k] * (f->mu / f->ratio * path->to->approach);
    return !(x * x + y * y > limit * limit);
}

/* Add the rates of one slider. */
static void add_rates(const Foundation *f, const Point *inner, int k, const PatchPath *path, const double rates[2],
                      const double shift[2], Shear *rate)
{
    double x[2 * N_SLIDE], y[N_SLID], dy[N_SLID];
    arguments(f, k / 2, k % 2, path, path->to, 1.0, rates, shift, x);
    slide(x, NULL, y);
    slide_seed(x, NULL, dy);
    for (int d = 0; d < 2; d++)
        rate->traction[d] += dy[d];
    for (int d = 0; d < 3; d++)
        rate->tangent[d] += dy[TANGENT + d];
    rate->loss += heat_rate(f, inner, k / 2, k % 2, path, rates, shift, y, dy);
}

void foundation_rates(const Foundation *f, const PatchPath *path, const double rates[2], const double shift[2],
                      Shear *rate)
{
    const int full = path->from->full < path->to->full ? path->from->full : path->to->full;
    const double approach = fmax(path->from->approach, path->to->approach);
    int touched = touched_on(path);
    Inner inner = {.known = false};
    const bool still = path->shift[0] == 0.0 && path->shift[1] == 0.0;
    if (still && touched < HEIGHTS && approach == f->height[touched]) /* about to touch; where it shifts they slip */
        touched++;
    *rate = (Shear){.loss = 0.0};
    if (touched > full)
        inner_points(f, path, &inner);
    for (int k = 0; k < 2 * touched; k++) {
        if (k < 2 * full && sticks(f, k, path)) {
            rate->traction[0] += f->K[k] * shift[0];
            rate->traction[1] += f->K[k] * shift[1];
        } else {
            add_rates(f, inner.at, k, path, rates, shift, rate);
        }
    }
}
