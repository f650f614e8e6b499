#include "foundation.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "optimize_for_size.h"
#include "simd.h"

/* Properties of both sliders of a range at an approach: stiffness, its slope, limits of the early and the late slider;
 * or their rates. */
typedef struct {
    double K, slope, limit[2];
} SliderProperties;
_Static_assert(sizeof(SliderProperties) == 4 * sizeof(double), "results of partial_contact");

static double approach_at_load(const Foundation *f, double load)
{
    int segment = 0;
    double carried;
    return curve_inverse(f->curve, load, &segment, &carried);
}

OPTIMIZE_FOR_SIZE

/* Repeats `slider_heights` of sliders.py. */
static void slider_heights(Foundation *f, double reference)
{
    const double end = f->curve->end.y;
    double y[2], *h = f->height;
    curve_evaluate(f->curve, reference, 0, y);
    const bool touches = y[0] > MIN_REFERENCE_LOAD_OVER_END_LOAD * end,
               use_reference = touches && y[0] < MAX_REFERENCE_LOAD_OVER_END_LOAD * end;
    const double load = touches ? fmin(y[0], MAX_REFERENCE_LOAD_OVER_END_LOAD * end)
                                : DEFAULT_REFERENCE_LOAD_OVER_END_LOAD * end;
    const double log_load_ratio = portable_log(end / load);
    *h++ = f->curve->start.x;
    for (int k = HEIGHTS_BELOW_REFERENCE - 1; k >= 0; k--) {
        const double position = (k + f->offset) / (double)HEIGHTS_BELOW_REFERENCE;
        const double squared_rest = (1.0 - position) * (1.0 - position);
        *h++ = approach_at_load(f, load * squared_rest / (position * position + squared_rest));
    }
    *h++ = use_reference ? reference : approach_at_load(f, load);
    for (int k = 0; k < HEIGHTS_ABOVE_REFERENCE; k++) {
        const double position = (k + f->offset) / (double)HEIGHTS_ABOVE_REFERENCE;
        *h++ = approach_at_load(f, load * portable_exp(log_load_ratio * (position * position)));
    }
    *h = f->curve->end.x;
}

END_OPTIMIZE_FOR_SIZE

/* Sums over the springs of a range, and its sliders in full contact. The friction limit is linear in the approach from
 * the height of the last spring on, and is stored by its intercept at zero approach. Repeats `partial_contact` at that
 * height, and the growth from there in `Foundation.slider_properties`. docs/architecture.md, "The friction limit",
 * lists all places that contain the limit. */
static void set_range(Foundation *f, int i)
{
    const double width = f->height[i + 1] - f->height[i];
    f->normal_stiffness[i] = fmax(f->stiffness[i + 1] - f->stiffness[i], 0.0);
    f->normal_force[i] = fmax(f->load[i + 1] - f->load[i] - f->stiffness[i] * width, 0.0);
    f->force_deviation[i] = fmin(f->normal_stiffness[i] * (UNIFORM_DISTRIBUTION_DEVIATION * width), f->normal_force[i]);
    for (int late = 0; late < 2; late++) {
        const int k = 2 * i + late;
        const double first = f->normal_force[i] + (late ? f->force_deviation[i] : -f->force_deviation[i]);
        f->K[k] = 0.5 * f->ratio * f->normal_stiffness[i];
        f->per_K[k] = f->K[k] > 0.0 ? 1.0 / f->K[k] : 0.0;
        f->limit_at_zero_approach[k] = 0.5 * f->mu * (first - f->normal_stiffness[i] * f->height[i + 1]);
    }
}

static void sum_stick_stiffness(Foundation *f)
{
    for (int i = 0; i < N_RANGES; i++)
        f->stick_stiffness[i] = f->ratio * f->normal_stiffness[i] + (i > 0 ? f->stick_stiffness[i - 1] : 0.0);
}

/* Set a height, with load and stiffness of the curve. */
static void set_height(Foundation *f, int i, double height)
{
    double y[2];
    curve_evaluate(f->curve, height, 1, y);
    f->height[i] = height;
    f->load[i] = y[0];
    f->stiffness[i] = y[1];
}

void foundation_set_heights(Foundation *f, double reference)
{
    f->onset_approach = reference;
    f->min_approach = f->curve->end.x;
    f->liftoff_height = 0;
    slider_heights(f, reference);
    for (int i = 0; i < N_HEIGHTS; i++)
        set_height(f, i, f->height[i]);
    for (int i = 0; i < N_RANGES; i++)
        set_range(f, i);
    sum_stick_stiffness(f);
}

/* Repeats `heights_after_liftoff` of sliders.py. */
void heights_after_liftoff(Foundation *f, double lowest)
{
    const int before = f->liftoff_height;
    int above = 0;
    if (before > 0)
        set_height(f, before, f->replaced_height);
    while (above < N_RANGES && f->height[above] < lowest)
        above++;
    f->min_approach = lowest;
    f->liftoff_height = above < N_RANGES ? above : 0;
    if (f->liftoff_height > 0) {
        f->replaced_height = f->height[above];
        set_height(f, above, lowest);
    }
    for (int i = before - 1; i <= before && before > 0; i++)
        set_range(f, i);
    for (int i = f->liftoff_height - 1; i <= f->liftoff_height && f->liftoff_height > 0; i++)
        set_range(f, i);
    sum_stick_stiffness(f);
}

/* Load with two derivatives and energy beyond the ends of the curve. */
static void extrapolate_state(const Curve *curve, PatchState *p)
{
    const bool after = p->approach >= curve->end.x;
    const double beyond = p->approach - (after ? curve->end.x : curve->start.x);
    curve_evaluate(curve, p->approach, 2, p->y);
    p->energy = curve->node_energy[after ? curve->n - 1 : 0] + beyond * (p->y[0] - 0.5 * beyond * p->y[1]);
}

void find_ranges(const Foundation *f, PatchState *p)
{
    while (p->full_ranges > 0 && p->approach < f->height[p->full_ranges])
        p->full_ranges--;
    while (p->full_ranges < N_RANGES && p->approach >= f->height[p->full_ranges + 1])
        p->full_ranges++;
    p->touched_ranges = p->full_ranges + (p->full_ranges < N_RANGES && p->approach > f->height[p->full_ranges]);
}

PatchState patch_state(const Foundation *f, double approach, int near)
{
    const Curve *curve = f->curve;
    PatchState p = {.approach = approach, .full_ranges = near};
    if (approach >= curve->start.x && approach < curve->end.x) {
        const int segment = curve_find_segment(curve, approach);
        const double t = segment_parameter(curve, segment, approach);
        segment_derivatives(curve, segment, t, 2, p.y);
        p.energy = segment_energy(curve, segment, t);
    } else {
        extrapolate_state(curve, &p);
    }
    find_ranges(f, &p);
    return p;
}

/* Arguments of `partial_contact`. Arguments before X_LOAD have no rates: `constant_argument_count` in native.py counts
 * them. */
enum { X_RATIO, X_MU, X_LOAD, X_STIFFNESS, X_BEND, X_WIDTH, N_PARTIAL_CONTACT };
enum { N_CONSTANT_ARGUMENTS = X_LOAD };

static inline void partial_contact_arguments(const Foundation *f, int i, const PatchState *p, double *x)
{
    x[X_RATIO] = f->ratio;
    x[X_MU] = f->mu;
    x[X_WIDTH] = p->approach - f->height[i];
    x[X_LOAD] = p->y[0] - f->load[i] - f->stiffness[i] * x[X_WIDTH];
    x[X_STIFFNESS] = p->y[1] - f->stiffness[i];
    x[X_BEND] = p->y[2];
}

/* Repeats `Foundation.slider_properties`, for one range. */
static inline SliderProperties slider_properties(const Foundation *f, int i, const PatchState *p)
{
    double x[N_PARTIAL_CONTACT];
    SliderProperties pair = {.K = 0.0};
    if (p->approach < f->height[i])
        return pair;
    if (i < p->full_ranges) {
        const double *intercept = f->limit_at_zero_approach + 2 * i, K = f->K[2 * i];
        const double growth = f->mu / f->ratio * p->approach;
        return (SliderProperties){
            .K = K, .limit = {limit_at_growth(intercept[0], K, growth), limit_at_growth(intercept[1], K, growth)}};
    }
    partial_contact_arguments(f, i, p, x);
    partial_contact(x, NULL, &pair.K);
    return pair;
}

/* Whether a range is in full, partial or no contact at both ends. */
static bool keeps_contact_state(int i, const PatchState *from, const PatchState *to)
{
    return (i < from->touched_ranges) == (i < to->touched_ranges) && (i < from->full_ranges) == (i < to->full_ranges);
}

/* Whether the mean stiffness of a range is computed from derivatives at both ends. */
static inline bool is_small_approach_change(const Foundation *f, int i, const PatchState *from, const PatchState *at)
{
    const double change = at->approach - from->approach;
    return change == 0.0 ||
           (keeps_contact_state(i, from, at) &&
            fabs(change) < SMALL_APPROACH_CHANGE_OVER_INTERVAL * (f->height[i + 1] - f->height[i]));
}

/* State in the middle of an increment, found when it is first needed. */
typedef struct {
    bool known;
    PatchState at;
} MiddleState;

static const PatchState *middle_state(const Foundation *f, const PatchIncrement *path, MiddleState *middle)
{
    if (!middle->known)
        middle->at = patch_state(f, 0.5 * (path->start->approach + path->end->approach), path->end->full_ranges);
    middle->known = true;
    return &middle->at;
}

static void add_sum(const SliderResultant *sum, SliderUpdate *update)
{
    for (int d = 0; d < 3; d++)
        update->traction[d] += sum->force[d];
    for (int d = 0; d < 6; d++)
        update->tangent[d] += sum->tangent[d];
    update->loss += sum->loss;
}

/* Add one slider: force, tangent xx, xy, yy and loss; e_x, e_y: its torsion direction. */
static inline void add_slider(const double *mapping, double e_x, double e_y, SliderUpdate *update)
{
    const double x = mapping[0], y = mapping[1], xx = mapping[2], xy = mapping[3], yy = mapping[4];
    const double x_r = xx * e_x + xy * e_y, y_r = xy * e_x + yy * e_y;
    const SliderResultant one = {
        {x, y, x * e_x + y * e_y}, {xx, xy, yy, x_r, y_r, x_r * e_x + y_r * e_y}, mapping[MAPPING_LOSS]};
    add_sum(&one, update);
}

/* Return mapping of sliders that may slip */

/* Arguments of `varying_stiffness_loss`. */
enum {
    C_CONTACT_CHANGES,
    C_FORCE,
    C_FORCE_END = 3,
    C_DISPLACEMENT = 5,
    C_STIFFNESS_START = 7,
    C_STIFFNESS_END,
    C_SLIP,
    C_MIDDLE,
    N_VARYING_LOSS = 12
};

/* Dissipated energy of a slider whose stiffness changes. */
static inline double varying_loss(const Run *run, int k, const SimdBatch *all)
{
    const int at = run->at + k;
    double x[N_VARYING_LOSS] = {run->contact_changes}, loss;
    for (int d = 0; d < 2; d++) {
        x[C_FORCE + d] = all->force[d][at];
        x[C_FORCE_END + d] = all->results[MAPPING_FORCE + d][at];
        x[C_DISPLACEMENT + d] = all->displacement[d][at];
        x[C_MIDDLE + d] = run->contact_changes ? all->results[MAPPING_FORCE + d][at + 2] : 0.0;
    }
    x[C_STIFFNESS_START] = run->K;
    x[C_STIFFNESS_END] = all->K[at];
    x[C_SLIP] = all->results[MAPPING_SLIP][at];
    varying_stiffness_loss(x, NULL, &loss);
    return loss;
}

static inline void finish_run(const Run *run, const SimdBatch *all)
{
    for (int k = 0; k < 2; k++) {
        double mapping[N_MAPPING];
        for (int r = 0; r < N_MAPPING; r++)
            mapping[r] = all->results[r][run->at + k];
        if (run->stiffness_changes)
            mapping[MAPPING_LOSS] = varying_loss(run, k, all);
        add_slider(mapping, run->torsion_directions[0][k], run->torsion_directions[1][k], run->update);
        for (int d = 0; d < 2; d++)
            run->force_end[d][k] = mapping[d];
    }
}

static Sliders2D batch(const SimdBatch *all)
{
    return (Sliders2D){.force = {all->force[0], all->force[1]},
                          .torsion_directions = {all->displacement[0], all->displacement[1]},
                          .displacement = {0.0, 0.0, 1.0},
                          .retention = all->retention,
                          .secant_stiffness = all->secant_stiffness,
                          .K = all->K,
                          .compliance = all->per_K,
                          .limit_start = all->limit_start,
                          .limit_end = all->limit_end};
}

/* Return-map all sliders in the batch. */
static void finish_runs(SliderWork *work)
{
    SimdBatch *all = &work->batch;
    const Sliders2D s = batch(all);
    double *mapping[N_MAPPING];
    for (int r = 0; r < N_MAPPING; r++)
        mapping[r] = all->results[r];
    /* up to a multiple of four: old rows follow */
    sliders_return_map(all->use_avx, 0, (all->n + 3) / 4 * 4, &s, mapping, work->forces_only);
    for (int i = 0; i < work->n; i++) {
        const Run *run = &work->runs[i];
        if (!work->forces_only)
            finish_run(run, all);
        else
            add_resultant(2, mapping[0] + run->at, mapping[1] + run->at, run->torsion_directions[0],
                          run->torsion_directions[1], run->update->traction);
    }
    work->n = all->n = 0;
}

void foundations_finish(SliderWork *work)
{
    finish_runs(work);
    work->forces_only = false;
}

/* Start a run of up to `max_rows` rows for the sliders from k on of a patch. */
static Run *add_run(SliderWork *work, int max_rows, int k, double *const force_end[2],
                    const double *const torsion_directions[2], SliderUpdate *update)
{
    if (work->batch.n + max_rows > BATCH_SIZE)
        finish_runs(work);
    Run *run = &work->runs[work->n++];
    *run = (Run){.at = work->batch.n,
                 .force_end = {force_end[0] + k, force_end[1] + k},
                 .torsion_directions = {torsion_directions[0] + k, torsion_directions[1] + k},
                 .update = update};
    return run;
}

/* Add a pair of sliders to the batch. */
static inline void add_pair(SimdBatch *all, const Sliders2D *s, int first)
{
    for (int k = first; k < first + 2; k++, all->n++) {
        for (int d = 0; d < 2; d++) {
            all->force[d][all->n] = s->force[d][k];
            all->displacement[d][all->n] = slider_displacement(s->torsion_directions, k, s->displacement, d);
        }
        all->retention[all->n] = s->retention[k];
        all->secant_stiffness[all->n] = s->secant_stiffness[k];
        all->K[all->n] = s->K[k];
        all->per_K[all->n] = s->compliance[k];
        all->limit_start[all->n] = limit_at_growth(s->limit_start[k], s->K[k], s->growth_start);
        all->limit_end[all->n] = limit_at_growth(s->limit_end[k], s->K[k], s->growth_end);
    }
}

/* Sliders of constant stiffness; `stick` is the sum of the stiffnesses up to each pair. */
static void advance_constant_stiffness(int n, const Sliders2D *s, const double *stick, bool is_along_x,
                                       double *const force_end[2], SliderWork *work, SliderUpdate *update)
{
    const bool use_avx = work->batch.use_avx;
    SliderResultant sum = {.loss = 0.0};
    const int first = is_along_x ? sliders_advance_along_x(n, s, force_end[0], &sum)
                                 : sliders_predict(use_avx, n, s, force_end, sum.force);
    const int end = first + (n - first) / 4 * 4;
    const double K = first > 0 ? stick[first / 2 - 1] : 0.0;
    sum.tangent[0] += K;
    sum.tangent[2] += K;
    sum.tangent[5] += K;
    add_sum(&sum, update);
    if (is_along_x)
        return;
    if (end > first) {
        double rows[N_MAPPING - 2][FOUNDATION_SLIDER_COUNT], *mapping[N_MAPPING] = {force_end[0], force_end[1]};
        for (int r = 2; r < N_MAPPING; r++)
            mapping[r] = rows[r - 2];
        sliders_return_map(use_avx, first, end, s, mapping, work->forces_only);
        if (!work->forces_only) {
            sliders_resultant(use_avx, first, end, s, mapping, &sum);
            add_sum(&sum, update);
        } else {
            add_resultant(end - first, force_end[0] + first, force_end[1] + first, s->torsion_directions[0] + first,
                          s->torsion_directions[1] + first, update->traction);
        }
    }
    if (n > end) {
        add_run(work, 2, end, force_end, s->torsion_directions, update);
        add_pair(&work->batch, s, end);
    }
}

/* Retention of sliders of constant stiffness. */
static const double FULL_RETENTION[] = {
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0,
    1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
_Static_assert(sizeof FULL_RETENTION == FOUNDATION_SLIDER_COUNT * sizeof *FULL_RETENTION, "of each");

/* Sliders from k on, without stiffness and limits. */
static inline Sliders2D sliders_from(const Foundation *f, const PatchIncrement *path, int k)
{
    return (Sliders2D){.force = {path->force[0] + k, path->force[1] + k},
                          .retention = FULL_RETENTION,
                          .torsion_directions = {f->torsion_directions[0] + k, f->torsion_directions[1] + k},
                          .displacement = {path->displacement[0], path->displacement[1], path->displacement[2]}};
}

/* Sliders of ranges in full contact. */
static Sliders2D full_range_sliders(const Foundation *f, const PatchIncrement *path)
{
    Sliders2D s = sliders_from(f, path, 0);
    s.K = s.secant_stiffness = f->K;
    s.compliance = f->per_K;
    s.limit_start = s.limit_end = f->limit_at_zero_approach;
    s.growth_start = f->mu / f->ratio * path->start->approach;
    s.growth_end = f->mu / f->ratio * path->end->approach;
    return s;
}

/* Advance the first n sliders, of ranges in full contact. */
static void advance_full_ranges(const Foundation *f, int n, const PatchIncrement *path, bool is_along_x,
                                double *const force_end[2], SliderWork *work, SliderUpdate *update)
{
    const Sliders2D s = full_range_sliders(f, path);
    advance_constant_stiffness(n, &s, f->stick_stiffness, is_along_x, force_end, work, update);
}

/* Advance the range in partial contact at constant approach. */
static void advance_constant_approach(const Foundation *f, int i, const PatchIncrement *path, bool is_along_x,
                                      double *const force_end[2], SliderWork *work, SliderUpdate *update)
{
    const SliderProperties here = slider_properties(f, i, path->end);
    const double compliance = here.K > 0.0 ? 1.0 / here.K : 0.0;
    const double K[2] = {here.K, here.K}, per_K[2] = {compliance, compliance};
    double *const to[2] = {force_end[0] + 2 * i, force_end[1] + 2 * i}, stick = 2.0 * here.K;
    Sliders2D s = sliders_from(f, path, 2 * i);
    s.K = s.secant_stiffness = K;
    s.compliance = per_K;
    s.limit_start = s.limit_end = here.limit;
    advance_constant_stiffness(2, &s, &stick, is_along_x, to, work, update);
}

/* Arguments of `retention_and_stiffness`. */
enum {
    X_IS_SMALL,
    X_STIFFNESS_START,
    X_SLOPE_START,
    X_STIFFNESS_END,
    X_SLOPE_END,
    X_APPROACH_CHANGE,
    X_RISE,
    N_RETENTION
};

static inline double limit_sum(const SliderProperties *pair)
{
    return pair->limit[0] + pair->limit[1];
}

/* Arguments of `retention_and_stiffness` at both ends of an increment, or their rates. */
static inline void set_range_ends(const Foundation *f, const SliderProperties *start, const SliderProperties *end,
                                  double change, double *x)
{
    x[X_STIFFNESS_START] = start->K;
    x[X_SLOPE_START] = start->slope;
    x[X_STIFFNESS_END] = end->K;
    x[X_SLOPE_END] = end->slope;
    x[X_APPROACH_CHANGE] = change;
    x[X_RISE] = 0.5 * f->ratio / f->mu * (limit_sum(end) - limit_sum(start));
}

static inline void retention_arguments(const Foundation *f, int i, const PatchIncrement *path,
                                       const SliderProperties *start, const SliderProperties *end, const PatchState *at,
                                       double *x)
{
    const double change = at->approach - path->start->approach;
    set_range_ends(f, start, end, change, x);
    x[X_IS_SMALL] = is_small_approach_change(f, i, path->start, at);
}

/* Add the pair of a range that changes; `factors`: results of `retention_and_stiffness`. */
static inline void add_range_pair(Sliders2D s, const SliderProperties *start, const SliderProperties *end,
                                  const double factors[2], SimdBatch *all)
{
    const double compliance = end->K > 0.0 ? 1.0 / end->K : 0.0;
    const double K[2] = {end->K, end->K}, per_K[2] = {compliance, compliance};
    const double retention[2] = {factors[0], factors[0]}, secant_stiffness[2] = {factors[1], factors[1]};
    s.K = K;
    s.compliance = per_K;
    s.retention = retention;
    s.secant_stiffness = secant_stiffness;
    s.limit_start = start->limit;
    s.limit_end = end->limit;
    add_pair(all, &s, 0);
}

/* Advance a range that changes. */
static void advance_partial_range(const Foundation *f, int i, const PatchIncrement *path, MiddleState *middle,
                                  double *const force_end[2], SliderWork *work, SliderUpdate *update)
{
    const bool contact_changes = !work->forces_only && !keeps_contact_state(i, path->start, path->end);
    const PatchState *half = contact_changes ? middle_state(f, path, middle) : path->end,
                     *points[2] = {path->end, half};
    const SliderProperties start = slider_properties(f, i, path->start), end = slider_properties(f, i, path->end);
    const SliderProperties ends[2] = {end, contact_changes ? slider_properties(f, i, half) : end};
    const int n = contact_changes ? 2 : 1;
    double x[N_RETENTION], factors[2];
    Sliders2D s = sliders_from(f, path, 2 * i);
    Run *run = add_run(work, 2 * n, 2 * i, force_end, f->torsion_directions, update);
    run->contact_changes = contact_changes;
    run->K = start.K;
    run->stiffness_changes = start.K != end.K;
    for (int at = 0; at < n; at++) {
        retention_arguments(f, i, path, &start, &ends[at], points[at], x);
        retention_and_stiffness(x, NULL, factors);
        add_range_pair(s, &start, &ends[at], factors, &work->batch);
        for (int d = 0; d < 3; d++)
            s.displacement[d] *= 0.5;
    }
}

/* Number of ranges in full contact during the whole increment. */
static int full_ranges_throughout(const PatchIncrement *path)
{
    return path->start->full_ranges < path->end->full_ranges ? path->start->full_ranges : path->end->full_ranges;
}

void foundation_advance(const Foundation *f, const PatchIncrement *path, double *const force_end[2], SliderWork *work,
                        SliderUpdate *update)
{
    const int full = full_ranges_throughout(path), touched = touched_ranges_of(path);
    const bool is_constant = path->start->approach == path->end->approach,
               is_along_x = !ELASTIC && is_constant && path->is_1d;
    MiddleState middle = {.known = false};
    *update = (SliderUpdate){.loss = 0.0};
    advance_full_ranges(f, 2 * full, path, is_along_x, force_end, work, update);
    for (int i = full; i < touched; i++) {
        if (is_constant)
            advance_constant_approach(f, i, path, is_along_x, force_end, work, update);
        else
            advance_partial_range(f, i, path, &middle, force_end, work, update);
    }
}

/* Traction derivatives */

/* Derivatives of the next pair by opening: its limits decrease with K. */
static void add_opening_pair(const Foundation *f, int first, double K, SliderWork *work)
{
    for (int k = 0; k < 2; k++) {
        const int at = work->batch.n + k;
        work->opening.limit_rate[at] = -f->mu / f->ratio * K;
        for (int d = 0; d < 2; d++) {
            work->opening.torsion_directions[d][at] = f->torsion_directions[d][first + k];
            work->opening.displacement_rate[d][at] = 0.0;
        }
    }
}

/* Add a range that changes; its derivatives by opening are differences over a step. */
static void add_opening_range(const Foundation *f, int i, const PatchIncrement *path, const PatchState *opened,
                              double step, SliderWork *work)
{
    const PatchState *at[2] = {path->end, opened};
    const SliderProperties start = slider_properties(f, i, path->start);
    const int first = work->batch.n;
    SliderProperties end[2];
    double factors[2][2];
    for (int k = 0; k < 2; k++) {
        double x[N_RETENTION];
        end[k] = slider_properties(f, i, at[k]);
        retention_arguments(f, i, path, &start, &end[k], at[k], x);
        retention_and_stiffness(x, NULL, factors[k]);
    }
    const double per_secant_stiffness = factors[0][1] > 0.0 ? 1.0 / (step * factors[0][1]) : 0.0;
    add_opening_pair(f, 2 * i, end->K, work);
    add_range_pair(sliders_from(f, path, 2 * i), &start, end, factors[0], &work->batch);
    for (int k = 0; k < 2; k++) {
        const int row = first + k;
        work->opening.limit_rate[row] = (end[1].limit[k] - end[0].limit[k]) / step;
        for (int d = 0; d < 2; d++)
            work->opening.displacement_rate[d][row] =
                per_secant_stiffness * ((factors[1][0] - factors[0][0]) * work->batch.force[d][row] +
                                        (factors[1][1] - factors[0][1]) * work->batch.displacement[d][row]);
    }
}

void foundation_traction_derivatives(const Foundation *f, const PatchIncrement *path, double step,
                                     double *const trial_force[2], SliderWork *work, double slope[4][3])
{
    const int full = full_ranges_throughout(path), touched = touched_ranges_of(path);
    SimdBatch *all = &work->batch;
    double force[3];
    Sliders2D s = full_range_sliders(f, path);
    const int first = sliders_predict(all->use_avx, 2 * full, &s, trial_force, force);
    const PatchState opened = patch_state(f, path->end->approach - step, path->end->full_ranges);
    for (int k = first; k < 2 * full; k += 2) {
        add_opening_pair(f, k, f->K[k], work);
        add_pair(all, &s, k);
    }
    for (int i = full; i < touched; i++)
        add_opening_range(f, i, path, &opened, step, work);
    if (all->n % 4 > 0) { /* a pair of zeros */
        static const double none[2] = {0.0};
        s = (Sliders2D){.force = {none, none},
                        .retention = none,
                        .torsion_directions = {none, none},
                        .K = none,
                        .secant_stiffness = none,
                        .compliance = none,
                        .limit_start = none,
                        .limit_end = none};
        add_opening_pair(f, 0, 0.0, work);
        add_pair(all, &s, 0);
    }
    const SliderRates rates = {{work->opening.torsion_directions[0], work->opening.torsion_directions[1]},
                               work->opening.limit_rate,
                               {work->opening.displacement_rate[0], work->opening.displacement_rate[1]}};
    s = batch(all);
    sliders_force_derivatives(all->use_avx, all->n, &s, &rates, slope);
    for (int d = 0; d < 3 && first > 0; d++)
        slope[d][d] += f->stick_stiffness[first / 2 - 1];
    all->n = 0;
}

double stick_stiffness(const Foundation *f, const PatchState *at)
{
    return f->ratio * fmax(at->y[1] - f->stiffness[0], 0.0);
}

enum { R_IS_UNLOADING, R_STIFFNESS_START, R_STIFFNESS_END, N_STICK_RETENTION }; /* arguments of `stick_retention` */

/* Repeats `Foundation.full_stick_update` of sliders.py. */
bool full_stick_update(const Foundation *f, const PatchIncrement *path, const double before[3], SliderUpdate *update)
{
    const PatchState *from = path->start, *to = path->end;
    const double x[N_STICK_RETENTION] = {to->approach < from->approach, stick_stiffness(f, from),
                                         stick_stiffness(f, to)};
    const double max_traction = FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT * f->mu / f->ratio * x[R_STIFFNESS_END] *
                        (to->approach - f->height[0]);
    double retention_rule[2], *t = update->traction;
    stick_retention(x, NULL, retention_rule);
    *update = (SliderUpdate){.tangent = {x[R_STIFFNESS_END], 0.0, x[R_STIFFNESS_END], 0.0, 0.0, x[R_STIFFNESS_END]}};
    for (int d = 0; d < 3; d++)
        t[d] = retention_rule[0] * before[d] + retention_rule[1] * path->displacement[d];
    return sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]) <= max_traction;
}

bool full_stick_rates(const Foundation *f, const PatchIncrement *path, const double before[3],
                           const IncrementRate *direction, const IncrementRate *rates, SliderUpdate *rate)
{
    const PatchState *from = path->start, *to = path->end;
    const double rise_rate = direction->ends[1] - direction->ends[0];
    const bool is_corner = to->approach == from->approach && rise_rate != 0.0;
    const bool is_unloading = to->approach < from->approach || (is_corner && rise_rate < 0.0);
    const double first = f->ratio * from->y[2] * rates->ends[0], last = f->ratio * to->y[2] * rates->ends[1];
    const double x[2 * N_STICK_RETENTION - 1] = {is_unloading, stick_stiffness(f, from), stick_stiffness(f, to), first,
                                                 last};
    double retention_rule[2], rule_rates[2];
    stick_retention(x, NULL, retention_rule);
    stick_retention_seed(x, NULL, rule_rates);
    *rate = (SliderUpdate){.tangent = {last, 0.0, last, 0.0, 0.0, last}};
    for (int d = 0; d < 3; d++)
        rate->traction[d] =
            rule_rates[0] * before[d] + rule_rates[1] * path->displacement[d] +
            retention_rule[1] * rates->displacement[d];
    return is_corner;
}

void distribute_stick_force(const Foundation *f, const PatchState *at, const double traction[3], double *const force[2])
{
    const double stick = stick_stiffness(f, at);
    for (int i = 0; i < at->touched_ranges; i++) {
        const double share = stick > 0.0 ? slider_properties(f, i, at).K / stick : 0.0;
        for (int d = 0; d < 2; d++)
            for (int k = 2 * i; k < 2 * i + 2; k++)
                force[d][k] = share * slider_displacement(f->torsion_directions, k, traction, d);
    }
    for (int d = 0; d < 2; d++)
        memset(force[d] + 2 * at->touched_ranges, 0,
               (size_t)(FOUNDATION_SLIDER_COUNT - 2 * at->touched_ranges) * sizeof *force[d]);
}

OPTIMIZE_FOR_SIZE

/* Rates
 *
 * Forces have corners (jumps of the derivative) at three places: where a slider at its limit slips in one direction and
 * sticks in the other; where a path ends at a height; and where the load of springs stays on a height, as springs that
 * lift off take their force with them. Each rate is the rate on the side to which a direction points. */

/* An increment, its rates, and the rates that point to the side on which they are taken. */
typedef struct {
    const PatchIncrement *path;
    const IncrementRate *direction, *rates;
    bool *corner; /* set where the other side has other rates */
} SideRates;

/* State at a height that moves on: the ranges in contact are those just above or just below the height. */
static PatchState state_beside(const Foundation *f, const PatchState *at, double rise_rate, bool *corner)
{
    PatchState p = *at;
    if (p.full_ranges == 0 || p.full_ranges == N_RANGES || p.approach != f->height[p.full_ranges] || rise_rate == 0.0)
        return p;
    *corner = true;
    if (rise_rate > 0.0)
        p.touched_ranges = p.full_ranges + 1;
    else
        p.full_ranges--;
    return p;
}

/* Values with rates: properties of a range, and the return mapping of one slider. */
typedef struct {
    SliderProperties at, rate;
} PropertiesRate;
typedef struct {
    double at[N_MAPPING], rate[N_MAPPING];
} MappingRate;

/* Properties with rates; `rate` of the approach, `bend` derivative of the slope. */
static PropertiesRate properties_rate(const Foundation *f, int i, const PatchState *p, double rate, double bend)
{
    PropertiesRate pairs = {.at = slider_properties(f, i, p)};
    double x[2 * N_PARTIAL_CONTACT - N_CONSTANT_ARGUMENTS];
    if (p->approach < f->height[i])
        return pairs;
    if (i < p->full_ranges) {
        for (int late = 0; late < 2; late++)
            pairs.rate.limit[late] = f->mu / f->ratio * pairs.at.K * rate;
        return pairs;
    }
    if (p->approach == f->height[i]) { /* springs begin to touch, with no load yet */
        pairs.rate.K = pairs.at.slope * rate;
        return pairs;
    }
    partial_contact_arguments(f, i, p, x);
    const double rates[] = {(p->y[1] - f->stiffness[i]) * rate, p->y[2] * rate, bend * rate, rate};
    memcpy(x + N_PARTIAL_CONTACT, rates, sizeof rates);
    partial_contact_seed(x, NULL, &pairs.rate.K);
    if (p->approach == f->height[i + 1]) { /* all springs touch: equal properties, with rates of one side */
        PatchState all = *p;
        all.full_ranges = i + 1;
        const SliderProperties full = slider_properties(f, i, &all);
        pairs.at.K = full.K;
        memcpy(pairs.at.limit, full.limit, sizeof full.limit);
    }
    return pairs;
}

/* Arguments of `return_map_2d`; in its seed, rates of the arguments from P_RETENTION on follow. */
enum { P_FORCE, P_RETENTION = 2, P_SECANT, P_DISPLACEMENT, P_LIMIT_START = 6, P_LIMIT_END, P_K, P_PER_K, N_PLANE };

/* Relative distance of an elastic predictor from its limit [1] up to which it is at the limit. */
static const double LIMIT_ROUND_OFF = 1e-9;
/* Relative change of the limit at the start [1] that selects the side of a growing or shrinking limit. */
static const double LIMIT_PERTURBATION = 1e-14;

/* Elastic predictor of a slider, and its rate. */
static inline double elastic_predictor(const double *x, int d)
{
    return x[P_RETENTION] * x[P_FORCE + d] + x[P_SECANT] * x[P_DISPLACEMENT + d];
}

static inline double predictor_rate(const double *x, const double rate[N_PLANE - P_RETENTION], int d)
{
    return rate[0] * x[P_FORCE + d] + rate[P_SECANT - P_RETENTION] * x[P_DISPLACEMENT + d] +
           x[P_SECANT] * rate[P_DISPLACEMENT - P_RETENTION + d];
}

static bool is_at_limit(const double x[N_PLANE])
{
    const double u = elastic_predictor(x, 0), v = elastic_predictor(x, 1), limit = x[P_LIMIT_END];
    return fabs(sqrt(u * u + v * v) - limit) <= LIMIT_ROUND_OFF * limit;
}

/* Whether the rates of a slider may depend on the side. */
static bool has_two_sides(const double x[N_PLANE])
{
    return x[P_LIMIT_START] == x[P_LIMIT_END] || is_at_limit(x);
}

/* Return mapping of one slider with its rate, on the side to which `direction` points. */
static MappingRate return_map_rate(double x[2 * N_PLANE - P_RETENTION], const double direction[N_PLANE - P_RETENTION],
                                   bool *corner)
{
    MappingRate mapping;
    const double u = elastic_predictor(x, 0), v = elastic_predictor(x, 1), limit = x[P_LIMIT_END];
    const double predictor_rates[2] = {predictor_rate(x, x + N_PLANE, 0), predictor_rate(x, x + N_PLANE, 1)};
    const bool at_limit = is_at_limit(x);
    const double yield_rate = u * predictor_rate(x, direction, 0) + v * predictor_rate(x, direction, 1) -
                          limit * direction[P_LIMIT_END - P_RETENTION];
    const double limit_factor = at_limit ? 1.0 - 2.0 * LIMIT_ROUND_OFF : 1.0;
    const double limit_growth_rate = direction[P_LIMIT_END - P_RETENTION] - direction[P_LIMIT_START - P_RETENTION];
    if (x[P_LIMIT_START] == limit && limit_growth_rate != 0.0) {
        x[P_LIMIT_START] *= 1.0 - copysign(LIMIT_PERTURBATION, limit_growth_rate);
        *corner = *corner || u * u + v * v > limit * limit;
    }
    for (int k = P_LIMIT_START; k <= P_LIMIT_END; k++) {
        x[k] *= limit_factor;
        x[k + N_PLANE - P_RETENTION] *= limit_factor;
    }
    return_map_2d(x, NULL, mapping.at);
    return_map_2d_seed(x, NULL, mapping.rate);
    *corner = *corner || (at_limit && yield_rate != 0.0);
    if (at_limit && !(yield_rate > 0.0)) { /* it sticks; its tangent stays that of a slider that slips */
        mapping.rate[0] = predictor_rates[0];
        mapping.rate[1] = predictor_rates[1];
        mapping.rate[MAPPING_LOSS] = mapping.rate[MAPPING_SLIP] = 0.0;
    }
    return mapping;
}

/* Rates of the arguments of `return_map_2d` for slider k: rates of retention and secant stiffness, of the displacement
 * over a fraction [1] of the increment, of the limits at its start and end, and of the stiffness K. */
static void argument_rates(const Foundation *f, int k, const double factor_rates[2], const IncrementRate *rates,
                           double fraction, const double limits[2], double K_rate, double per_K,
                           double out[N_PLANE - P_RETENTION])
{
    const double all[] = {factor_rates[0],
                          factor_rates[1],
                          fraction * slider_displacement(f->torsion_directions, k, rates->displacement, 0),
                          fraction * slider_displacement(f->torsion_directions, k, rates->displacement, 1),
                          limits[0],
                          limits[1],
                          K_rate,
                          -K_rate * per_K * per_K};
    memcpy(out, all, sizeof all);
}

/* Properties of a range at both ends of a fraction of an increment; factors of the elastic predictor (retention, secant
 * stiffness) for this fraction; and their rates. */
typedef struct {
    PropertiesRate start, end;
    double factors[2], factor_rates[2];
} SecantRate;

static SecantRate secant_rate(const Foundation *f, int i, const SideRates *c, const PatchState *from,
                              const PatchState *at, double fraction, const IncrementRate *rates)
{
    const double change = at->approach - from->approach;
    const double approach_change_rate = fraction * (rates->ends[1] - rates->ends[0]);
    const double rise_rate = c->direction->ends[1] - c->direction->ends[0];
    const double bend = change != 0.0 ? (c->path->end->y[2] - c->path->start->y[2]) /
                                            (c->path->end->approach - c->path->start->approach)
                                      : 0.0;
    double x[2 * N_RETENTION - 1];
    SecantRate g = {.end = properties_rate(f, i, at, rates->ends[0] + approach_change_rate, bend)};
    g.start = change != 0.0 || c->path->is_first ? properties_rate(f, i, from, rates->ends[0], bend)
                                                 : (PropertiesRate){.at = g.end.at};
    retention_arguments(f, i, c->path, &g.start.at, &g.end.at, at, x);
    if (change == 0.0 && rise_rate != 0.0) { /* springs that lift off take their force with them */
        x[X_APPROACH_CHANGE] = copysign(DBL_MIN, rise_rate);
        *c->corner = true;
    }
    set_range_ends(f, &g.start.rate, &g.end.rate, approach_change_rate, x + N_RETENTION - 1);
    retention_and_stiffness(x, NULL, g.factors);
    retention_and_stiffness_seed(x, NULL, g.factor_rates);
    return g;
}

/* Return mapping of one slider of a range over a fraction [1] of an increment, with its rate. */
static MappingRate range_slider_rate(const Foundation *f, const SideRates *c, int i, const PatchState *from,
                                     const PatchState *at, double fraction, int late, const SecantRate *own)
{
    const int k = 2 * i + late;
    const double K = own->end.at.K, per_K = K > 0.0 ? 1.0 / K : 0.0;
    const double *shift = c->path->displacement;
    double x[2 * N_PLANE - P_RETENTION] = {c->path->force[0][k],
                                           c->path->force[1][k],
                                           own->factors[0],
                                           own->factors[1],
                                           fraction * slider_displacement(f->torsion_directions, k, shift, 0),
                                           fraction * slider_displacement(f->torsion_directions, k, shift, 1),
                                           own->start.at.limit[late],
                                           own->end.at.limit[late],
                                           K,
                                           per_K};
    double ahead_rates[N_PLANE - P_RETENTION] = {0.0};
    const double limits[2] = {own->start.rate.limit[late], own->end.rate.limit[late]};
    argument_rates(f, k, own->factor_rates, c->rates, fraction, limits, own->end.rate.K, per_K, x + N_PLANE);
    if (has_two_sides(x)) {
        const SecantRate direction = secant_rate(f, i, c, from, at, fraction, c->direction);
        const double ahead[2] = {direction.start.rate.limit[late], direction.end.rate.limit[late]};
        argument_rates(f, k, direction.factor_rates, c->direction, fraction, ahead, direction.end.rate.K, per_K,
                       ahead_rates);
    }
    return return_map_rate(x, ahead_rates, c->corner);
}

/* Dissipated energy over the elastic energy at the start [1] below which it is round-off. */
static const double LOSS_ROUND_OFF = 1e-13;

/* Rate of the energy dissipated by a slider whose stiffness changes; without loss the rate cannot be negative. */
static double loss_rate(const SideRates *c, double x[2 * N_VARYING_LOSS - 3])
{
    double loss, more, rate, is_along_x = c->rates->ends[1] * c->direction->ends[1];
    for (int d = 0; d < 3; d++)
        is_along_x += c->rates->displacement[d] * c->direction->displacement[d];
    varying_stiffness_loss(x, NULL, &loss);
    x[C_STIFFNESS_START] *= 1.0 - LOSS_ROUND_OFF; /* a little more energy before: a smaller loss is round-off */
    varying_stiffness_loss(x, NULL, &more);
    varying_stiffness_loss_seed(x, NULL, &rate);
    if (loss > 0.5 * more)
        return rate;
    *c->corner = *c->corner || rate != 0.0;
    return is_along_x < 0.0 ? fmin(rate, 0.0) : fmax(rate, 0.0);
}

/* Rates of the sliders of a range in partial contact, on one side of a path; start, end and middle are given. */
static void partial_range_rate(const Foundation *f, int i, const SideRates *c, const PatchState *from,
                               const PatchState *to, const PatchState *middle, SliderUpdate *rate)
{
    const PatchIncrement *path = c->path;
    const PatchState *points[2] = {to, middle};
    const bool contact_changes = !keeps_contact_state(i, path->start, to);
    SecantRate own[2];
    MappingRate mapping[2][2] = {{{{0.0}, {0.0}}}};
    for (int at = 0; at < (contact_changes ? 2 : 1); at++) {
        const double fraction = at > 0 ? 0.5 : 1.0;
        own[at] = secant_rate(f, i, c, from, points[at], fraction, c->rates);
        for (int late = 0; late < 2; late++)
            mapping[at][late] = range_slider_rate(f, c, i, from, points[at], fraction, late, &own[at]);
    }
    if (to->approach == f->height[i]) { /* springs without load: no force is left, and it grows by second order */
        memset(mapping[0], 0, sizeof mapping[0]);
        own->end.rate.K = 0.0;
    }
    const PropertiesRate *start = &own->start, *last = &own->end;
    for (int late = 0; late < 2; late++) {
        const MappingRate *end = &mapping[0][late], *half = &mapping[1][late];
        const double *force_end = end->at;
        const int k = 2 * i + late;
        double shift[2], rated[2], dy[N_MAPPING];
        memcpy(dy, end->rate, sizeof dy);
        for (int d = 0; d < 2; d++) {
            shift[d] = slider_displacement(f->torsion_directions, k, path->displacement, d);
            rated[d] = slider_displacement(f->torsion_directions, k, c->rates->displacement, d);
        }
        double x[] = {contact_changes,
                      path->force[0][k],
                      path->force[1][k],
                      force_end[0],
                      force_end[1],
                      shift[0],
                      shift[1],
                      start->at.K,
                      last->at.K,
                      force_end[MAPPING_SLIP],
                      half->at[0],
                      half->at[1],
                      dy[0],
                      dy[1],
                      rated[0],
                      rated[1],
                      start->rate.K,
                      last->rate.K,
                      dy[MAPPING_SLIP],
                      half->rate[0],
                      half->rate[1]};
        if (start->at.K != last->at.K || start->rate.K != last->rate.K)
            dy[MAPPING_LOSS] = loss_rate(c, x);
        add_slider(dy, f->torsion_directions[0][k], f->torsion_directions[1][k], rate);
    }
}

/* Rates of stiffness and limit of the sliders. */
typedef struct {
    double K[FOUNDATION_SLIDER_COUNT], limit[FOUNDATION_SLIDER_COUNT];
} SliderRate;

/* Rates of the heights with the onset approach, see `slider_heights` and `heights_after_liftoff`. */
static void slider_height_rates(const Foundation *f, double rate, double height[N_HEIGHTS])
{
    const double end = f->curve->end.y;
    double y[2];
    curve_evaluate(f->curve, f->onset_approach, 1, y);
    const bool follow = y[0] > MIN_REFERENCE_LOAD_OVER_END_LOAD * end && y[0] < MAX_REFERENCE_LOAD_OVER_END_LOAD * end;
    memset(height, 0, N_HEIGHTS * sizeof *height);
    /* below, heights at fixed ratios of the load; above, at equal steps of its logarithm */
    for (int i = 1; i < N_HEIGHTS - 1 && follow; i++) {
        const double position = i > HEIGHTS_BELOW_REFERENCE ? fmax(i - 2 - HEIGHTS_BELOW_REFERENCE + f->offset, 0.0) /
                                                              (double)HEIGHTS_ABOVE_REFERENCE
                                                        : 0.0;
        const double load = f->load[i] / y[0] * (1.0 - position * position) * y[1] * rate;
        height[i] = f->stiffness[i] > 0.0 ? load / f->stiffness[i] : 0.0;
    }
    if (follow)
        height[HEIGHTS_BELOW_REFERENCE + 1] = rate;
    if (f->liftoff_height > 0)
        height[f->liftoff_height] = rate;
}

/* Rates of the first n ranges, in full contact at the onset approach. */
static void full_range_rates(const Foundation *f, int n, double approach, double rate, SliderRate *out)
{
    double height[N_HEIGHTS], stiffness[N_HEIGHTS];
    slider_height_rates(f, rate, height);
    for (int i = 0; i < N_HEIGHTS; i++) {
        double y[3];
        curve_evaluate(f->curve, f->height[i], 2, y);
        stiffness[i] = y[2] * height[i];
    }
    for (int i = 0; i < n; i++) {
        const double width = f->height[i + 1] - f->height[i], left = f->height[i + 1] - approach;
        const double springs = stiffness[i + 1] - stiffness[i];
        const double normal = (f->stiffness[i + 1] - f->stiffness[i]) * height[i + 1] - stiffness[i] * width;
        const double opened =
            f->force_deviation[i] < f->normal_force[i]
                ? UNIFORM_DISTRIBUTION_DEVIATION *
                      (springs * width + f->normal_stiffness[i] * (height[i + 1] - height[i]))
                : normal;
        for (int late = 0; late < 2; late++) {
            out->K[2 * i + late] = 0.5 * f->ratio * springs;
            out->limit[2 * i + late] = 0.5 * f->mu * (normal + (late ? opened : -opened) - springs * left -
                                                      f->normal_stiffness[i] * (height[i + 1] - rate));
        }
    }
}

/* Add rates of the first n sliders, of ranges in full contact. */
static void add_full_range_rates(const Foundation *f, int n, const SideRates *c, SliderUpdate *rate)
{
    const PatchIncrement *path = c->path;
    const double grown = f->mu / f->ratio, from = grown * path->start->approach, to = grown * path->end->approach;
    const double *rate_ends = c->rates->ends, *direction_ends = c->direction->ends;
    SliderRate own, ahead;
    bool found = false;
    if (path->is_first)
        full_range_rates(f, n / 2, path->end->approach, rate_ends[1], &own);
    for (int k = 0; k < n; k++) {
        const double K = f->K[k], per_K = f->per_K[k], before = limit_at_growth(f->limit_at_zero_approach[k], K, from),
                     after = limit_at_growth(f->limit_at_zero_approach[k], K, to);
        double x[2 * N_PLANE - P_RETENTION] = {path->force[0][k],
                                               path->force[1][k],
                                               1.0,
                                               K,
                                               slider_displacement(f->torsion_directions, k, path->displacement, 0),
                                               slider_displacement(f->torsion_directions, k, path->displacement, 1),
                                               before,
                                               after,
                                               K,
                                               per_K};
        double ahead_rates[N_PLANE - P_RETENTION] = {0.0};
        const double limits[2] = {path->is_first ? own.limit[k] : grown * K * rate_ends[0],
                                  path->is_first ? own.limit[k] : grown * K * rate_ends[1]};
        const double stiffer = path->is_first ? own.K[k] : 0.0, factor_rates[2] = {0.0, stiffer};
        argument_rates(f, k, factor_rates, c->rates, 1.0, limits, stiffer, per_K, x + N_PLANE);
        const double u = elastic_predictor(x, 0), v = elastic_predictor(x, 1),
                     slip_threshold = (1.0 - 2.0 * LIMIT_ROUND_OFF) * after;
        double dy[N_MAPPING] = {K * x[N_PLANE + 2] + stiffer * x[P_DISPLACEMENT],
                                K * x[N_PLANE + 3] + stiffer * x[P_DISPLACEMENT + 1], stiffer, 0.0, stiffer};
        if (u * u + v * v >= slip_threshold * slip_threshold) {
            const bool sides =
                path->is_first ? is_at_limit(x) : has_two_sides(x); /* both limits of a first increment are equal */
            if (sides && path->is_first && !found)
                full_range_rates(f, n / 2, path->end->approach, direction_ends[1], &ahead);
            found = found || sides;
            if (sides) {
                const double next[2] = {path->is_first ? ahead.limit[k] : grown * K * direction_ends[0],
                                        path->is_first ? ahead.limit[k] : grown * K * direction_ends[1]};
                const double stiff = path->is_first ? ahead.K[k] : 0.0, factor_rates_ahead[2] = {0.0, stiff};
                argument_rates(f, k, factor_rates_ahead, c->direction, 1.0, next, stiff, per_K, ahead_rates);
            }
            const MappingRate mapping = return_map_rate(x, ahead_rates, c->corner);
            memcpy(dy, mapping.rate, sizeof dy);
        }
        add_slider(dy, f->torsion_directions[0][k], f->torsion_directions[1][k], rate);
    }
}

/* Rates of a range i > 0 whose springs begin to touch beyond the end of a path. The limits of its sliders are of second
 * order, and no force is left in them. If the displacement is larger than the increase of the load lets stick, the
 * sliders slip along the displacement, and are stiff across it only. If the load falls to the height, they slip along
 * the sum of the displacement and the part of their force that they keep. Without displacement, each slider behaves as
 * its neighbour of the range below: it slips if the neighbour is at its limit. */
static void add_contact_onset_rate(const Foundation *f, int i, const SideRates *c, const PatchState *from,
                                   const PatchState *to, SliderUpdate *rate)
{
    const PatchIncrement *path = c->path;
    const bool is_undisplaced =
        path->displacement[0] == 0.0 && path->displacement[1] == 0.0 && path->displacement[2] == 0.0;
    const double K = properties_rate(f, i, to, c->rates->ends[1], 0.0).rate.K;
    const double change = to->approach - from->approach;
    const SliderProperties below = slider_properties(f, i - 1, to), start = slider_properties(f, i, from);
    const bool lifts_off = change < 0.0 && start.K > 0.0, follows_neighbour = is_undisplaced && !lifts_off;
    for (int late = 0; late < 2; late++) {
        const int at = 2 * i + late, k = follows_neighbour ? at - 2 : at;
        const double stick_displacement = f->mu / f->ratio * fmax(change, 0.0) *
                              (late ? 1.0 + 2.0 * UNIFORM_DISTRIBUTION_DEVIATION
                                    : 1.0 - 2.0 * UNIFORM_DISTRIBUTION_DEVIATION);
        const double slip_threshold =
            follows_neighbour ? (1.0 - 2.0 * LIMIT_ROUND_OFF) * below.limit[late] : stick_displacement;
        double slip_direction[2];
        for (int d = 0; d < 2; d++) {
            const double shift = slider_displacement(f->torsion_directions, k, path->displacement, d),
                         force = path->force[d][k];
            slip_direction[d] = lifts_off ? force / start.K + shift : follows_neighbour ? force : shift;
        }
        const double u = slip_direction[0], v = slip_direction[1], square = u * u + v * v;
        const double K_per_square = square > slip_threshold * slip_threshold ? K / square : 0.0;
        const double dy[N_MAPPING] = {0.0, 0.0, K - K_per_square * u * u, -K_per_square * u * v,
                                      K - K_per_square * v * v};
        add_slider(dy, f->torsion_directions[0][at], f->torsion_directions[1][at], rate);
    }
}

bool foundation_rates(const Foundation *f, const PatchIncrement *path, const IncrementRate *direction,
                      const IncrementRate *rates, SliderUpdate *rate)
{
    bool corner = false;
    const SideRates path_side = {path, direction, rates, &corner};
    const bool is_constant_approach = path->start->approach == path->end->approach;
    *rate = (SliderUpdate){.loss = 0.0};
    const PatchState to = path->is_first ? *path->end : state_beside(f, path->end, direction->ends[1], &corner);
    const PatchState from = is_constant_approach ? to : *path->start;
    const int full = from.full_ranges < to.full_ranges ? from.full_ranges : to.full_ranges;
    const bool enters = to.touched_ranges > to.full_ranges && to.approach == f->height[to.full_ranges];
    const int touched = from.touched_ranges > to.touched_ranges ? from.touched_ranges : to.touched_ranges;
    add_full_range_rates(f, 2 * full, &path_side, rate);
    if (touched == full)
        return corner;
    MiddleState found = {.known = false};
    const PatchState middle = is_constant_approach ? to : *middle_state(f, path, &found);
    for (int i = full; i < touched; i++) {
        const bool is_onset = to.approach == f->height[i];
        if (!is_onset || from.approach > to.approach)
            partial_range_rate(f, i, &path_side, &from, &to, &middle, rate);
        if (is_onset && enters && i > 0)
            add_contact_onset_rate(f, i, &path_side, &from, &to, rate);
    }
    return corner;
}

END_OPTIMIZE_FOR_SIZE
