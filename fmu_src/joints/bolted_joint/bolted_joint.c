/* Repeats `BoltedJointSpring.advance` in joint.py of the package: inputs and history to outputs and history; and its
 * derivative. Laws of points and sliders are generated. */
#include "bolted_joint.h"

#include <string.h>

#include "optimize_for_size.h"
#include "tabulated_joint.h"

OPTIMIZE_FOR_SIZE

/* Tables */

static bool tabulate(Joint *joint, int steps, Text *reason)
{
    Contact *contact = &joint->model.contact;
    return tabulate_approach(&contact->law, &joint->curve, &contact->spots, joint->constants, steps, reason);
}

/* Parts of the joint from its constants. */
static void set_parts(Joint *joint, const double constants[7])
{
    JointModel *model = &joint->model;
    model->contact.c = joint->constants;
    model->contact.curve = &joint->curve;
    model->contact.area = constants[3];
    model->friction.has_history = constants[0] != 0.0;
    model->friction.mu = constants[1];
    model->friction.stiffness_ratio = constants[2];
    model->bolts.stiffness = constants[4];
    model->bolts.bolts_per_position = constants[6] / (double)data.n_bolts;
    model->bolts.lift_off_force =
        LIFT_OFF_FORCE_OVER_CLOSING_END_FORCE * model->contact.law.closing_end_pressure * model->contact.area;
    model->equilibrium.assembly = (JointAssembly){&model->contact, &model->bodies, &model->bolts, &model->friction};
    model->equilibrium.start.is_known = model->equilibrium.end.is_known = false;
}

bool tabulate_model(Joint *joint, Text *reason)
{
    JointModel *model = &joint->model;
    double constants[7];
    model->contact.preload.is_current = false;
    if (!set_spot_distribution(&model->contact.spots, joint->constants, reason) ||
        !refine_curve(joint, tabulate, APPROACH_STEPS, reason))
        return false;
    tabulate_energy(&joint->curve);
    joint_constants(0, joint->constants, constants);
    set_parts(joint, constants);
    if (ELASTIC && (!model->friction.has_history || constants[5] != 0.0)) {
        text_append(reason, model->friction.has_history
                                ? "damping = true with sides = elastic; expected false, the dashpots act between "
                                  "rigid sides only"
                                : "memory = false with sides = elastic; expected true, elastic sides need friction "
                                  "with memory");
        return false;
    }
    bodies_tabulate(&model->bodies);
    contact_tabulate(&model->contact);
    friction_tabulate(&model->friction, &model->contact, model->bodies.use_avx);
    return true;
}

END_OPTIMIZE_FOR_SIZE

/* Evaluation */

/* Preload state and preload forces of the bolts. */
static void preload(Joint *joint, const double *inputs)
{
    JointModel *model = &joint->model;
    double warm_preload;
    preload_at_temperature((const double[]){inputs[INPUT_PRELOAD], inputs[INPUT_TEMPERATURE]}, joint->constants,
                           &warm_preload);
    if (!set_preload_state(&model->contact, warm_preload, inputs[INPUT_MOMENT]))
        return;
    set_preload_force(&model->bolts, joint->constants, warm_preload, inputs[INPUT_MOMENT]);
    model->sums.points_are_current = false;
}

/* Whether pressures are those of the preload state: no opening, and without history no shear. */
static bool is_preload_state(const JointModel *model, const double *q)
{
    const bool is_sheared = q[S_X] != 0.0 || q[S_Y] != 0.0 || q[THETA_Z] != 0.0;
    for (int k = 0; k < MODES && ELASTIC; k++)
        if (model->bodies.state.modal_coordinates[k] != 0.0)
            return false;
    return q[S_Z] == 0.0 && q[THETA_X] == 0.0 && q[THETA_Y] == 0.0 && (model->friction.has_history || !is_sheared);
}

/* Points and patches between elastic members. */
static bool evaluate_elastic(JointModel *model, const double *inputs, const double *history, double *after,
                             Text *reason)
{
    if (!solve_equilibrium(&model->equilibrium, inputs, history, after, reason))
        return false;
    sum_points(&model->sums, &model->contact);
    return true;
}

/* Points and patches between rigid members. */
static bool evaluate_rigid(JointModel *model, const double *q, const double *history, double *after, Text *reason)
{
    Friction *friction = &model->friction;
    const bool accepted =
        friction->has_history ? evaluate_point_sums(&model->sums, &model->contact, &model->bodies, q, reason)
                              : evaluate_elastic_shear(&model->sums, &model->contact, friction->mu, q, reason);
    if (!accepted)
        return false;
    evaluate_patches(&model->contact, model->bodies.state.opening, q);
    if (friction->has_history) {
        set_increments(friction, &model->bodies, history, q);
        update_friction(friction, &model->contact, history, q, after);
    } else {
        update_without_history(friction, &model->contact, history, after);
    }
    memset(after + HISTORY_NORMAL, 0, (N_HISTORY - HISTORY_NORMAL) * sizeof *after);
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *after, size_t n_outputs,
                    double *out, Text *reason)
{
    (void)n_outputs;
    JointModel *model = &joint->model;
    OutputSums *sums = &model->sums;
    double q[N_DISPLACEMENTS];
    memset(sums->x, 0, sizeof sums->x);
    relative_displacement(inputs, q);
    preload(joint, inputs);
    if (!(ELASTIC ? evaluate_elastic(model, inputs, history, after, reason)
                  : evaluate_rigid(model, q, history, after, reason)))
        return false;
    if (is_preload_state(model, q))
        use_preload_sums(sums, &model->contact);
    sum_patches(sums, &model->friction, after, model->contact.area);
    sum_cycles(sums, &model->friction, &model->contact, &model->bodies, q);
    if (ELASTIC)
        elastic_member_sums(sums, &model->equilibrium, q);
    else
        sum_gaps(sums, &model->bolts, model->contact.area, q);
    set_output_arguments(sums, &model->contact, inputs);
    outputs(sums->x, joint->constants, out);
    if (ELASTIC)
        memcpy(out + N_INTERFACE_OUTPUTS, model->bolts.force, (size_t)data.n_bolt_elongation * sizeof *out);
    return true;
}

OPTIMIZE_FOR_SIZE

/* Derivatives
 *
 * At a corner (a jump of the derivative) each side has a derivative of its own; the FMU returns their mean. */

/* A seed, and the state of the last evaluation: q and its rate, bolt pressures and their rates, histories before and
 * after. */
typedef struct {
    double q[N_DISPLACEMENTS], q_rate[N_DISPLACEMENTS], bolts[4];
    const double *seed, *history, *after;
} Seed;

static void point_rates(JointModel *model, const Seed *seed)
{
    set_point_rates(&model->contact, model->bodies.rate.opening, seed->q_rate, seed->bolts);
}

enum { MAX_SIDE_ITERATIONS = 20 }; /* until the sliders that slip are those that the motion of the patches lets slip */

/* Rates of the deformation of elastic bodies, on one side of a corner. */
static void deformation_rates(JointModel *model, const Seed *seed)
{
    Bodies *bodies = &model->bodies;
    Friction *friction = &model->friction;
    double before[MODES];
    IncrementRate rates[MAX_PATCHES];
    memset(friction->direction, 0, sizeof friction->direction);
    for (int n = 0; n < MAX_SIDE_ITERATIONS; n++) {
        memcpy(before, bodies->rate.modal_coordinates, sizeof before);
        memset(bodies->rate.opening, 0, sizeof bodies->rate.opening);
        memset(bodies->rate.patch_displacement, 0, sizeof bodies->rate.patch_displacement);
        point_rates(model, seed);
        increment_rates(friction, &model->contact, bodies, seed->q_rate, seed->bolts, rates);
        if (n == 0)
            set_direction(friction, rates);
        friction->is_corner = false;
        update_rates(friction, seed->history, seed->after, rates);
        solve_modal_rates(&model->equilibrium, seed->q_rate, seed->history, seed->after);
        if (!friction->is_corner || (n > 0 && memcmp(before, bodies->rate.modal_coordinates, sizeof before) == 0))
            break;
        point_rates(model, seed);
        increment_rates(friction, &model->contact, bodies, seed->q_rate, seed->bolts, rates);
        set_direction(friction, rates);
    }
}

/* Derivative along a seed on its side 1 (along the seed) or -1 (against it). true: the other side has another
 * derivative. */
static bool side_derivative(Joint *joint, const Seed *seed, double side, double *result)
{
    JointModel *model = &joint->model;
    Friction *friction = &model->friction;
    double x[2 * N_X] = {0.0}, *dx = x + N_X;
    IncrementRate rates[MAX_PATCHES];
    friction->side = side;
    friction->is_corner = false;
    memcpy(x, model->sums.x, sizeof model->sums.x);
    if (ELASTIC)
        deformation_rates(model, seed);
    point_rates(model, seed);
    add_point_rates(&model->contact, friction, seed->q, seed->q_rate, dx);
    const bool is_corner = max_pressure_rate(&model->sums, &model->contact, side, &dx[X_P_MAX]);
    increment_rates(friction, &model->contact, &model->bodies, seed->q_rate, seed->bolts, rates);
    if (!ELASTIC)
        set_direction(friction, rates);
    add_cycle_rates(friction, &model->contact, &model->bodies, seed->q, rates, dx);
    update_rates(friction, seed->history, seed->after, rates);
    if (friction->has_history)
        add_patch_rates(friction, rates, dx);
    if (ELASTIC)
        add_elastic_member_rates(&model->equilibrium, seed->q, seed->q_rate, dx);
    else
        add_gap_rates(&model->bolts, seed->q_rate, dx);
    memcpy(dx + X_S_REL, seed->seed + INPUT_S_REL_X, 3 * sizeof *dx);
    memcpy(dx + X_THETA, seed->seed + INPUT_THETA_X, 3 * sizeof *dx);
    memcpy(dx + X_RATES, seed->seed + INPUT_V_REL_X, 3 * sizeof *dx);
    memcpy(dx + X_RATES + 3, seed->seed + INPUT_OMEGA_X, 3 * sizeof *dx);
    outputs_seed(x, joint->constants, result);
    if (ELASTIC)
        bolt_force_rates(&model->equilibrium, seed->q_rate, result + N_INTERFACE_OUTPUTS);
    return is_corner || friction->is_corner;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *after,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)n_outputs;
    JointModel *model = &joint->model;
    const double tightening[4] = {inputs[INPUT_PRELOAD], inputs[INPUT_TEMPERATURE], seed[INPUT_PRELOAD],
                                  seed[INPUT_TEMPERATURE]};
    double preload[4] = {0.0, inputs[INPUT_MOMENT], 0.0, seed[INPUT_MOMENT]};
    Seed along = {.seed = seed, .history = history, .after = after};
    double other[N_OUTPUTS];
    Text ignored;
    text_clear(&ignored);
    relative_displacement(inputs, along.q);
    relative_displacement(seed, along.q_rate);
    preload_at_temperature(tightening, joint->constants, &preload[0]);
    preload_at_temperature_seed(tightening, joint->constants, &preload[2]);
    bolt_pressures(preload, joint->constants, along.bolts);
    bolt_pressures_seed(preload, joint->constants, along.bolts + 2);
    set_preload_rate(&model->bolts, joint->constants, preload[0], preload[2], preload[3]);
    if (after && model->friction.state != FULL_STICK && model->friction.has_history)
        set_heights_from(&model->friction, after); /* as the next update sets them */
    if (!evaluate_derivatives(&model->contact, model->bodies.state.opening, along.q, &ignored))
        return;
    if (!side_derivative(joint, &along, 1.0, result))
        return;
    side_derivative(joint, &along, -1.0, other);
    for (int k = 0; k < N_OUTPUTS; k++)
        result[k] = 0.5 * (result[k] + other[k]);
}

END_OPTIMIZE_FOR_SIZE
