/* Repeats `BoltedJointSpring.advance` in joint.py of the package: inputs and history to outputs and history; and its
 * derivative. Laws of points and sliders are generated. */
#include "bolted_joint.h"

#include <string.h>

#include "cold.h"
#include "tabulated.h"

COLD

/* Tables */

static bool tabulate(Joint *joint, int steps, Text *why)
{
    Contact *contact = &joint->kind.contact;
    return approach_tabulate(&contact->law, &joint->curve, &contact->spots, joint->c, steps, why);
}

/* Parts of the joint from its constants. */
static void set_parts(Joint *joint, const double constants[7])
{
    Kind *kind = &joint->kind;
    kind->contact.c = joint->c;
    kind->contact.curve = &joint->curve;
    kind->contact.area = constants[3];
    kind->friction.has_history = constants[0] != 0.0;
    kind->friction.mu = constants[1];
    kind->friction.stiffness_ratio = constants[2];
    kind->bolts.stiffness = constants[4];
    kind->bolts.count = constants[6] / (double)data.n_bolts;
    kind->bolts.lift_off = BOLT_LIFT_OFF_RATIO * kind->contact.law.closed * kind->contact.area;
    kind->equilibrium.assembly = (JointAssembly){&kind->contact, &kind->bodies, &kind->bolts, &kind->friction};
    kind->equilibrium.start.is_known = kind->equilibrium.end.is_known = false;
}

bool kind_tabulate(Joint *joint, Text *why)
{
    Kind *kind = &joint->kind;
    double constants[7];
    kind->contact.preload.is_current = false;
    if (!spots_begin(&kind->contact.spots, joint->c, why) || !refined(joint, tabulate, APPROACH_STEPS, why))
        return false;
    joint_constants(0, joint->c, constants);
    set_parts(joint, constants);
    if (ELASTIC && (!kind->friction.has_history || constants[5] != 0.0)) {
        text_add(why, kind->friction.has_history ? "damping = true with sides = elastic; expected false, the dashpots act between rigid sides only"
                                                 : "memory = false with sides = elastic; expected true, elastic sides need friction with memory");
        return false;
    }
    bodies_tabulate(&kind->bodies);
    contact_tabulate(&kind->contact);
    friction_tabulate(&kind->friction, &kind->contact, kind->bodies.use_avx);
    return true;
}

END_OF_COLD

/* Evaluation */

/* Preload state and preload forces of the bolts. */
static void preload(Joint *joint, const double *inputs)
{
    Kind *kind = &joint->kind;
    if (!set_preload_state(&kind->contact, inputs[INPUT_PRELOAD], inputs[INPUT_MOMENT]))
        return;
    set_preload_force(&kind->bolts, joint->c, inputs[INPUT_PRELOAD], inputs[INPUT_MOMENT]);
    kind->sums.points_are_current = false;
}

/* Whether pressures are those of the preload state: no opening, and without history no shear. */
static bool is_preload_state(const Kind *kind, const double *q)
{
    const bool is_sheared = q[S_X] != 0.0 || q[S_Y] != 0.0 || q[THETA_Z] != 0.0;
    for (int k = 0; k < MODES && ELASTIC; k++)
        if (kind->bodies.state.modal_coordinates[k] != 0.0)
            return false;
    return q[S_Z] == 0.0 && q[THETA_X] == 0.0 && q[THETA_Y] == 0.0 && (kind->friction.has_history || !is_sheared);
}

/* Points and patches between elastic bodies. */
static bool evaluate_elastic(Kind *kind, const double *inputs, const double *history, double *after, Text *why)
{
    if (!solve_equilibrium(&kind->equilibrium, inputs, history, after, why))
        return false;
    sum_points(&kind->sums, &kind->contact);
    return true;
}

/* The same between rigid bodies. */
static bool evaluate_rigid(Kind *kind, const double *q, const double *history, double *after, Text *why)
{
    Friction *friction = &kind->friction;
    const bool accepted =
        friction->has_history ? evaluate_point_sums(&kind->sums, &kind->contact, &kind->bodies, q, why)
                              : evaluate_elastic_shear(&kind->sums, &kind->contact, friction->mu, q, why);
    if (!accepted)
        return false;
    evaluate_patches(&kind->contact, kind->bodies.state.opening, q);
    if (friction->has_history) {
        set_increments(friction, &kind->bodies, history, q);
        update_friction(friction, &kind->contact, history, q, after);
    } else {
        update_without_history(friction, &kind->contact, history, after);
    }
    memset(after + AT_NORMAL, 0, (N_MEMORY - AT_NORMAL) * sizeof *after);
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *after, double *out, Text *why)
{
    Kind *kind = &joint->kind;
    OutputSums *sums = &kind->sums;
    double q[N_DISPLACEMENTS];
    memset(sums->x, 0, sizeof sums->x);
    relative_displacement(inputs, q);
    preload(joint, inputs);
    if (!(ELASTIC ? evaluate_elastic(kind, inputs, history, after, why) : evaluate_rigid(kind, q, history, after, why)))
        return false;
    if (is_preload_state(kind, q))
        use_preload_sums(sums, &kind->contact);
    sum_patches(sums, &kind->friction, after, kind->contact.area);
    sum_cycles(sums, &kind->friction, &kind->contact, &kind->bodies, q);
    if (ELASTIC)
        assembly_sums(sums, &kind->equilibrium, q);
    else
        sum_gaps(sums, &kind->bolts, kind->contact.area, q);
    set_output_arguments(sums, &kind->contact, inputs);
    outputs(sums->x, joint->c, out);
    if (ELASTIC)
        memcpy(out + N_INTERFACE_OUTPUTS, kind->bolts.force, (size_t)data.n_bolt_elongation * sizeof *out);
    return true;
}

COLD

/* Derivatives
 *
 * At a corner they are the mean of both sides; each side has a derivative of its own. */

/* A seed at inputs: q and its rate, bolt pressures with their rates, histories before and after the last evaluation. */
typedef struct {
    double q[N_DISPLACEMENTS], q_rate[N_DISPLACEMENTS], bolts[4];
    const double *seed, *history, *after;
} Seed;

static void point_rates(Kind *kind, const Seed *seed)
{
    set_point_rates(&kind->contact, kind->bodies.rate.opening, seed->q_rate, seed->bolts);
}

enum { MAX_SIDE_ITERATIONS = 20 }; /* until the sliders that slip are those that the motion of the patches lets slip */

/* Rates of the deformation of elastic bodies, on one side of a corner. */
static void deformation_rates(Kind *kind, const Seed *seed)
{
    Bodies *bodies = &kind->bodies;
    Friction *friction = &kind->friction;
    double before[MODES];
    IncrementRate rates[MOST_PATCHES];
    memset(friction->direction, 0, sizeof friction->direction);
    for (int n = 0; n < MAX_SIDE_ITERATIONS; n++) {
        memcpy(before, bodies->rate.modal_coordinates, sizeof before);
        memset(bodies->rate.opening, 0, sizeof bodies->rate.opening);
        memset(bodies->rate.patch_displacement, 0, sizeof bodies->rate.patch_displacement);
        point_rates(kind, seed);
        increment_rates(friction, &kind->contact, bodies, seed->q_rate, seed->bolts, rates);
        if (n == 0)
            set_direction(friction, rates);
        friction->is_corner = false;
        update_rates(friction, seed->history, seed->after, rates);
        solve_modal_rates(&kind->equilibrium, seed->q_rate, seed->history, seed->after);
        if (!friction->is_corner || (n > 0 && memcmp(before, bodies->rate.modal_coordinates, sizeof before) == 0))
            break;
        point_rates(kind, seed);
        increment_rates(friction, &kind->contact, bodies, seed->q_rate, seed->bolts, rates);
        set_direction(friction, rates);
    }
}

/* Derivative along a seed on one side, 1 or -1 along it; true: the other side has another one. */
static bool side_derivative(Joint *joint, const Seed *seed, double side, double *result)
{
    Kind *kind = &joint->kind;
    Friction *friction = &kind->friction;
    double x[2 * N_X] = {0.0}, *dx = x + N_X;
    IncrementRate rates[MOST_PATCHES];
    friction->side = side;
    friction->is_corner = false;
    memcpy(x, kind->sums.x, sizeof kind->sums.x);
    if (ELASTIC)
        deformation_rates(kind, seed);
    point_rates(kind, seed);
    add_point_rates(&kind->contact, friction, seed->q, seed->q_rate, dx);
    const bool is_corner = max_pressure_rate(&kind->sums, &kind->contact, side, &dx[X_P_MAX]);
    increment_rates(friction, &kind->contact, &kind->bodies, seed->q_rate, seed->bolts, rates);
    if (!ELASTIC)
        set_direction(friction, rates);
    add_cycle_rates(friction, &kind->contact, &kind->bodies, seed->q, rates, dx);
    update_rates(friction, seed->history, seed->after, rates);
    if (friction->has_history)
        add_patch_rates(friction, rates, dx);
    if (ELASTIC)
        add_assembly_rates(&kind->equilibrium, seed->q, seed->q_rate, dx);
    else
        add_gap_rates(&kind->bolts, seed->q_rate, dx);
    memcpy(dx + X_S_REL, seed->seed + INPUT_S_REL_X, 3 * sizeof *dx);
    memcpy(dx + X_THETA, seed->seed + INPUT_THETA_X, 3 * sizeof *dx);
    memcpy(dx + X_RATES, seed->seed + INPUT_V_REL_X, 3 * sizeof *dx);
    memcpy(dx + X_RATES + 3, seed->seed + INPUT_OMEGA_X, 3 * sizeof *dx);
    outputs_seed(x, joint->c, result);
    if (ELASTIC)
        bolt_force_rates(&kind->equilibrium, seed->q_rate, result + N_INTERFACE_OUTPUTS);
    return is_corner || friction->is_corner;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *after,
                      const double *seed, double *result)
{
    Kind *kind = &joint->kind;
    const double preload[4] = {inputs[INPUT_PRELOAD], inputs[INPUT_MOMENT], seed[INPUT_PRELOAD], seed[INPUT_MOMENT]};
    Seed along = {.seed = seed, .history = history, .after = after};
    double other[N_OUTPUTS];
    Text ignored;
    text_clear(&ignored);
    relative_displacement(inputs, along.q);
    relative_displacement(seed, along.q_rate);
    bolt_pressures(preload, joint->c, along.bolts);
    bolt_pressures_seed(preload, joint->c, along.bolts + 2);
    set_preload_rate(&kind->bolts, joint->c, preload[0], preload[2], preload[3]);
    if (after && kind->friction.state != FULL_STICK && kind->friction.has_history)
        set_heights_from(&kind->friction, after); /* as the next update sets them */
    if (!evaluate_derivatives(&kind->contact, kind->bodies.state.opening, along.q, &ignored))
        return;
    if (!side_derivative(joint, &along, 1.0, result))
        return;
    side_derivative(joint, &along, -1.0, other);
    for (int k = 0; k < N_OUTPUTS; k++)
        result[k] = 0.5 * (result[k] + other[k]);
}

END_OF_COLD
