#include "equilibrium.h"

#include <math.h>
#include <string.h>

#include "optimize_for_size.h"

_Static_assert((int)HISTORY_MODAL_COORDINATES == (int)HISTORY_NORMAL + 3 &&
                   (int)HISTORY_TANGENT == (int)HISTORY_MODAL_COORDINATES + MODES &&
                   (int)N_HISTORY == (int)HISTORY_TANGENT + 6 * MAX_PATCHES,
               "the end of a history, as in the key of a predictor");

/* Derivatives of the patch opening: opening that changes the pressure of a patch as much as the points that transfer
 * pressure to it do. */
static void set_patch_opening_jacobian(Equilibrium *e)
{
    const Contact *contact = e->assembly.contact;
    for (int j = 0, row = 0; j < n_patches(); j++) {
        const double stiffness = e->assembly.friction->end[j].y[1],
                     compliance = stiffness > 0.0 ? 1.0 / stiffness : 0.0;
        double sum[N_COLUMNS] = {0.0};
        for (; row < contact->transfer_end[j]; row++) {
            const int i = data.pressure_transfer[row][TRANSFER_POINT];
            const double weight = contact->pressure_transfer[row] * contact->stiffness[i] * compliance;
            for (int k = 0; k < N_COLUMNS; k++)
                sum[k] += weight * e->assembly.bodies->full_opening_jacobian[i][k];
        }
        memcpy(e->patch_opening_jacobian[j], sum, sizeof sum);
    }
}

OPTIMIZE_FOR_SIZE

/* Straight path of q from the end of a history to the inputs. Preload, moment and temperature have their values at the
 * end from the start of the step on. */
typedef struct {
    const double *inputs, *history;
    double start[N_DISPLACEMENTS], end[N_DISPLACEMENTS];
    double *after;    /* history at the end, if the last trial is complete */
    bool is_complete; /* the last trial gave works, losses and history too */
} LoadStep;

typedef enum { CONVERGED, NOT_CONVERGED, REFUSED } NewtonResult;

/* Tangent stiffness and residual Jacobian: see equilibrium.py */

static inline void add_scaled(double factor, const double *restrict row, double *restrict sum)
{
    for (int k = 0; k < MODES; k++)
        sum[k] += factor * row[k];
}

/* Stiffness of points and bolts against modal coordinates and normal motions; the first `size` rows and columns. */
static void sum_normal_stiffness(Equilibrium *e, int size)
{
    const Bodies *bodies = e->assembly.bodies;
    const Contact *contact = e->assembly.contact;
    const Bolts *bolts = e->assembly.bolts;
    const int sizes[2] = {n_points(), (int)data.n_bolt_elongation};
    const double(*const rows[2])[N_COLUMNS] = {(const double(*)[N_COLUMNS])bodies->full_opening_jacobian,
                                               (const double(*)[N_COLUMNS])bodies->full_elongation_jacobian};
    memset(e->normal_stiffness, 0, sizeof e->normal_stiffness);
    for (int s = 0; s < 2; s++)
        for (int first = 0; first < sizes[s]; first += WEIGHTED_ROWS) {
            const int n = sizes[s] - first < WEIGHTED_ROWS ? sizes[s] - first : WEIGHTED_ROWS;
            double weights[WEIGHTED_ROWS];
            for (int i = 0, row = first; i < n; i++, row++)
                weights[i] = s == 0 ? contact->area * data.points[row][SHARE] * contact->stiffness[row]
                                    : bolts->stiffness * bolts->active_fraction[row];
            dense_weigh(bodies->use_avx, n, weights, rows[s] + first, e->weighted);
            dense_products(bodies->use_avx, n, (const double(*)[N_COLUMNS])e->weighted, rows[s] + first, size, false,
                           first > 0, e->normal_stiffness);
        }
}

/* Stiffness of the patches against modal coordinates and tangential motions, from the traction derivatives; all of it,
 * or its lower half. */
static void sum_shear_stiffness(Equilibrium *e, int size, bool all)
{
    const Bodies *bodies = e->assembly.bodies;
    const double area = e->assembly.contact->area;
    const int n = n_patches();
    const double(*rows[4])[N_COLUMNS] = {[3] = (const double(*)[N_COLUMNS])e->patch_opening_jacobian};
    double weights[MAX_PATCHES][4];
    for (int s = 0; s < 3; s++)
        rows[s] = (const double(*)[N_COLUMNS])bodies->full_tangential_jacobian[s];
    memset(e->shear_stiffness, 0, sizeof e->shear_stiffness);
    for (int d = 0; d < 3; d++) {
        for (int j = 0; j < n; j++)
            for (int s = 0; s < 4; s++)
                weights[j][s] = area * data.patches[j][SHARE] * e->derivatives[j][s][d];
        dense_combine(bodies->use_avx, n, (const double(*)[4])weights, rows, e->weighted);
        dense_products(bodies->use_avx, n, (const double(*)[N_COLUMNS])e->weighted, rows[d], size, all, false,
                       e->shear_stiffness);
    }
}

/* Factorize the residual Jacobian dr/da from the traction derivatives, up to a size with normal and tangential motions;
 * as it is, or as if it were symmetric. */
static void factorize_jacobian(Equilibrium *e, int size, bool all, Factorization *factors)
{
    double(*a)[MODES] = factors->a;
    sum_normal_stiffness(e, size);
    sum_shear_stiffness(e, size, all);
    for (int r = 0; r < MODES; r++) {
        for (int k = 0; k <= r; k++) {
            const double normal = e->normal_stiffness[r][k], shear = e->shear_stiffness[r][k];
            a[r][k] = normal + shear;
            a[k][r] = normal + (all ? e->shear_stiffness[k][r] : shear);
        }
        a[r][r] += e->assembly.bodies->stiffness[r];
    }
    dense_factor(e->assembly.bodies->use_avx, factors);
}

/* Residual Jacobian at the last trial; ranges of sliders whose contact changes are differentiated by differences. */
static void residual_jacobian(Equilibrium *e, const double *history)
{
    const Contact *contact = e->assembly.contact;
    const double first = contact->curve->start.x;
    double max_approach = -first; /* largest approach [m] at tightening, from first contact on */
    for (int j = 0; j < n_patches(); j++)
        max_approach = fmax(max_approach, contact->preload.patch_approach[j] - first);
    traction_derivatives(e->assembly.friction, TRACTION_FINITE_DIFFERENCE_STEP * max_approach, history, e->derivatives);
    set_patch_opening_jacobian(e);
    factorize_jacobian(e, MODES, true, &e->factors);
}

/* Residual Jacobian by derivatives of the slider rules, on the side of `friction->direction`; for a further motion if
 * the history after the load step is given. */
static void residual_jacobian_on_side(Equilibrium *e, const double *history, const double *after)
{
    static const double units[4][4] = {{0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}, {-1.0}};
    for (int j = 0; j < n_patches(); j++)
        for (int c = 0; c < 4; c++) {
            const SliderUpdate rate = update_rate(e->assembly.friction, j, history, after, units[c][0], units[c] + 1);
            memcpy(e->derivatives[j][c], rate.traction, sizeof e->derivatives[j][c]);
        }
    set_patch_opening_jacobian(e);
    factorize_jacobian(e, MODES, true, &e->factors);
}

/* Static condensation: derivatives of the modal coordinates by q, and the condensed stiffness (in Python it is in
 * compliances.py), from the stiffness of points and bolts and the friction tangents of the patches (6 numbers each). */
static void condense_stiffness(Equilibrium *e, const double *tangent, ModalPredictor *predictor)
{
    static const int columns[N_DISPLACEMENTS] = {0, 1, 0, 1, 2, 2}; /* of q in rows of the Jacobians */
    for (int j = 0; j < n_patches(); j++)
        derivatives_of_tangent(tangent + 6 * j, e->derivatives[j]);
    factorize_jacobian(e, N_COLUMNS, false, &predictor->factors);
    for (int d = 0; d < N_DISPLACEMENTS; d++) {
        const int at = MODES + columns[d];
        const double *h = d == S_X || d == S_Y || d == THETA_Z ? e->shear_stiffness[at] : e->normal_stiffness[at];
        double *z = predictor->modal_rates[d];
        for (int k = 0; k < MODES; k++)
            z[k] = -h[k];
        dense_solve(e->assembly.bodies->use_avx, &predictor->factors, z);
        e->condensed[d] = fmax(h[at] + dense_dot(h, z), 0.0); /* at least 0 despite round-off */
    }
    predictor->is_known = true;
}

/* Trials */

/* q at a step fraction [1]. */
static void displacement_at(const LoadStep *step, double step_fraction, double q[N_DISPLACEMENTS])
{
    memcpy(q, step->end, sizeof step->end);
    for (int d = 0; d < N_DISPLACEMENTS && step_fraction != 1.0; d++)
        q[d] = step->start[d] + step_fraction * (step->end[d] - step->start[d]);
}

/* Deformation, bolt forces, pressures and patch approaches at q and modal coordinates; the works too if complete. */
static bool evaluate_normal(Equilibrium *e, const double *q, const double *modal_coordinates, bool complete,
                            Text *reason)
{
    Bodies *bodies = e->assembly.bodies;
    for (int b = 0; b < (int)data.n_bolt_elongation; b++)
        elongate_bolt(e->assembly.bolts, b, bolt_elongation(bodies, b, q, modal_coordinates));
    deform(bodies, modal_coordinates, &bodies->state);
    if (!evaluate_points(e->assembly.contact, bodies->state.opening, q, complete, reason))
        return false;
    evaluate_patches(e->assembly.contact, bodies->state.opening, q);
    return true;
}

/* Trial: `evaluate_normal` and friction; complete: with works, losses and history. */
static bool evaluate_trial(Equilibrium *e, LoadStep *step, const double *q, const double *modal_coordinates,
                           bool complete, Text *reason)
{
    step->is_complete = complete;
    if (!evaluate_normal(e, q, modal_coordinates, complete, reason))
        return false;
    set_increments(e->assembly.friction, e->assembly.bodies, step->history, q);
    if (complete)
        update_friction(e->assembly.friction, e->assembly.contact, step->history, q, step->after);
    else
        update_traction(e->assembly.friction, e->assembly.contact, step->history, q);
    return true;
}

/* Residual r [N] of the modal coordinates at the last trial; returns its tolerance [N]. */
static double residual(const Equilibrium *e, const double *q, const double *modal_coordinates, double *r)
{
    const Bodies *bodies = e->assembly.bodies;
    const Contact *contact = e->assembly.contact;
    const Bolts *bolts = e->assembly.bolts;
    const bool use_avx = bodies->use_avx;
    double forces = 0.0, stiffness = 0.0, opening = 0.0;
    double normal[MAX_OPENING], shear[3][MAX_PATCHES], bolt_force[MAX_BOLT_ELONGATION];
    for (int k = 0; k < MODES; k++)
        r[k] = bodies->stiffness[k] * modal_coordinates[k];
    for (int i = 0; i < n_points(); i++) {
        const double area = contact->area * data.points[i][SHARE];
        const double p = contact->pressure[i], preload = contact->preload.pressure[i];
        const double rigid = fabs(opening_at(data.points[i], q));
        normal[i] = -area * (p - preload);
        forces += area * (p + preload);
        stiffness += area * contact->stiffness[i];
        opening = rigid > opening ? rigid : opening;
    }
    for (int j = 0; j < n_patches(); j++) {
        const double area = contact->area * data.patches[j][SHARE];
        for (int d = 0; d < 3; d++) {
            shear[d][j] = area * e->assembly.friction->update[j].traction[d];
            forces += fabs(shear[d][j]);
        }
    }
    for (int b = 0; b < (int)data.n_bolt_elongation; b++) {
        bolt_force[b] = bolts->stiffness * (bolt_elongation(bodies, b, q, modal_coordinates) + bolts->gap[b]);
        forces += fabs(bolt_force[b]);
    }
    dense_add_rows(use_avx, n_points(), normal, (const double(*)[N_COLUMNS])bodies->full_opening_jacobian, r);
    for (int d = 0; d < 3; d++)
        dense_add_rows(use_avx, n_patches(), shear[d], (const double(*)[N_COLUMNS])bodies->full_tangential_jacobian[d],
                       r);
    dense_add_rows(use_avx, (int)data.n_bolt_elongation, bolt_force,
                   (const double(*)[N_COLUMNS])bodies->full_elongation_jacobian, r);
    return RELATIVE_RESIDUAL_TOLERANCE *
           (forces + stiffness * opening * RIGID_OPENING_WEIGHT_IN_TOLERANCE +
            contact->area * contact->law.closing_end_pressure);
}

/* Largest component [N], or a component that is not a number. */
static double residual_norm(const double *r)
{
    double largest = 0.0;
    for (int k = 0; k < MODES; k++)
        largest = fabs(r[k]) > largest || !(r[k] == r[k]) ? fabs(r[k]) : largest;
    return largest;
}

/* Newton's method */

/* What the predictor depends on: preload, moment, and a history. */
static void predictor_key(const PreloadState *preload, const double *history, double key[PREDICTOR_KEY])
{
    key[0] = preload->preload;
    key[1] = preload->moment;
    memcpy(key + 2, history + HISTORY_TANGENTIAL, 3 * sizeof *key);
    memcpy(key + 5, history + HISTORY_NORMAL, (PREDICTOR_KEY - 5) * sizeof *key);
}

/* Change of the modal coordinates over a load step [m] by the tangent stiffness at its start. */
static bool predict_by_tangent(Equilibrium *e, const LoadStep *step, double *rate, Text *reason)
{
    const double *history = step->history;
    double key[PREDICTOR_KEY], first[N_DISPLACEMENTS];
    predictor_key(&e->assembly.contact->preload, history, key);
    displacement_at(step, 0.0, first);
    if (e->end.is_known && memcmp(key, e->end.key, sizeof key) == 0) {
        e->start = e->end;
    } else if (!e->start.is_known || memcmp(key, e->start.key, sizeof key) != 0) {
        double tangent[6 * MAX_PATCHES];
        if (!evaluate_normal(e, first, history + HISTORY_MODAL_COORDINATES, false, reason))
            return false;
        memcpy(tangent, history + HISTORY_TANGENT, sizeof tangent);
        for (int j = 0; j < n_patches() && history[HISTORY_STATE] == (double)BEFORE_FIRST_STEP; j++) {
            const Foundation *f = &e->assembly.friction->foundation[j];
            const PatchState state = patch_state(f, e->assembly.contact->preload.patch_approach[j], 0);
            stick_tangent(stick_stiffness(f, &state), tangent + 6 * j);
        }
        condense_stiffness(e, tangent, &e->start);
        memcpy(e->start.key, key, sizeof key);
    }
    memset(rate, 0, MODES * sizeof *rate);
    for (int d = 0; d < N_DISPLACEMENTS; d++)
        add_scaled(step->end[d] - first[d], e->start.modal_rates[d], rate);
    return true;
}

/* Apply Broyden's good update by the corrections since the Jacobian to the newest one. */
static void apply_broyden(Equilibrium *e, int newest)
{
    double(*corrections)[MODES] = e->corrections, *squares = e->squares;
    double *correction = corrections[newest];
    for (int i = 0; i + 1 < newest; i++)
        add_scaled(dense_dot(corrections[i], correction) / squares[i], corrections[i + 1], correction);
    if (newest > 0) {
        const double factor = 1.0 / (1.0 - dense_dot(corrections[newest - 1], correction) / squares[newest - 1]);
        for (int k = 0; k < MODES; k++)
            correction[k] *= factor;
    }
    squares[newest] = dense_dot(correction, correction);
}

/* Trial after a correction of the modal coordinates. While the energy slope at its end is too large, the correction is
 * shortened; after MAX_LINE_SEARCH_TRIALS the last trial is taken, though it is too long. The correction is dropped if
 * the Jacobian belongs to an earlier trial. false: refused. */
static bool search_line(Equilibrium *e, LoadStep *step, const double *q, const double *correction,
                        bool jacobian_is_current, bool complete, double *modal_coordinates, double *r,
                        double *tolerance, bool *is_full, Text *reason)
{
    double start[MODES], length = 1.0;
    const double energy_slope_0 = dense_dot(r, correction);
    memcpy(start, modal_coordinates, sizeof start);
    *is_full = true;
    for (int trial = 0; trial < MAX_LINE_SEARCH_TRIALS; trial++) {
        for (int k = 0; k < MODES; k++)
            modal_coordinates[k] = start[k] + length * correction[k];
        if (!evaluate_trial(e, step, q, modal_coordinates, complete, reason))
            return false;
        *tolerance = residual(e, q, modal_coordinates, r);
        const double energy_slope_1 = dense_dot(r, correction);
        if (length == 0.0 || !(energy_slope_1 > MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE * fabs(energy_slope_0)))
            return true;
        /* length at which the energy slope is zero, if any */
        const double zero = energy_slope_0 < 0.0 ? energy_slope_0 / (energy_slope_0 - energy_slope_1) : 0.0;
        length *= jacobian_is_current ? fmax(zero, MIN_SHORTENING_FACTOR) : 0.0;
        *is_full = false;
    }
    return true;
}

/* Equilibrium at a step fraction, starting from modal coordinates; `remaining_norm` [N]: largest entry of the
 * residual, if none is found. */
static NewtonResult solve_newton(Equilibrium *e, LoadStep *step, double step_fraction, double *modal_coordinates,
                                 double *remaining_norm, Text *reason)
{
    const double tolerance_factor = step_fraction == 1.0 ? 1.0 : INTERMEDIATE_TOLERANCE_FACTOR;
    const Factorization *factors = &e->start.factors; /* first Jacobian: at the start of the load step */
    double q[N_DISPLACEMENTS], r[MODES], tolerance;
    double last_norm = INFINITY; /* the first iteration uses the given Jacobian */
    bool jacobian_is_current = false, is_full;
    displacement_at(step, step_fraction, q);
    if (!evaluate_trial(e, step, q, modal_coordinates, false, reason))
        return REFUSED;
    tolerance = residual(e, q, modal_coordinates, r);
    for (int n = 0, corrections = 0; n < MAX_NEWTON_ITERATIONS; n++) {
        const double norm = residual_norm(r);
        if (norm <= tolerance_factor * tolerance)
            return CONVERGED;
        if (!(norm < MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE * last_norm)) { /* also if the residual is not a number */
            residual_jacobian(e, step->history);
            factors = &e->factors;
            corrections = 0;
            jacobian_is_current = true;
        }
        /* Whether this correction is expected to end the load step: its trial then computes works, losses and
         * history, too, which saves an evaluation. Python has no such case. */
        const bool is_last = step_fraction == 1.0 && n > 0 &&
                             norm < MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE * last_norm &&
                             norm * norm < last_norm * tolerance; /* by its order of convergence */
        double *correction = e->corrections[corrections];
        for (int k = 0; k < MODES; k++)
            correction[k] = -r[k];
        dense_solve(e->assembly.bodies->use_avx, factors, correction);
        apply_broyden(e, corrections++);
        if (!search_line(e, step, q, correction, jacobian_is_current, is_last, modal_coordinates, r, &tolerance,
                         &is_full, reason))
            return REFUSED;
        last_norm = is_full ? norm : 0.0; /* 0: the next iteration computes the Jacobian */
        jacobian_is_current = false;
    }
    *remaining_norm = residual_norm(r);
    return *remaining_norm <= tolerance_factor * tolerance ? CONVERGED : NOT_CONVERGED;
}

/* Say that there is no equilibrium, with the inputs that are not zero, or not the temperature of tightening. */
static void explain_failure(const double *inputs, double step_fraction, double remaining_norm, Text *reason)
{
    text_clear(reason);
    for (int v = 0; v < 3 + N_DISPLACEMENTS; v++) {
        const bool is_last = v == 2 + N_DISPLACEMENTS;
        const int at =
            is_last ? INPUT_TEMPERATURE : (v == 0 ? INPUT_PRELOAD : (v == 1 ? INPUT_MOMENT : input_of(v - 2)));
        if (inputs[at] == (is_last ? TIGHTENING_TEMPERATURE : 0.0))
            continue;
        text_append(reason, reason->length > 0 ? ", " : "");
        text_append(reason, variables[FIRST_INPUT + at].name);
        text_append(reason, " = ");
        text_append_number(reason, inputs[at], 6);
    }
    text_append(reason, ": no equilibrium of the joint was found: the solution stopped after a fraction ");
    text_append_number(reason, step_fraction, 3);
    text_append(reason, " of the load step, with a residual force of ");
    text_append_number(reason, remaining_norm, 2);
    text_append(reason, " N; check the size of the inputs, and [bodies]");
}

/* Modal coordinates in equilibrium at the end of a load step, which is divided where Newton's method fails. */
static bool solve_load_step(Equilibrium *e, LoadStep *step, double *modal_coordinates, Text *reason)
{
    double step_fraction = 0.0, increment = 1.0, remaining_norm = 0.0, reached[MODES], rate[MODES];
    memcpy(reached, step->history + HISTORY_MODAL_COORDINATES, sizeof reached);
    modal_displacement(e->assembly.bodies, reached, e->assembly.bodies->start_displacement);
    if (!predict_by_tangent(e, step, rate, reason))
        return false;
    for (;;) {
        const double target = fmin(step_fraction + increment, 1.0);
        for (int k = 0; k < MODES; k++)
            modal_coordinates[k] = reached[k] + (target - step_fraction) * rate[k];
        const NewtonResult result = solve_newton(e, step, target, modal_coordinates, &remaining_norm, reason);
        if (result == REFUSED)
            return false;
        if (result == NOT_CONVERGED) {
            increment *= 0.5;
            if (increment < MIN_STEP_FRACTION_INCREMENT) {
                explain_failure(step->inputs, step_fraction, remaining_norm, reason);
                return false;
            }
            continue;
        }
        if (target == 1.0)
            return step->is_complete || evaluate_trial(e, step, step->end, modal_coordinates, true, reason);
        for (int k = 0; k < MODES; k++)
            rate[k] = (modal_coordinates[k] - reached[k]) / (target - step_fraction);
        memcpy(reached, modal_coordinates, sizeof reached);
        step_fraction = target;
        increment *= 2.0;
    }
}

bool solve_equilibrium(Equilibrium *e, const double *inputs, const double *history, double *after, Text *reason)
{
    if (!ELASTIC)
        return false;
    LoadStep step = {.inputs = inputs,
                     .history = history,
                     .start = {history[HISTORY_TANGENTIAL], history[HISTORY_TANGENTIAL + 1], history[HISTORY_NORMAL],
                               history[HISTORY_NORMAL + 1], history[HISTORY_NORMAL + 2],
                               history[HISTORY_TANGENTIAL + 2]},
                     .after = after};
    double modal_coordinates[MODES];
    relative_displacement(inputs, step.end);
    if (!solve_load_step(e, &step, modal_coordinates, reason))
        return false;
    memcpy(after + HISTORY_NORMAL, step.end + S_Z, 3 * sizeof *after);
    memcpy(after + HISTORY_MODAL_COORDINATES, modal_coordinates, sizeof modal_coordinates);
    memset(after + HISTORY_TANGENT, 0, 6 * MAX_PATCHES * sizeof *after);
    for (int j = 0; j < n_patches(); j++)
        memcpy(after + HISTORY_TANGENT + 6 * j, e->assembly.friction->update[j].tangent, 6 * sizeof *after);
    condense_stiffness(e, after + HISTORY_TANGENT, &e->end);
    predictor_key(&e->assembly.contact->preload, after, e->end.key);
    return true;
}

void solve_modal_rates(Equilibrium *e, const double *q_rate, const double *history, const double *after)
{
    if (!ELASTIC)
        return;
    const Contact *contact = e->assembly.contact;
    const Bolts *bolts = e->assembly.bolts;
    Bodies *bodies = e->assembly.bodies;
    double r[MODES] = {0.0};
    for (int i = 0; i < n_points(); i++) {
        const PointRate *rate = &contact->rate[i];
        const double pressure =
            rate->derivatives[1] * rate->approach - rate->preload_stiffness * rate->preload_approach;
        add_scaled(contact->area * data.points[i][SHARE] * pressure, bodies->full_opening_jacobian[i], r);
    }
    for (int j = 0; j < n_patches(); j++)
        for (int d = 0; d < 3; d++)
            add_scaled(-contact->area * data.patches[j][SHARE] * e->assembly.friction->rate[j].traction[d],
                       bodies->full_tangential_jacobian[d][j], r);
    for (int b = 0; b < (int)data.n_bolt_elongation; b++) {
        const double rate = rigid_elongation(b, q_rate);
        add_scaled(-bolts->stiffness * (rate + bolt_gap_rate(bolts, b, rate)), bodies->full_elongation_jacobian[b], r);
    }
    residual_jacobian_on_side(e, history, after);
    dense_solve(bodies->use_avx, &e->factors, r);
    deform(bodies, r, &bodies->rate);
}

END_OPTIMIZE_FOR_SIZE
