#include "friction.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "optimize_for_size.h"
#include "simd.h"

/* What each slider of a range has at a point, the early and the late one; or rates of it. */
typedef struct {
    double K, slope, limit[2];
} Pair;
_Static_assert(sizeof(Pair) == 4 * sizeof(double), "results of touching");

static double inverse(const Foundation *f, double load)
{
    int segment = 0;
    double carried;
    return curve_inverse(f->curve, load, &segment, &carried);
}

OPTIMIZE_FOR_SIZE

/* As `around` of the package. */
static void lay_heights(Foundation *f, double reference)
{
    const double end = f->curve->end.y;
    double y[2], *h = f->height;
    curve_evaluate(f->curve, reference, 0, y);
    const bool touches = y[0] > MIN_REFERENCE_RATIO * end, given = touches && y[0] < MAX_REFERENCE_RATIO * end;
    const double load = touches ? fmin(y[0], MAX_REFERENCE_RATIO * end) : DEFAULT_REFERENCE_RATIO * end, over = portable_log(end / load);
    *h++ = f->curve->start.x;
    for (int k = N_BELOW - 1; k >= 0; k--) {
        const double part = (k + f->offset) / (double)N_BELOW, rest = (1.0 - part) * (1.0 - part);
        *h++ = inverse(f, load * rest / (part * part + rest));
    }
    *h++ = given ? reference : inverse(f, load);
    for (int k = 0; k < N_ABOVE; k++) {
        const double part = (k + f->offset) / (double)N_ABOVE;
        *h++ = inverse(f, load * portable_exp(over * (part * part)));
    }
    *h = f->curve->end.x;
}

END_OPTIMIZE_FOR_SIZE

/* The sums over the springs of a range, and its sliders. */
static void lay_range(Foundation *f, int i)
{
    const double width = f->height[i + 1] - f->height[i];
    f->springs[i] = fmax(f->stiffness[i + 1] - f->stiffness[i], 0.0);
    f->normal[i] = fmax(f->load[i + 1] - f->load[i] - f->stiffness[i] * width, 0.0);
    f->apart[i] = fmin(f->springs[i] * (UNIFORM_DEVIATION * width), f->normal[i]);
    for (int late = 0; late < 2; late++) {
        const int k = 2 * i + late;
        const double first = f->normal[i] + (late ? f->apart[i] : -f->apart[i]);
        f->K[k] = 0.5 * f->ratio * f->springs[i];
        f->per_K[k] = f->K[k] > 0.0 ? 1.0 / f->K[k] : 0.0;
        f->limit[k] = 0.5 * f->mu * (first - f->springs[i] * f->height[i + 1]);
    }
}

static void sum_sticks(Foundation *f)
{
    for (int i = 0; i < HEIGHTS; i++)
        f->stick[i] = f->ratio * f->springs[i] + (i > 0 ? f->stick[i - 1] : 0.0);
}

/* A height stands elsewhere. */
static void put_height(Foundation *f, int i, double height)
{
    double y[2];
    curve_evaluate(f->curve, height, 1, y);
    f->height[i] = height;
    f->load[i] = y[0];
    f->stiffness[i] = y[1];
}

void foundation_lay(Foundation *f, double reference)
{
    f->reference = reference;
    f->lowest = f->curve->end.x;
    f->lowered = 0;
    lay_heights(f, reference);
    for (int i = 0; i < N_HEIGHTS; i++)
        put_height(f, i, f->height[i]);
    for (int i = 0; i < HEIGHTS; i++)
        lay_range(f, i);
    sum_sticks(f);
}

/* As `lowered` of the package. */
void foundation_lower(Foundation *f, double lowest)
{
    const int before = f->lowered;
    int above = 0;
    if (before > 0)
        put_height(f, before, f->laid);
    while (above < HEIGHTS && f->height[above] < lowest)
        above++;
    f->lowest = lowest;
    f->lowered = above < HEIGHTS ? above : 0;
    if (f->lowered > 0) {
        f->laid = f->height[above];
        put_height(f, above, lowest);
    }
    for (int i = before - 1; i <= before && before > 0; i++)
        lay_range(f, i);
    for (int i = f->lowered - 1; i <= f->lowered && f->lowered > 0; i++)
        lay_range(f, i);
    sum_sticks(f);
}

/* Place, load with two derivatives and energy where the curve goes on as its tangent, or before it begins. */
static void point_beyond(const Curve *curve, const CurveEnergy *energy, Point *p)
{
    const bool after = p->approach >= curve->end.x;
    const double beyond = p->approach - (after ? curve->end.x : curve->start.x);
    curve_evaluate(curve, p->approach, 2, p->y);
    p->energy = energy->node_energy[after ? curve->n - 1 : 0] + beyond * (p->y[0] - 0.5 * beyond * p->y[1]);
}

void foundation_find(const Foundation *f, Point *p)
{
    while (p->full > 0 && p->approach < f->height[p->full])
        p->full--;
    while (p->full < HEIGHTS && p->approach >= f->height[p->full + 1])
        p->full++;
    p->touched = p->full + (p->full < HEIGHTS && p->approach > f->height[p->full]);
}

Point foundation_point(const Foundation *f, double approach, int near)
{
    const Curve *curve = f->curve;
    const CurveEnergy *energy = f->energy;
    Point p = {.approach = approach, .full = near};
    if (approach >= curve->start.x && approach < curve->end.x) {
        const int segment = curve_find_segment(curve, approach);
        const double t = (approach - curve->x[segment]) * curve->inverse_length[segment];
        segment_derivatives(curve, segment, t, 2, p.y);
        p.energy = segment_energy(energy, curve, segment, t);
    } else {
        point_beyond(curve, energy, &p);
    }
    foundation_find(f, &p);
    return p;
}

/* Arguments of `touching` for a range at a point. */
enum { X_RATIO, X_MU, X_LOAD, X_STIFFNESS, X_BEND, X_WIDTH, N_TOUCHING };

static inline void entered(const Foundation *f, int i, const Point *p, double *x)
{
    x[X_RATIO] = f->ratio;
    x[X_MU] = f->mu;
    x[X_WIDTH] = p->approach - f->height[i];
    x[X_LOAD] = p->y[0] - f->load[i] - f->stiffness[i] * x[X_WIDTH];
    x[X_STIFFNESS] = p->y[1] - f->stiffness[i];
    x[X_BEND] = p->y[2];
}

/* Those of a range at a point, see `Foundation.carried`. */
static inline Pair pair_at(const Foundation *f, int i, const Point *p)
{
    double x[N_TOUCHING];
    Pair pair = {.K = 0.0};
    if (p->approach < f->height[i])
        return pair;
    if (i < p->full) {
        const double *limit = f->limit + 2 * i, K = f->K[2 * i], to = f->mu / f->ratio * p->approach;
        return (Pair){.K = K, .limit = {limit_at_growth(limit[0], K, to), limit_at_growth(limit[1], K, to)}};
    }
    entered(f, i, p, x);
    touching(x, NULL, &pair.K);
    return pair;
}

/* Whether all, some or none of the springs of a range touch at both points alike. */
static bool stays(int i, const Point *from, const Point *to)
{
    return (i < from->touched) == (i < to->touched) && (i < from->full) == (i < to->full);
}

/* Whether the mean stiffness of a range on a way follows from its ends. */
static inline bool small_on(const Foundation *f, int i, const Point *from, const Point *at)
{
    const double change = at->approach - from->approach;
    return change == 0.0 || (stays(i, from, at) && fabs(change) < SMALL_CHANGE_RATIO * (f->height[i + 1] - f->height[i]));
}

/* The middle of a way, looked up when it is first needed. */
typedef struct {
    bool known;
    Point at;
} Middle;

static const Point *middle_of(const Foundation *f, const PatchPath *path, Middle *middle)
{
    if (!middle->known)
        middle->at = foundation_point(f, 0.5 * (path->from->approach + path->to->approach), path->to->full);
    middle->known = true;
    return &middle->at;
}

static void add(const SliderResultant *sum, Shear *shear)
{
    for (int d = 0; d < 3; d++)
        shear->traction[d] += sum->force[d];
    for (int d = 0; d < 6; d++)
        shear->tangent[d] += sum->tangent[d];
    shear->loss += sum->loss;
}

/* One slider by its force, tangent xx, xy, yy and heat, with the way around the centre of its patch. */
static inline void add_one(const double *slid, double e_x, double e_y, Shear *shear)
{
    const double x = slid[0], y = slid[1], xx = slid[2], xy = slid[3], yy = slid[4];
    const double x_t = xx * e_x + xy * e_y, y_t = xy * e_x + yy * e_y;
    const SliderResultant one = {{x, y, x * e_x + y * e_y}, {xx, xy, yy, x_t, y_t, x_t * e_x + y_t * e_y}, slid[MAPPING_LOSS]};
    add(&one, shear);
}

/* Sliders of all patches that may slip */

/* Arguments of `changing_loss`. */
enum { C_ACROSS, C_FORCE, C_MOVED = 3, C_SHIFT = 5, C_FIRST = 7, C_LAST, C_SLIP, C_MIDDLE, N_CHANGING = 12 };

/* Heat of a slider of a range that changes. */
static inline double changing(const Run *run, int k, const Abreast *all)
{
    const int at = run->at + k;
    double x[N_CHANGING] = {run->across}, loss;
    for (int d = 0; d < 2; d++) {
        x[C_FORCE + d] = all->force[d][at];
        x[C_MOVED + d] = all->slid[MAPPING_FORCE + d][at];
        x[C_SHIFT + d] = all->shift[d][at];
        x[C_MIDDLE + d] = run->across ? all->slid[MAPPING_FORCE + d][at + 2] : 0.0;
    }
    x[C_FIRST] = run->K;
    x[C_LAST] = all->K[at];
    x[C_SLIP] = all->slid[MAPPING_SLIP][at];
    changing_loss(x, NULL, &loss);
    return loss;
}

static inline void end_run(const Run *run, const Abreast *all)
{
    for (int k = 0; k < 2; k++) {
        double slid[N_MAPPING];
        for (int r = 0; r < N_MAPPING; r++)
            slid[r] = all->slid[r][run->at + k];
        if (run->changes)
            slid[MAPPING_LOSS] = changing(run, k, all);
        add_one(slid, run->turning[0][k], run->turning[1][k], run->shear);
        for (int d = 0; d < 2; d++)
            run->moved[d][k] = slid[d];
    }
}

static Sliders2D abreast(const Abreast *all)
{
    return (Sliders2D){.force = {all->force[0], all->force[1]},
                          .torsion_directions = {all->shift[0], all->shift[1]},
                          .displacement = {0.0, 0.0, 1.0},
                          .retention = all->keeps,
                          .secant_stiffness = all->carries,
                          .K = all->K,
                          .compliance = all->per_K,
                          .limit_start = all->before,
                          .limit_end = all->after};
}

/* All runs so far. */
static void end_runs(Work *work)
{
    Abreast *all = &work->abreast;
    const Sliders2D s = abreast(all);
    double *slid[N_MAPPING];
    for (int r = 0; r < N_MAPPING; r++)
        slid[r] = all->slid[r];
    sliders_return_map(all->use_avx, 0, (all->n + 3) / 4 * 4, &s, slid, work->forces); /* the last beside old ones */
    for (int i = 0; i < work->n; i++) {
        const Run *run = &work->runs[i];
        if (!work->forces)
            end_run(run, all);
        else
            add_resultant(2, slid[0] + run->at, slid[1] + run->at, run->turning[0], run->turning[1], run->shear->traction);
    }
    work->n = all->n = 0;
}

void foundations_end(Work *work)
{
    end_runs(work);
    work->forces = false;
}

/* A run of up to so many sliders, from one on of its patch. */
static Run *begin_run(Work *work, int most, int k, double *const moved[2], const double *const turning[2], Shear *shear)
{
    if (work->abreast.n + most > ABREAST)
        end_runs(work);
    Run *run = &work->runs[work->n++];
    *run = (Run){.at = work->abreast.n,
                 .moved = {moved[0] + k, moved[1] + k},
                 .turning = {turning[0] + k, turning[1] + k},
                 .shear = shear};
    return run;
}

/* The next pair. */
static inline void add_pair(Abreast *all, const Sliders2D *s, int first)
{
    for (int k = first; k < first + 2; k++, all->n++) {
        for (int d = 0; d < 2; d++) {
            all->force[d][all->n] = s->force[d][k];
            all->shift[d][all->n] = slider_displacement(s->torsion_directions, k, s->displacement, d);
        }
        all->keeps[all->n] = s->retention[k];
        all->carries[all->n] = s->secant_stiffness[k];
        all->K[all->n] = s->K[k];
        all->per_K[all->n] = s->compliance[k];
        all->before[all->n] = limit_at_growth(s->limit_start[k], s->K[k], s->growth_start);
        all->after[all->n] = limit_at_growth(s->limit_end[k], s->K[k], s->growth_end);
    }
}

/* Sliders whose stiffness stays: `stick` is the sum of the stiffness of those before each second one. */
static void move_steady(int n, const Sliders2D *s, const double *stick, bool along, double *const moved[2],
                        Work *work, Shear *shear)
{
    const bool use_avx = work->abreast.use_avx;
    SliderResultant sum = {.loss = 0.0};
    const int first = along ? sliders_advance_along_x(n, s, moved[0], &sum) : sliders_predict(use_avx, n, s, moved, sum.force);
    const int end = first + (n - first) / 4 * 4;
    const double K = first > 0 ? stick[first / 2 - 1] : 0.0;
    sum.tangent[0] += K;
    sum.tangent[2] += K;
    sum.tangent[5] += K;
    add(&sum, shear);
    if (along)
        return;
    if (end > first) {
        double rows[N_MAPPING - 2][FOUNDATION_SLIDERS], *slid[N_MAPPING] = {moved[0], moved[1]};
        for (int r = 2; r < N_MAPPING; r++)
            slid[r] = rows[r - 2];
        sliders_return_map(use_avx, first, end, s, slid, work->forces);
        if (!work->forces) {
            sliders_resultant(use_avx, first, end, s, slid, &sum);
            add(&sum, shear);
        } else {
            add_resultant(end - first, moved[0] + first, moved[1] + first, s->torsion_directions[0] + first, s->torsion_directions[1] + first,
                       shear->traction);
        }
    }
    if (n > end) {
        begin_run(work, 2, end, moved, s->torsion_directions, shear);
        add_pair(&work->abreast, s, end);
    }
}

/* Parts kept of the force where the stiffness stays. */
static const double all_kept[] = {
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
_Static_assert(sizeof all_kept == FOUNDATION_SLIDERS * sizeof *all_kept, "of each");

/* Those from one on. */
static inline Sliders2D sliders_on(const Foundation *f, const PatchPath *path, int k)
{
    return (Sliders2D){.force = {path->force[0] + k, path->force[1] + k},
                          .retention = all_kept,
                          .torsion_directions = {f->turning[0] + k, f->turning[1] + k},
                          .displacement = {path->shift[0], path->shift[1], path->shift[2]}};
}

/* Those of ranges all in contact. */
static Sliders2D full_on(const Foundation *f, const PatchPath *path)
{
    Sliders2D s = sliders_on(f, path, 0);
    s.K = s.secant_stiffness = f->K;
    s.compliance = f->per_K;
    s.limit_start = s.limit_end = f->limit;
    s.growth_start = f->mu / f->ratio * path->from->approach;
    s.growth_end = f->mu / f->ratio * path->to->approach;
    return s;
}

/* The first `n` sliders, of ranges all in contact. */
static void move_full(const Foundation *f, int n, const PatchPath *path, bool along, double *const moved[2],
                      Work *work, Shear *shear)
{
    const Sliders2D s = full_on(f, path);
    move_steady(n, &s, f->stick, along, moved, work, shear);
}

/* The range in which springs begin to touch, while the load stays. */
static void move_resting(const Foundation *f, int i, const PatchPath *path, bool along, double *const moved[2],
                         Work *work, Shear *shear)
{
    const Pair here = pair_at(f, i, path->to);
    const double soft = here.K > 0.0 ? 1.0 / here.K : 0.0, K[2] = {here.K, here.K}, per_K[2] = {soft, soft};
    double *const to[2] = {moved[0] + 2 * i, moved[1] + 2 * i}, stick = 2.0 * here.K;
    Sliders2D s = sliders_on(f, path, 2 * i);
    s.K = s.secant_stiffness = K;
    s.compliance = per_K;
    s.limit_start = s.limit_end = here.limit;
    move_steady(2, &s, &stick, along, to, work, shear);
}

/* Arguments of `carrying`. */
enum { X_SMALL, X_FIRST, X_SLOPE, X_LAST, X_THEN, X_CHANGE, X_RISE, N_CARRYING };

static inline double sum_of_limits(const Pair *pair)
{
    return pair->limit[0] + pair->limit[1];
}

/* Those that change: of a range from its start to a point, the part `part` of the way, or rates of them. */
static inline void ends_of(const Foundation *f, const Pair *start, const Pair *end, double change, double *x)
{
    x[X_FIRST] = start->K;
    x[X_SLOPE] = start->slope;
    x[X_LAST] = end->K;
    x[X_THEN] = end->slope;
    x[X_CHANGE] = change;
    x[X_RISE] = 0.5 * f->ratio / f->mu * (sum_of_limits(end) - sum_of_limits(start));
}

static inline void gain(const Foundation *f, int i, const PatchPath *path, const Pair *start, const Pair *end,
                        const Point *at, double *x)
{
    const double change = at->approach - path->from->approach;
    ends_of(f, start, end, change, x);
    x[X_SMALL] = small_on(f, i, path->from, at);
}

/* The next pair, that of a range which changes, from its start to an end; `gained` is of `carrying`. */
static inline void add_range(Sliders2D s, const Pair *start, const Pair *end, const double gained[2], Abreast *all)
{
    const double soft = end->K > 0.0 ? 1.0 / end->K : 0.0, K[2] = {end->K, end->K}, per_K[2] = {soft, soft};
    const double keeps[2] = {gained[0], gained[0]}, carries[2] = {gained[1], gained[1]};
    s.K = K;
    s.compliance = per_K;
    s.retention = keeps;
    s.secant_stiffness = carries;
    s.limit_start = start->limit;
    s.limit_end = end->limit;
    add_pair(all, &s, 0);
}

/* The sliders of a range that changes. */
static void move_range(const Foundation *f, int i, const PatchPath *path, Middle *middle, double *const moved[2],
                       Work *work, Shear *shear)
{
    const bool across = !work->forces && !stays(i, path->from, path->to);
    const Point *half = across ? middle_of(f, path, middle) : path->to, *points[2] = {path->to, half};
    const Pair start = pair_at(f, i, path->from), end = pair_at(f, i, path->to);
    const Pair ends[2] = {end, across ? pair_at(f, i, half) : end};
    const int n = across ? 2 : 1;
    double x[N_CARRYING], gained[2];
    Sliders2D s = sliders_on(f, path, 2 * i);
    Run *run = begin_run(work, 2 * n, 2 * i, moved, f->turning, shear);
    run->across = across;
    run->K = start.K;
    run->changes = start.K != end.K;
    for (int at = 0; at < n; at++) {
        gain(f, i, path, &start, &ends[at], points[at], x);
        carrying(x, NULL, gained);
        add_range(s, &start, &ends[at], gained, &work->abreast);
        for (int d = 0; d < 3; d++)
            s.displacement[d] *= 0.5;
    }
}

/* Ranges whose springs all touch on the whole way. */
static int full_on_way(const PatchPath *path)
{
    return path->from->full < path->to->full ? path->from->full : path->to->full;
}

void foundation_move(const Foundation *f, const PatchPath *path, double *const moved[2], Work *work, Shear *shear)
{
    const int full = full_on_way(path), touched = touched_on(path);
    const bool rests = path->from->approach == path->to->approach, along = !ELASTIC && rests && path->straight;
    Middle middle = {.known = false};
    *shear = (Shear){.loss = 0.0};
    move_full(f, 2 * full, path, along, moved, work, shear);
    for (int i = full; i < touched; i++) {
        if (rests)
            move_resting(f, i, path, along, moved, work, shear);
        else
            move_range(f, i, path, &middle, moved, work, shear);
    }
}

/* Slopes */

/* The next pair comes apart: without more as its limits grow with stiffnesses K. */
static void part_pair(const Foundation *f, int first, double K, Work *work)
{
    for (int k = 0; k < 2; k++) {
        const int at = work->abreast.n + k;
        work->apart.limit[at] = -f->mu / f->ratio * K;
        for (int d = 0; d < 2; d++) {
            work->apart.turning[d][at] = f->turning[d][first + k];
            work->apart.shift[d][at] = 0.0;
        }
    }
}

/* That of a range that changes, with what it gains where the patch comes apart by a step, by differences. */
static void add_parting(const Foundation *f, int i, const PatchPath *path, const Point *apart, double step, Work *work)
{
    const Point *at[2] = {path->to, apart};
    const Pair start = pair_at(f, i, path->from);
    const int first = work->abreast.n;
    Pair end[2];
    double gained[2][2];
    for (int k = 0; k < 2; k++) {
        double x[N_CARRYING];
        end[k] = pair_at(f, i, at[k]);
        gain(f, i, path, &start, &end[k], at[k], x);
        carrying(x, NULL, gained[k]);
    }
    const double per_gain = gained[0][1] > 0.0 ? 1.0 / (step * gained[0][1]) : 0.0;
    part_pair(f, 2 * i, end->K, work);
    add_range(sliders_on(f, path, 2 * i), &start, end, gained[0], &work->abreast);
    for (int k = 0; k < 2; k++) {
        const int row = first + k;
        work->apart.limit[row] = (end[1].limit[k] - end[0].limit[k]) / step;
        for (int d = 0; d < 2; d++)
            work->apart.shift[d][row] = per_gain * ((gained[1][0] - gained[0][0]) * work->abreast.force[d][row] +
                                                    (gained[1][1] - gained[0][1]) * work->abreast.shift[d][row]);
    }
}

void foundation_slopes(const Foundation *f, const PatchPath *path, double step, double *const tried[2], Work *work,
                       double slope[4][3])
{
    const int full = full_on_way(path), touched = touched_on(path);
    Abreast *all = &work->abreast;
    double force[3];
    Sliders2D s = full_on(f, path);
    const int first = sliders_predict(all->use_avx, 2 * full, &s, tried, force);
    const Point apart = foundation_point(f, path->to->approach - step, path->to->full);
    for (int k = first; k < 2 * full; k += 2) {
        part_pair(f, k, f->K[k], work);
        add_pair(all, &s, k);
    }
    for (int i = full; i < touched; i++)
        add_parting(f, i, path, &apart, step, work);
    if (all->n % 4 > 0) { /* two that have nothing */
        static const double none[2] = {0.0};
        s = (Sliders2D){.force = {none, none}, .retention = none, .torsion_directions = {none, none}, .K = none, .secant_stiffness = none,
                           .compliance = none, .limit_start = none, .limit_end = none};
        part_pair(f, 0, 0.0, work);
        add_pair(all, &s, 0);
    }
    const SliderRates rates = {{work->apart.turning[0], work->apart.turning[1]},
                               work->apart.limit,
                               {work->apart.shift[0], work->apart.shift[1]}};
    s = abreast(all);
    sliders_force_derivatives(all->use_avx, all->n, &s, &rates, slope);
    for (int d = 0; d < 3 && first > 0; d++)
        slope[d][d] += f->stick[first / 2 - 1];
    all->n = 0;
}

double foundation_stick(const Foundation *f, const Point *at)
{
    return f->ratio * fmax(at->y[1] - f->stiffness[0], 0.0);
}

enum { R_FALLS, R_BEFORE, R_AFTER, N_REST }; /* arguments of `rest_rule` */

/* As `Foundation.rested` of the package. */
bool foundation_rest(const Foundation *f, const PatchPath *path, const double before[3], Shear *shear)
{
    const Point *from = path->from, *to = path->to;
    const double x[N_REST] = {to->approach < from->approach, foundation_stick(f, from), foundation_stick(f, to)};
    const double most = FULL_STICK_RATIO * f->mu / f->ratio * x[R_AFTER] * (to->approach - f->height[0]);
    double rule[2], *t = shear->traction;
    rest_rule(x, NULL, rule);
    *shear = (Shear){.tangent = {x[R_AFTER], 0.0, x[R_AFTER], 0.0, 0.0, x[R_AFTER]}};
    for (int d = 0; d < 3; d++)
        t[d] = rule[0] * before[d] + rule[1] * path->shift[d];
    return sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]) <= most;
}

bool foundation_rest_rates(const Foundation *f, const PatchPath *path, const double before[3],
                           const PathRate *towards, const PathRate *rates, Shear *rate)
{
    const Point *from = path->from, *to = path->to;
    const double rises = towards->ends[1] - towards->ends[0];
    const bool corner = to->approach == from->approach && rises != 0.0;
    const bool falls = to->approach < from->approach || (corner && rises < 0.0);
    const double first = f->ratio * from->y[2] * rates->ends[0], last = f->ratio * to->y[2] * rates->ends[1];
    const double x[2 * N_REST - 1] = {falls, foundation_stick(f, from), foundation_stick(f, to), first, last};
    double rule[2], slopes[2];
    rest_rule(x, NULL, rule);
    rest_rule_seed(x, NULL, slopes);
    *rate = (Shear){.tangent = {last, 0.0, last, 0.0, 0.0, last}};
    for (int d = 0; d < 3; d++)
        rate->traction[d] = slopes[0] * before[d] + slopes[1] * path->shift[d] + rule[1] * rates->shift[d];
    return corner;
}

void foundation_spread(const Foundation *f, const Point *at, const double traction[3], double *const force[2])
{
    const double stick = foundation_stick(f, at);
    for (int i = 0; i < at->touched; i++) {
        const double part = stick > 0.0 ? pair_at(f, i, at).K / stick : 0.0;
        for (int d = 0; d < 2; d++)
            for (int k = 2 * i; k < 2 * i + 2; k++)
                force[d][k] = part * slider_displacement(f->turning, k, traction, d);
    }
    for (int d = 0; d < 2; d++)
        memset(force[d] + 2 * at->touched, 0, (size_t)(FOUNDATION_SLIDERS - 2 * at->touched) * sizeof *force[d]);
}

OPTIMIZE_FOR_SIZE

/* Rates
 *
 * Forces have corners: where a slider at its limit slips in one direction and sticks in the other, where a path ends at
 * a height, and where the load of springs stays on it, as those that lift off take their force with them. Each rate is
 * that on the side to which a direction points. */

/* A path, its rates, and the direction to which the side points on which they are taken. */
typedef struct {
    const PatchPath *path;
    const PathRate *towards, *rates;
    bool *corner; /* set where the other side has other rates */
} PathSide;

/* A point that moves on, where it stands at a height: the ranges that touch are those just above or just below it. */
static Point point_towards(const Foundation *f, const Point *at, double rises, bool *corner)
{
    Point p = *at;
    if (p.full == 0 || p.full == HEIGHTS || p.approach != f->height[p.full] || rises == 0.0)
        return p;
    *corner = true;
    if (rises > 0.0)
        p.touched = p.full + 1;
    else
        p.full--;
    return p;
}

/* What sliders have, with its rates: a range at a point, or one of its sliders after a way. */
typedef struct {
    Pair at, rate;
} Pairs;
typedef struct {
    double at[N_MAPPING], rate[N_MAPPING];
} Slid;

/* The approach of the point and the stiffness' slope change with rates. */
static Pairs pairs_at(const Foundation *f, int i, const Point *p, double rate, double bend)
{
    Pairs pairs = {.at = pair_at(f, i, p)};
    double x[2 * N_TOUCHING - X_LOAD];
    if (p->approach < f->height[i])
        return pairs;
    if (i < p->full) {
        for (int late = 0; late < 2; late++)
            pairs.rate.limit[late] = f->mu / f->ratio * pairs.at.K * rate;
        return pairs;
    }
    if (p->approach == f->height[i]) { /* springs begin to touch, with no load yet */
        pairs.rate.K = pairs.at.slope * rate;
        return pairs;
    }
    entered(f, i, p, x);
    const double rates[] = {(p->y[1] - f->stiffness[i]) * rate, p->y[2] * rate, bend * rate, rate};
    memcpy(x + N_TOUCHING, rates, sizeof rates);
    touching_seed(x, NULL, &pairs.rate.K);
    if (p->approach == f->height[i + 1]) { /* all touch: the same numbers, whose rates are of one side */
        Point all = *p;
        all.full = i + 1;
        const Pair full = pair_at(f, i, &all);
        pairs.at.K = full.K;
        memcpy(pairs.at.limit, full.limit, sizeof full.limit);
    }
    return pairs;
}

/* Arguments of `return_map_2d`; rates of those from P_KEEPS on follow them in its seed. */
enum { P_FORCE, P_KEEPS = 2, P_CARRIES, P_SHIFT, P_BEFORE = 6, P_AFTER, P_K, P_PER_K, N_PLANE };

/* A trial force this near to its limit is at it [1]: limits of springs that touch late are small differences. */
static const double NEAR_LIMIT = 1e-9;
/* By which a limit that begins to grow or to fall is another one before [1]: the rule of a slider has a corner there. */
static const double OTHER_LIMIT = 1e-14;

/* The trial force of a slider, or its rate with rates of the arguments. */
static inline double trial_force(const double *x, int d)
{
    return x[P_KEEPS] * x[P_FORCE + d] + x[P_CARRIES] * x[P_SHIFT + d];
}

static inline double trial_rate(const double *x, const double rate[N_PLANE - P_KEEPS], int d)
{
    return rate[0] * x[P_FORCE + d] + rate[P_CARRIES - P_KEEPS] * x[P_SHIFT + d] +
           x[P_CARRIES] * rate[P_SHIFT - P_KEEPS + d];
}

static bool near_limit(const double x[N_PLANE])
{
    const double u = trial_force(x, 0), v = trial_force(x, 1), limit = x[P_AFTER];
    return fabs(sqrt(u * u + v * v) - limit) <= NEAR_LIMIT * limit;
}

/* Whether the rates of a slider can depend on the side. */
static bool has_sides(const double x[N_PLANE])
{
    return x[P_BEFORE] == x[P_AFTER] || near_limit(x);
}

/* One slider with rates of its arguments, in the direction of others. */
static Slid slide_towards(double x[2 * N_PLANE - P_KEEPS], const double towards[N_PLANE - P_KEEPS], bool *corner)
{
    Slid slid;
    const double u = trial_force(x, 0), v = trial_force(x, 1), limit = x[P_AFTER];
    const double own[2] = {trial_rate(x, x + N_PLANE, 0), trial_rate(x, x + N_PLANE, 1)};
    const bool at_limit = near_limit(x);
    const double beyond = u * trial_rate(x, towards, 0) + v * trial_rate(x, towards, 1) - limit * towards[P_AFTER - P_KEEPS];
    const double least = at_limit ? 1.0 - 2.0 * NEAR_LIMIT : 1.0;
    const double grows = towards[P_AFTER - P_KEEPS] - towards[P_BEFORE - P_KEEPS];
    if (x[P_BEFORE] == limit && grows != 0.0) {
        x[P_BEFORE] *= 1.0 - copysign(OTHER_LIMIT, grows);
        *corner = *corner || u * u + v * v > limit * limit;
    }
    for (int k = P_BEFORE; k <= P_AFTER; k++) {
        x[k] *= least;
        x[k + N_PLANE - P_KEEPS] *= least;
    }
    return_map_2d(x, NULL, slid.at);
    return_map_2d_seed(x, NULL, slid.rate);
    *corner = *corner || (at_limit && beyond != 0.0);
    if (at_limit && !(beyond > 0.0)) { /* it sticks; its tangent stays that of a slider that slips */
        slid.rate[0] = own[0];
        slid.rate[1] = own[1];
        slid.rate[MAPPING_LOSS] = slid.rate[MAPPING_SLIP] = 0.0;
    }
    return slid;
}

/* Rates of the arguments of a slider k of a range: its stiffness and limits before and after have rates, the shift is
 * that of a part of the path. */
static void slider_rates(const Foundation *f, int k, const double gains[2], const PathRate *rates, double part,
                         const double limits[2], double K_rate, double per_K, double out[N_PLANE - P_KEEPS])
{
    const double all[] = {gains[0], gains[1], part * slider_displacement(f->turning, k, rates->shift, 0),
                          part * slider_displacement(f->turning, k, rates->shift, 1), limits[0], limits[1], K_rate,
                          -K_rate * per_K * per_K};
    memcpy(out, all, sizeof all);
}

/* What a range gains on a part of a path. */
typedef struct {
    Pairs start, end;
    double gained[2], gains[2];
} Gain;

static Gain gain_on(const Foundation *f, int i, const PathSide *c, const Point *from, const Point *at, double part,
                    const PathRate *rates)
{
    const double change = at->approach - from->approach, turned = part * (rates->ends[1] - rates->ends[0]);
    const double rises = c->towards->ends[1] - c->towards->ends[0];
    const double bend = change != 0.0 ? (c->path->to->y[2] - c->path->from->y[2]) /
                                            (c->path->to->approach - c->path->from->approach)
                                      : 0.0;
    double x[2 * N_CARRYING - 1];
    Gain g = {.end = pairs_at(f, i, at, rates->ends[0] + turned, bend)};
    g.start = change != 0.0 || c->path->first ? pairs_at(f, i, from, rates->ends[0], bend) : (Pairs){.at = g.end.at};
    gain(f, i, c->path, &g.start.at, &g.end.at, at, x);
    if (change == 0.0 && rises != 0.0) { /* springs that lift off take their force with them */
        x[X_CHANGE] = copysign(DBL_MIN, rises);
        *c->corner = true;
    }
    ends_of(f, &g.start.rate, &g.end.rate, turned, x + N_CARRYING - 1);
    carrying(x, NULL, g.gained);
    carrying_seed(x, NULL, g.gains);
    return g;
}

/* One slider of a range on a part of a path. */
static Slid slide_on(const Foundation *f, const PathSide *c, int i, const Point *from, const Point *at, double part, int late,
                     const Gain *own)
{
    const int k = 2 * i + late;
    const double K = own->end.at.K, per_K = K > 0.0 ? 1.0 / K : 0.0;
    double x[2 * N_PLANE - P_KEEPS] = {c->path->force[0][k], c->path->force[1][k], own->gained[0], own->gained[1],
                                       part * slider_displacement(f->turning, k, c->path->shift, 0),
                                       part * slider_displacement(f->turning, k, c->path->shift, 1),
                                       own->start.at.limit[late], own->end.at.limit[late], K, per_K};
    double direction[N_PLANE - P_KEEPS] = {0.0};
    const double limits[2] = {own->start.rate.limit[late], own->end.rate.limit[late]};
    slider_rates(f, k, own->gains, c->rates, part, limits, own->end.rate.K, per_K, x + N_PLANE);
    if (has_sides(x)) {
        const Gain towards = gain_on(f, i, c, from, at, part, c->towards);
        const double ahead[2] = {towards.start.rate.limit[late], towards.end.rate.limit[late]};
        slider_rates(f, k, towards.gains, c->towards, part, ahead, towards.end.rate.K, per_K, direction);
    }
    return slide_towards(x, direction, c->corner);
}

/* Of the elastic energy before [1]. */
static const double HEAT_ROUND_OFF = 1e-13;

/* Rate of the heat of a slider of a range that changes: where there is none, none can be lost on either side. */
static double loss_rate(const PathSide *c, double x[2 * N_CHANGING - 3])
{
    double loss, more, rate, along = c->rates->ends[1] * c->towards->ends[1];
    for (int d = 0; d < 3; d++)
        along += c->rates->shift[d] * c->towards->shift[d];
    changing_loss(x, NULL, &loss);
    x[C_FIRST] *= 1.0 - HEAT_ROUND_OFF; /* a little more energy before: the heat is round-off if it is less */
    changing_loss(x, NULL, &more);
    changing_loss_seed(x, NULL, &rate);
    if (loss > 0.5 * more)
        return rate;
    *c->corner = *c->corner || rate != 0.0;
    return along < 0.0 ? fmin(rate, 0.0) : fmax(rate, 0.0);
}

/* Rates of the sliders of a range that is not all in contact, on one side of a path, whose points are given. */
static void range_rate(const Foundation *f, int i, const PathSide *c, const Point *from, const Point *to,
                       const Point *middle, Shear *rate)
{
    const PatchPath *path = c->path;
    const Point *points[2] = {to, middle};
    const bool across = !stays(i, path->from, to);
    Gain own[2];
    Slid slid[2][2] = {{{{0.0}, {0.0}}}};
    for (int at = 0; at < (across ? 2 : 1); at++) {
        const double part = at > 0 ? 0.5 : 1.0;
        own[at] = gain_on(f, i, c, from, points[at], part, c->rates);
        for (int late = 0; late < 2; late++)
            slid[at][late] = slide_on(f, c, i, from, points[at], part, late, &own[at]);
    }
    if (to->approach == f->height[i]) { /* springs without load: no force is left, and it grows by second order */
        memset(slid[0], 0, sizeof slid[0]);
        own->end.rate.K = 0.0;
    }
    const Pairs *start = &own->start, *last = &own->end;
    for (int late = 0; late < 2; late++) {
        const Slid *end = &slid[0][late], *half = &slid[1][late];
        const double *moved = end->at;
        const int k = 2 * i + late;
        double shift[2], rated[2], dy[N_MAPPING];
        memcpy(dy, end->rate, sizeof dy);
        for (int d = 0; d < 2; d++) {
            shift[d] = slider_displacement(f->turning, k, path->shift, d);
            rated[d] = slider_displacement(f->turning, k, c->rates->shift, d);
        }
        double x[] = {across, path->force[0][k], path->force[1][k], moved[0], moved[1],
                            shift[0], shift[1], start->at.K, last->at.K, moved[MAPPING_SLIP], half->at[0], half->at[1],
                            dy[0], dy[1], rated[0], rated[1], start->rate.K, last->rate.K, dy[MAPPING_SLIP],
                            half->rate[0], half->rate[1]};
        if (start->at.K != last->at.K || start->rate.K != last->rate.K)
            dy[MAPPING_LOSS] = loss_rate(c, x);
        add_one(dy, f->turning[0][k], f->turning[1][k], rate);
    }
}

/* How stiffness and limit of a slider change with the approach, where the heights stay, or are laid around it. */
typedef struct {
    double K[FOUNDATION_SLIDERS], limit[FOUNDATION_SLIDERS];
} SliderRate;

/* Rates of the heights that are laid around an approach, see `lay_heights` and `foundation_lower`. */
static void height_rates(const Foundation *f, double rate, double height[N_HEIGHTS])
{
    const double end = f->curve->end.y;
    double y[2];
    curve_evaluate(f->curve, f->reference, 1, y);
    const bool follow = y[0] > MIN_REFERENCE_RATIO * end && y[0] < MAX_REFERENCE_RATIO * end;
    memset(height, 0, N_HEIGHTS * sizeof *height);
    for (int i = 1; i < N_HEIGHTS - 1 && follow; i++) { /* loads in proportion below, in that of their logarithm above */
        const double part = i > N_BELOW ? fmax(i - 2 - N_BELOW + f->offset, 0.0) / (double)N_ABOVE : 0.0;
        const double load = f->load[i] / y[0] * (1.0 - part * part) * y[1] * rate;
        height[i] = f->stiffness[i] > 0.0 ? load / f->stiffness[i] : 0.0;
    }
    if (follow)
        height[N_BELOW + 1] = rate;
    if (f->lowered > 0)
        height[f->lowered] = rate;
}

/* Rates of the first `n` ranges, all in contact at the approach around which the heights are laid. */
static void laid_rates(const Foundation *f, int n, double approach, double rate, SliderRate *out)
{
    double height[N_HEIGHTS], stiffness[N_HEIGHTS];
    height_rates(f, rate, height);
    for (int i = 0; i < N_HEIGHTS; i++) {
        double y[3];
        curve_evaluate(f->curve, f->height[i], 2, y);
        stiffness[i] = y[2] * height[i];
    }
    for (int i = 0; i < n; i++) {
        const double width = f->height[i + 1] - f->height[i], left = f->height[i + 1] - approach;
        const double springs = stiffness[i + 1] - stiffness[i];
        const double normal = (f->stiffness[i + 1] - f->stiffness[i]) * height[i + 1] - stiffness[i] * width;
        const double apart = f->apart[i] < f->normal[i] ? UNIFORM_DEVIATION * (springs * width + f->springs[i] * (height[i + 1] - height[i]))
                                                        : normal;
        for (int late = 0; late < 2; late++) {
            out->K[2 * i + late] = 0.5 * f->ratio * springs;
            out->limit[2 * i + late] = 0.5 * f->mu * (normal + (late ? apart : -apart) - springs * left -
                                                      f->springs[i] * (height[i + 1] - rate));
        }
    }
}

/* Rates of the first `n` sliders, of ranges all in contact. */
static void full_rates(const Foundation *f, int n, const PathSide *c, Shear *rate)
{
    const PatchPath *path = c->path;
    const double grown = f->mu / f->ratio, from = grown * path->from->approach, to = grown * path->to->approach;
    const double *turn = c->rates->ends, *turned = c->towards->ends;
    SliderRate own, ahead;
    bool found = false;
    if (path->first)
        laid_rates(f, n / 2, path->to->approach, turn[1], &own);
    for (int k = 0; k < n; k++) {
        const double K = f->K[k], per_K = f->per_K[k], before = limit_at_growth(f->limit[k], K, from), after = limit_at_growth(f->limit[k], K, to);
        double x[2 * N_PLANE - P_KEEPS] = {path->force[0][k], path->force[1][k], 1.0, K,
                                           slider_displacement(f->turning, k, path->shift, 0), slider_displacement(f->turning, k, path->shift, 1),
                                           before, after, K, per_K};
        double direction[N_PLANE - P_KEEPS] = {0.0};
        const double limits[2] = {path->first ? own.limit[k] : grown * K * turn[0], path->first ? own.limit[k] : grown * K * turn[1]};
        const double stiffer = path->first ? own.K[k] : 0.0, gains[2] = {0.0, stiffer};
        slider_rates(f, k, gains, c->rates, 1.0, limits, stiffer, per_K, x + N_PLANE);
        const double u = trial_force(x, 0), v = trial_force(x, 1), least = (1.0 - 2.0 * NEAR_LIMIT) * after;
        double dy[N_MAPPING] = {K * x[N_PLANE + 2] + stiffer * x[P_SHIFT], K * x[N_PLANE + 3] + stiffer * x[P_SHIFT + 1],
                                   stiffer, 0.0, stiffer};
        if (u * u + v * v >= least * least) {
            const bool sides = path->first ? near_limit(x) : has_sides(x); /* both limits of a first path are the same */
            if (sides && path->first && !found)
                laid_rates(f, n / 2, path->to->approach, turned[1], &ahead);
            found = found || sides;
            if (sides) {
                const double next[2] = {path->first ? ahead.limit[k] : grown * K * turned[0], path->first ? ahead.limit[k] : grown * K * turned[1]};
                const double stiff = path->first ? ahead.K[k] : 0.0, gain_ahead[2] = {0.0, stiff};
                slider_rates(f, k, gain_ahead, c->towards, 1.0, next, stiff, per_K, direction);
            }
            const Slid slid = slide_towards(x, direction, c->corner);
            memcpy(dy, slid.rate, sizeof dy);
        }
        add_one(dy, f->turning[0][k], f->turning[1][k], rate);
    }
}

/* Rates of a range i > 0 whose springs begin to touch beyond the end of a path. Their limits are of second order, and
 * none of their force is left. They slip along the shift, and are stiff across it alone, where it is larger than what
 * the load rises by lets stick; where the load falls to the height, along the part of their force that they keep, and the
 * shift. Where nothing moves, each goes along as its neighbour below: it slips where that is at its limit. */
static void touching_rate(const Foundation *f, int i, const PathSide *c, const Point *from, const Point *to, Shear *rate)
{
    const PatchPath *path = c->path;
    const bool still = path->shift[0] == 0.0 && path->shift[1] == 0.0 && path->shift[2] == 0.0;
    const double K = pairs_at(f, i, to, c->rates->ends[1], 0.0).rate.K;
    const double change = to->approach - from->approach;
    const Pair below = pair_at(f, i - 1, to), start = pair_at(f, i, from);
    const bool lifts = change < 0.0 && start.K > 0.0, follows = still && !lifts;
    for (int late = 0; late < 2; late++) {
        const int at = 2 * i + late, k = follows ? at - 2 : at;
        const double sticks = f->mu / f->ratio * fmax(change, 0.0) * (late ? 1.0 + 2.0 * UNIFORM_DEVIATION : 1.0 - 2.0 * UNIFORM_DEVIATION);
        const double least = follows ? (1.0 - 2.0 * NEAR_LIMIT) * below.limit[late] : sticks;
        double way[2];
        for (int d = 0; d < 2; d++) {
            const double shift = slider_displacement(f->turning, k, path->shift, d), force = path->force[d][k];
            way[d] = lifts ? force / start.K + shift : follows ? force : shift;
        }
        const double square = way[0] * way[0] + way[1] * way[1], per = square > least * least ? K / square : 0.0;
        const double dy[N_MAPPING] = {0.0, 0.0, K - per * way[0] * way[0], -per * way[0] * way[1], K - per * way[1] * way[1]};
        add_one(dy, f->turning[0][at], f->turning[1][at], rate);
    }
}

bool foundation_rates(const Foundation *f, const PatchPath *path, const PathRate *towards, const PathRate *rates,
                      Shear *rate)
{
    bool corner = false;
    const PathSide path_side = {path, towards, rates, &corner};
    const bool stays_there = path->from->approach == path->to->approach;
    *rate = (Shear){.loss = 0.0};
    const Point to = path->first ? *path->to : point_towards(f, path->to, towards->ends[1], &corner);
    const Point from = stays_there ? to : *path->from;
    const int full = from.full < to.full ? from.full : to.full;
    const bool enters = to.touched > to.full && to.approach == f->height[to.full];
    const int touched = from.touched > to.touched ? from.touched : to.touched;
    full_rates(f, 2 * full, &path_side, rate);
    if (touched == full)
        return corner;
    Middle found = {.known = false};
    const Point middle = stays_there ? to : *middle_of(f, path, &found);
    for (int i = full; i < touched; i++) {
        const bool begins = to.approach == f->height[i];
        if (!begins || from.approach > to.approach)
            range_rate(f, i, &path_side, &from, &to, &middle, rate);
        if (begins && enters && i > 0)
            touching_rate(f, i, &path_side, &from, &to, rate);
    }
    return corner;
}

END_OPTIMIZE_FOR_SIZE
