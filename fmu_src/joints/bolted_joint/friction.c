#include "friction.h"

#include <math.h>
#include <string.h>

#include "optimize_for_size.h"

_Static_assert((int)HISTORY_NORMAL == (int)HISTORY_FORCE + MAX_PATCHES * 2 * FOUNDATION_SLIDER_COUNT,
               "room for all patches");

/* Slider forces of patch j along x in a history; those along y follow. */
enum { PATCH_FORCES = 2 * FOUNDATION_SLIDER_COUNT };

static inline const double *forces_of(const double *history, int j)
{
    return history + HISTORY_FORCE + j * PATCH_FORCES;
}

/* Set the heights of a patch, unless they are set already; find the ranges in contact of its states again. */
static void set_heights(Friction *friction, int j, double onset_approach, double min_approach)
{
    Foundation *f = &friction->foundation[j];
    if (f->onset_approach == onset_approach && f->min_approach == min_approach)
        return;
    if (f->onset_approach != onset_approach)
        foundation_set_heights(f, onset_approach);
    heights_after_liftoff(f, min_approach);
    find_ranges(f, &friction->start[j]);
    find_ranges(f, &friction->end[j]);
}

/* Heights of a patch for an update that starts at an approach. */
static void set_patch_heights(Friction *friction, int j, const double *history, double start)
{
    const bool is_onset = history[HISTORY_STATE] < (double)SLIP_1D;
    const double min_approach = history[HISTORY_MIN_APPROACH + j];
    const bool was_open = min_approach < friction->foundation[j].curve->start.x;
    set_heights(friction, j, is_onset ? start : history[HISTORY_ONSET_APPROACH + j],
                is_onset || was_open ? start : fmin(min_approach, start));
}

/* States of the patches at both ends of their increments; without a known state the increment has no change of
 * approach. States are kept where they are still right. */
static void find_states(Friction *friction, const Contact *contact, const double *history)
{
    const bool is_known = history[HISTORY_STATE] != (double)BEFORE_FIRST_STEP;
    for (int j = 0; j < n_patches(); j++) {
        PatchState *first = &friction->start[j], *last = &friction->end[j];
        const double end = contact->patch_approach[j];
        const double start = is_known ? history[HISTORY_APPROACH + j] : end;
        if (friction->state != FULL_STICK)
            set_patch_heights(friction, j, history, start);
        const Foundation *f = &friction->foundation[j];
        if (first->approach != start)
            *first = last->approach == start ? *last : patch_state(f, start, first->full_ranges);
        if (last->approach != end)
            *last = first->approach == end ? *first : patch_state(f, end, last->full_ranges);
    }
}

void set_increments(Friction *friction, const Bodies *bodies, const double *history, const double *q)
{
    const double rotation = q[THETA_Z] - history[HISTORY_TANGENTIAL + 2];
    NOT_VECTORIZED
    for (int j = 0; j < n_patches(); j++) {
        const double *patch = data.patches[j];
        const double *modal = bodies->state.patch_displacement[j], *before = bodies->start_displacement[j];
        double *u = friction->increment[j];
        u[0] = q[S_X] - history[HISTORY_TANGENTIAL] - rotation * patch[POSITION_Y] + (modal[0] - before[0]);
        u[1] = q[S_Y] - history[HISTORY_TANGENTIAL + 1] + rotation * patch[POSITION_X] + (modal[1] - before[1]);
        u[2] = rotation * patch[RADIUS] + (modal[2] - before[2]);
    }
}

static inline PatchIncrement increment_of(const Friction *friction, int j, const double *history)
{
    const bool leaves_stick = friction->state != FULL_STICK && history[HISTORY_STATE] < (double)SLIP_1D;
    const double *force = leaves_stick ? friction->stick_force[j][0] : forces_of(history, j);
    const double *u = friction->increment[j];
    return (PatchIncrement){.force = {force, force + FOUNDATION_SLIDER_COUNT},
                            .start = &friction->start[j],
                            .end = &friction->end[j],
                            .displacement = {u[0], u[1], u[2]},
                            .is_1d = friction->state < SLIP_2D};
}

/* State after an increment that leaves full stick: SLIP_1D as long as all moves and forces are along x. */
static int slip_state(const double *history, const double *q)
{
    bool is_1d = !ELASTIC && history[HISTORY_STATE] != (double)SLIP_2D && q[S_Y] == history[HISTORY_TANGENTIAL + 1] &&
                 q[THETA_Z] == history[HISTORY_TANGENTIAL + 2];
    for (int j = 0; j < n_patches() && is_1d; j++) {
        const double *force_y = forces_of(history, j) + FOUNDATION_SLIDER_COUNT;
        is_1d = force_y[0] == 0.0 && force_y[1] == 0.0;
    }
    return is_1d ? SLIP_1D : SLIP_2D;
}

/* Traction of a patch in full stick, along x, along y and around its centre. */
static inline void full_stick_force(const double *history, int j, double traction[3])
{
    const double *force = forces_of(history, j);
    traction[0] = force[0];
    traction[1] = force[FOUNDATION_SLIDER_COUNT];
    traction[2] = force[FOUNDATION_SLIDER_COUNT + 1];
}

/* Update all patches in full stick; false: a patch moves more than FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT allows. */
static bool update_full_stick(Friction *friction, const Contact *contact, const double *history)
{
    bool sticks = history[HISTORY_STATE] < (double)SLIP_1D;
    if (sticks) {
        friction->state = FULL_STICK;
        find_states(friction, contact, history);
    }
    for (int j = 0; j < n_patches() && sticks; j++) {
        const PatchIncrement increment = increment_of(friction, j, history);
        double before[3];
        full_stick_force(history, j, before);
        sticks = full_stick_update(&friction->foundation[j], &increment, before, &friction->update[j]);
    }
    return sticks;
}

/* State of the update, with its results in full stick, else with the states of the patches. */
static void begin_update(Friction *friction, const Contact *contact, const double *history, const double *q)
{
    if (update_full_stick(friction, contact, history))
        return;
    friction->state = slip_state(history, q);
    find_states(friction, contact, history);
    for (int j = 0; j < n_patches() && history[HISTORY_STATE] < (double)SLIP_1D; j++) {
        double *const force[2] = {friction->stick_force[j][0], friction->stick_force[j][1]}, before[3];
        full_stick_force(history, j, before);
        distribute_stick_force(&friction->foundation[j], &friction->start[j], before, force);
    }
}

void update_traction(Friction *friction, const Contact *contact, const double *history, const double *q)
{
    double *const force[2] = {friction->trial_force[0], friction->trial_force[1]};
    begin_update(friction, contact, history, q);
    friction->work.forces_only = true;
    for (int j = 0; j < n_patches() && friction->state != FULL_STICK; j++) {
        const PatchIncrement increment = increment_of(friction, j, history);
        foundation_advance(&friction->foundation[j], &increment, force, &friction->work, &friction->update[j]);
    }
    foundations_finish(&friction->work);
}

/* Return-map all sliders of a patch; results are known after `foundations_finish`. */
static void advance_patch(Friction *friction, int j, const double *history, double *const force[2])
{
    const PatchIncrement increment = increment_of(friction, j, history);
    const int n = 2 * touched_ranges_of(&increment), n_y = friction->state < SLIP_2D ? 0 : n;
    foundation_advance(&friction->foundation[j], &increment, force, &friction->work, &friction->update[j]);
    memset(force[0] + n, 0, (size_t)(FOUNDATION_SLIDER_COUNT - n) * sizeof *force[0]);
    memset(force[1] + n_y, 0, (size_t)(FOUNDATION_SLIDER_COUNT - n_y) * sizeof *force[1]);
}

static void store_full_stick_force(const SliderUpdate *update, double *const force[2])
{
    for (int d = 0; d < 2; d++) {
        memset(force[d], 0, FOUNDATION_SLIDER_COUNT * sizeof *force[d]);
        force[d][0] = update->traction[d];
    }
    force[1][1] = update->traction[2];
}

/* State, loss [J] and rigid displacement of a history. */
static void set_history(int state, double loss, const double rigid[3], double *after)
{
    after[HISTORY_STATE] = state;
    after[HISTORY_LOSS] = loss;
    memcpy(after + HISTORY_TANGENTIAL, rigid, 3 * sizeof *rigid);
}

void update_friction(Friction *friction, const Contact *contact, const double *history, const double *q, double *after)
{
    double loss = 0.0;
    begin_update(friction, contact, history, q);
    for (int j = 0; j < n_patches(); j++) {
        double *const along_x = after + HISTORY_FORCE + j * PATCH_FORCES;
        double *const force[2] = {along_x, along_x + FOUNDATION_SLIDER_COUNT};
        if (friction->state == FULL_STICK)
            store_full_stick_force(&friction->update[j], force);
        else
            advance_patch(friction, j, history, force);
    }
    foundations_finish(&friction->work);
    const bool sticks = friction->state == FULL_STICK;
    for (int j = 0; j < n_patches(); j++) {
        const double approach = friction->end[j].approach;
        const Foundation *f = &friction->foundation[j];
        loss += data.patches[j][SHARE] * friction->update[j].loss;
        after[HISTORY_ONSET_APPROACH + j] = sticks ? approach : f->onset_approach;
        after[HISTORY_MIN_APPROACH + j] = sticks ? approach : f->min_approach;
        after[HISTORY_APPROACH + j] = approach;
    }
    const double rigid[3] = {q[S_X], q[S_Y], q[THETA_Z]};
    set_history(friction->state, history[HISTORY_LOSS] + contact->area * loss, rigid, after);
}

void update_without_history(Friction *friction, const Contact *contact, const double *history, double *after)
{
    const double rigid[3] = {0.0};
    friction->state = FULL_STICK;
    find_states(friction, contact, history);
    set_history(BEFORE_FIRST_STEP, history[HISTORY_LOSS], rigid, after);
}

/* Tangents */

/* Stiffness of a patch as of `point_stiffness`, with the stiffness of its sliders around its centre. */
static inline void directional_stiffness(const double *patch, const double tangent[6], double stiffness[3])
{
    const double share = patch[SHARE], radius = patch[RADIUS];
    point_stiffness(patch, tangent, stiffness);
    stiffness[2] += share * (2.0 * radius * (patch[POSITION_X] * tangent[4] - patch[POSITION_Y] * tangent[3]) +
                             radius * radius * tangent[5]);
}

/* Stiffness against S_X, S_Y, THETA_Z: `stick` if all sliders stick; `decrease`, its decrease if all sliders at their
 * limits slip; `signed_decrease`, this decrease with the sign of the traction along the motion. */
typedef struct {
    double stick[3], decrease[3], signed_decrease[3];
} TangentSums;

/* Sums over all patches: of their stick stiffness and tangents, or of rates of these. */
static TangentSums sum_tangents(const Friction *friction, const double *stick_stiffness, const SliderUpdate *updates)
{
    TangentSums sums = {.stick = {0.0}};
    for (int j = 0; j < n_patches(); j++) {
        const double *patch = data.patches[j], *traction = friction->update[j].traction;
        const double x = patch[POSITION_X], y = patch[POSITION_Y];
        const double t[3] = {traction[0], traction[1],
                             x * traction[1] - y * traction[0] + patch[RADIUS] * traction[2]};
        double all[6], stick[3], decrease[3], tangent_decrease[6];
        stick_tangent(stick_stiffness[j], all);
        for (int d = 0; d < 6; d++)
            tangent_decrease[d] = all[d] - updates[j].tangent[d];
        directional_stiffness(patch, all, stick);
        directional_stiffness(patch, tangent_decrease, decrease);
        for (int d = 0; d < 3; d++) {
            sums.stick[d] += stick[d];
            sums.decrease[d] += decrease[d];
            sums.signed_decrease[d] += t[d] < 0.0 ? -decrease[d] : decrease[d];
        }
    }
    return sums;
}

/* Stiffness in the direction in which more sliders slip, which the signs of `traction_sum` tell; or its rate. */
static void weaker_direction(const TangentSums *sums, const double *traction_sum, double stiffness[3])
{
    for (int d = 0; d < 3; d++) {
        const double magnitude = traction_sum[d] < 0.0 ? -sums->signed_decrease[d] : sums->signed_decrease[d];
        stiffness[d] = sums->stick[d] - 0.5 * (sums->decrease[d] + magnitude);
    }
}

void continued_motion_stiffness(Friction *friction, double stiffness[3])
{
    double stick[MAX_PATCHES];
    NOT_VECTORIZED
    for (int j = 0; j < n_patches(); j++)
        stick[j] = stick_stiffness(&friction->foundation[j], &friction->end[j]);
    const TangentSums sums = sum_tangents(friction, stick, friction->update);
    memcpy(friction->traction_sum, sums.signed_decrease, sizeof sums.signed_decrease);
    weaker_direction(&sums, friction->traction_sum, stiffness);
}

OPTIMIZE_FOR_SIZE

void friction_tabulate(Friction *friction, const Contact *contact, bool use_avx)
{
    friction->work.batch.use_avx = use_avx;
    for (int j = 0; j < n_patches(); j++) {
        Foundation *f = &friction->foundation[j];
        f->curve = contact->curve;
        f->mu = friction->mu;
        f->ratio = friction->stiffness_ratio;
        f->torsion_directions[0] = data.torsion_directions[0];
        f->torsion_directions[1] = data.torsion_directions[1];
        f->offset = data.height_offsets[j][0];
        foundation_set_heights(f, 0.0);
        friction->start[j] = friction->end[j] = patch_state(f, f->curve->end.x, 0);
    }
}

void derivatives_of_tangent(const double t[6], TractionDerivatives derivatives)
{
    const TractionDerivatives rows = {{t[0], t[1], t[3]}, {t[1], t[2], t[4]}, {t[3], t[4], t[5]}};
    memcpy(derivatives, rows, sizeof rows);
}

void traction_derivatives(Friction *friction, double step, const double *history, TractionDerivatives *derivatives)
{
    double *const force[2] = {friction->trial_force[0], friction->trial_force[1]};
    for (int j = 0; j < n_patches(); j++) {
        if (friction->state == FULL_STICK) { /* the displacement is small, and with it the effect of the opening */
            derivatives_of_tangent(friction->update[j].tangent, derivatives[j]);
            continue;
        }
        const PatchIncrement increment = increment_of(friction, j, history);
        foundation_traction_derivatives(&friction->foundation[j], &increment, step, force, &friction->work,
                                        derivatives[j]);
    }
}

/* Rates */

void set_heights_from(Friction *friction, const double *history)
{
    for (int j = 0; j < n_patches(); j++)
        set_patch_heights(friction, j, history, friction->end[j].approach);
}

void increment_rates(const Friction *friction, const Contact *contact, const Bodies *bodies, const double *q_rate,
                     const double bolts[4], IncrementRate *rates)
{
    double points[MAX_POINTS], transferred[MAX_PATCHES], unused;
    for (int i = 0; i < n_points() && ELASTIC; i++)
        points[i] = contact->rate[i].derivatives[1] * contact->rate[i].approach;
    if (ELASTIC)
        transfer_pressure(contact, points, transferred);
    for (int j = 0; j < n_patches(); j++) {
        const double *patch = data.patches[j], stiffness = friction->end[j].y[1];
        const double *modal = bodies->rate.patch_displacement[j];
        double *rate = rates[j].displacement;
        rates[j].ends[0] = 0.0;
        rates[j].ends[1] =
            !ELASTIC ? preload_approach_rate(contact, patch, bolts, contact->preload.patch_approach[j], &unused) -
                           opening_at(patch, q_rate)
            : stiffness > 0.0 ? transferred[j] / stiffness
                              : 0.0;
        tangential_displacement(patch, q_rate, rate);
        for (int d = 0; d < 3; d++)
            rate[d] += modal[d];
    }
}

void set_direction(Friction *friction, const IncrementRate *rates)
{
    for (int j = 0; j < n_patches(); j++) {
        friction->direction[j].ends[1] = friction->side * rates[j].ends[1];
        for (int d = 0; d < 3; d++)
            friction->direction[j].displacement[d] = friction->side * rates[j].displacement[d];
    }
}

SliderUpdate update_rate(Friction *friction, int j, const double *history, const double *after, double approach_rate,
                         const double displacement_rate[3])
{
    const Foundation *f = &friction->foundation[j];
    const bool is_first = !after && history[HISTORY_STATE] == (double)BEFORE_FIRST_STEP;
    const IncrementRate rates = {{is_first ? approach_rate : 0.0, approach_rate},
                                 {displacement_rate[0], displacement_rate[1], displacement_rate[2]}};
    IncrementRate direction = friction->direction[j];
    direction.ends[0] = is_first ? direction.ends[1] : 0.0;
    PatchIncrement increment = increment_of(friction, j, history);
    SliderUpdate rate;
    bool is_corner;
    if (after) { /* a further motion from the end of the last update */
        const double *force = forces_of(after, j);
        increment = (PatchIncrement){
            .force = {force, force + FOUNDATION_SLIDER_COUNT}, .start = &friction->end[j], .end = &friction->end[j]};
    }
    if (friction->state == FULL_STICK) {
        double before[3];
        full_stick_force(after ? after : history, j, before);
        is_corner = full_stick_rates(f, &increment, before, &direction, &rates, &rate);
    } else {
        increment.is_first = is_first;
        is_corner = foundation_rates(f, &increment, &direction, &rates, &rate);
    }
    friction->is_corner = friction->is_corner || is_corner;
    return rate;
}

void update_rates(Friction *friction, const double *history, const double *after, const IncrementRate *rates)
{
    for (int j = 0; j < n_patches() && friction->has_history; j++)
        friction->rate[j] = update_rate(friction, j, history, after, rates[j].ends[1], rates[j].displacement);
}

void continued_motion_stiffness_rate(const Friction *friction, const IncrementRate *rates, double stiffness[3])
{
    double stick_rate[MAX_PATCHES];
    for (int j = 0; j < n_patches(); j++)
        stick_rate[j] = friction->stiffness_ratio * friction->end[j].y[2] * rates[j].ends[1];
    const TangentSums sums = sum_tangents(friction, stick_rate, friction->rate);
    weaker_direction(&sums, friction->traction_sum, stiffness);
}

END_OPTIMIZE_FOR_SIZE
