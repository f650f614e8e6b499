/* Repeats spring.py of the package: the curve of the midline, and the outputs. The functions of the drive are
 * generated. The nodes of the midline are computed from a contact pair, or given: by the function `midline_nodes`
 * (MIDLINE_NODES is their number), or as data if the midline was measured (MIDLINE_IS_DATA). */
#include "harmonic_drive.h"

#include <math.h>
#include <string.h>

#include "simd.h"
#include "tabulated_joint.h"

#if defined MIDLINE_NODES || defined MIDLINE_IS_DATA
/* Tabulate given nodes: wind-up, torque, stiffness, derivative of the stiffness before and after the node. Each segment
 * is a piece of its own, because this derivative may jump at the nodes. */
static bool tabulate_nodes(Joint *joint, const double (*nodes)[5], int n_nodes, Text *reason)
{
    if (!curve_begin(&joint->curve, n_nodes, 0, 0.0, reason))
        return false;
    for (int k = 0; k + 1 < n_nodes; k++) {
        const double *left = nodes[k], *right = nodes[k + 1];
        curve_begin_piece(&joint->curve,
                          (Node){.x = left[0], .y = left[1], .stiffness = left[2], .stiffness_slope = left[4]});
        if (!curve_add_node(&joint->curve,
                            (Node){.x = right[0], .y = right[1], .stiffness = right[2], .stiffness_slope = right[3]}))
            return false;
    }
    curve_finish(&joint->curve);
    return true;
}
#endif

#ifdef MIDLINE_IS_DATA
_Static_assert((int)CURVE_NODES >= (int)MAX_MIDLINE, "room for all nodes");

static bool tabulate_midline(Joint *joint, Text *reason)
{
    return tabulate_nodes(joint, joint->data->midline, (int)joint->data->n_midline, reason);
}
#elif defined MIDLINE_NODES
enum { N_MIDLINE_NODES = (int)MIDLINE_NODES };
_Static_assert((int)CURVE_NODES >= (int)N_MIDLINE_NODES, "room for all nodes");

static bool tabulate_midline(Joint *joint, Text *reason)
{
    double nodes[N_MIDLINE_NODES][5];
    midline_nodes(0, joint->constants, nodes[0]);
    return tabulate_nodes(joint, (const double (*)[5])nodes, N_MIDLINE_NODES, reason);
}
#else
enum { SMOOTHING, MAX_TORQUE, K_FTS0, N_PAIR_CONSTANTS }; /* results of `pair_constants` */
_Static_assert(CURVE_NODES > DRIVE_STEPS, "room for the coarsest table");

/* Midline of a contact pair: torque over wind-up, by integration of the compliance over the torque. */
static bool tabulate_pair(Joint *joint, int steps, Text *reason)
{
    double constants[N_PAIR_CONSTANTS], phi = 0.0, K[2];
    pair_constants(0, joint->constants, constants);
    const double smoothing = constants[SMOOTHING];
    const double step = portable_asinh(constants[MAX_TORQUE] / smoothing) / steps, half = 0.5 * step;
    if (!curve_begin(&joint->curve, steps + 1, 0, 0.0, reason))
        return false;
    for (int k = 0; k <= steps; k++) {
        const double xi = k * step, torque = smoothing * portable_sinh(xi);
        stiffness_with_play(&torque, joint->constants, K);
        if (!(K[0] > MIN_DRIVE_STIFFNESS && K[0] < (1.0 - MIN_FLEXSPLINE_OVER_CONTACT_STIFFNESS) * constants[K_FTS0])) {
            stiffness_with_play(&constants[MAX_TORQUE], joint->constants, K);
            text_append_format(reason,
                               "drive stiffness K_WTS = %g N.m/rad, of the contact pair in series with the "
                               "flexspline K_FTS0 = %g N.m/rad, is outside (%g, %g) N.m/rad, or the contact pair "
                               "is more than %g times as stiff as K_FTS0; check K_FTS0 and the surface",
                               K[0], constants[K_FTS0], MIN_DRIVE_STIFFNESS, constants[K_FTS0],
                               1.0 / MIN_FLEXSPLINE_OVER_CONTACT_STIFFNESS);
            return false;
        }
        const Node node = {.x = phi, .y = torque, .stiffness = K[0], .stiffness_slope = K[0] * K[1]};
        if (k == 0)
            curve_begin_piece(&joint->curve, node);
        else if (!curve_add_node(&joint->curve, node))
            return false;
        double wind_up_increment = 0.0;
        for (int i = 0; i < N_DRIVE_GAUSS && k < steps; i++) {
            const double inner_xi = xi + half * (1.0 + DRIVE_GAUSS[i]),
                         inner_torque = smoothing * portable_sinh(inner_xi);
            stiffness_with_play(&inner_torque, joint->constants, K);
            wind_up_increment += DRIVE_GAUSS_WEIGHTS[i] * smoothing * portable_cosh(inner_xi) / K[0];
        }
        phi += half * wind_up_increment;
    }
    curve_finish(&joint->curve);
    return true;
}

static bool tabulate_midline(Joint *joint, Text *reason)
{
    return refine_curve(joint, tabulate_pair, DRIVE_STEPS, reason);
}
#endif

bool tabulate_model(Joint *joint, Text *reason)
{
    JointModel *model = &joint->model;
    double constants[3], shares[2 * HYSTERESIS_SLIDER_COUNT], amplitudes[N_HARMONICS], stiffness;
    *model = (JointModel){.has_periodic_terms = false};
    model->hysteresis.use_avx = model->friction.use_avx = has_avx();
    periodic_amplitudes(0, joint->constants, amplitudes);
    for (int i = 0; i < N_HARMONICS; i++)
        model->has_periodic_terms |= amplitudes[i] != 0.0;
    sticking_stiffness(0, joint->constants, &stiffness);
    friction_tabulate(&model->friction, stiffness);
    hysteresis_constants(0, joint->constants, constants);
    slider_shares(0, joint->constants, shares);
    return tabulate_midline(joint, reason) &&
           hysteresis_tabulate(&model->hysteresis, constants, shares, &joint->curve, reason);
}

/* Wind-up at the inputs, which are a motion or a torque, after a path from a history. */
static double solve_wind_up(const Joint *joint, const double *inputs, double error, const double *history)
{
    double x[N_INPUTS + 1], curve_x;
    memcpy(x, inputs, N_INPUTS * sizeof(double));
    x[N_INPUTS] = error;
    curve_argument(x, joint->constants, &curve_x);
    if (!ARGUMENT_IS_LOAD)
        return curve_x;
    if (joint->model.hysteresis.has_friction)
        return hysteresis_solve_wind_up(&joint->model.hysteresis, &joint->curve, history, curve_x);
    return midline_wind_up(&joint->curve, curve_x);
}

/* Arguments of `outputs`: inputs, then wind-up, torque and stiffness of the midline, hysteresis torque, loss, kinematic
 * error and its derivative, dry friction torque. */
enum {
    PHI = N_INPUTS,
    MIDLINE_TORQUE,
    STIFFNESS,
    HYSTERESIS_TORQUE,
    LOSS,
    PHI_ERROR,
    PHI_ERROR_SLOPE,
    DRY_FRICTION,
    N_OUTPUT_ARGUMENTS
};
/* Arguments of `friction_arguments`: inputs, torques of midline and hysteresis, derivative of the kinematic error,
 * ripple. */
enum {
    FRICTION_MIDLINE_TORQUE = N_INPUTS,
    FRICTION_HYSTERESIS_TORQUE,
    FRICTION_ERROR_SLOPE,
    FRICTION_RIPPLE,
    N_FRICTION_ARGUMENTS
};

/* Set the arguments y of `friction_arguments` from the arguments x of `outputs` and the ripple. */
static void set_friction_arguments(const double *x, double ripple, double *y)
{
    memcpy(y, x, N_INPUTS * sizeof(double));
    y[FRICTION_MIDLINE_TORQUE] = x[MIDLINE_TORQUE];
    y[FRICTION_HYSTERESIS_TORQUE] = x[HYSTERESIS_TORQUE];
    y[FRICTION_ERROR_SLOPE] = x[PHI_ERROR_SLOPE];
    y[FRICTION_RIPPLE] = ripple;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *out, Text *reason)
{
    JointModel *model = &joint->model;
    double x[N_OUTPUT_ARGUMENTS];
    (void)reason;
    if (model->has_periodic_terms) /* otherwise they stay zero */
        periodic_terms(inputs, joint->constants, model->periodic);
    model->phi = solve_wind_up(joint, inputs, model->periodic[ERROR], history);
    memset(history_end, 0, N_HISTORY * sizeof *history_end);
    model->hysteresis_update = model->friction_update = (SliderResultant){.loss = 0.0};
    if (model->hysteresis.has_friction)
        model->hysteresis_update = hysteresis_advance(&model->hysteresis, history, model->phi, history_end);
    memcpy(x, inputs, N_INPUTS * sizeof(double));
    x[PHI] = model->phi;
    midline_torque(&joint->curve, model->phi, 1, &x[MIDLINE_TORQUE]);
    x[HYSTERESIS_TORQUE] = model->hysteresis_update.force[0];
    x[PHI_ERROR] = model->periodic[ERROR];
    x[PHI_ERROR_SLOPE] = model->periodic[ERROR_SLOPE];
    if (model->friction.has_friction) {
        double friction_x[N_FRICTION_ARGUMENTS], y[4];
        set_friction_arguments(x, model->periodic[RIPPLE], friction_x);
        friction_arguments(friction_x, joint->constants, y);
        model->friction_arguments = (FrictionArguments){y[0], y[1], {y[2], y[3]}};
        model->friction_update = friction_advance(&model->friction, history, model->friction_arguments, history_end);
    }
    x[DRY_FRICTION] = model->friction_update.force[0];
    x[LOSS] = history[HISTORY_LOSS] + model->hysteresis_update.loss + model->friction_update.loss;
    history_end[HISTORY_WIND_UP] = model->phi;
    history_end[HISTORY_LOSS] = x[LOSS];
    outputs(x, joint->constants, n_outputs, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history_end;
    const JointModel *model = &joint->model;
    const double *periodic = model->periodic;
    double x[2 * N_OUTPUT_ARGUMENTS] = {0.0}, y[3], curve_x[2 * (N_INPUTS + 1)], rate;
    for (int i = 0; i < N_INPUTS; i++) {
        x[i] = curve_x[i] = inputs[i];
        x[N_OUTPUT_ARGUMENTS + i] = curve_x[N_INPUTS + 1 + i] = seed[i];
    }
    curve_x[N_INPUTS] = periodic[ERROR];
    curve_x[2 * N_INPUTS + 1] = periodic[ERROR_SLOPE] * seed[0];
    curve_argument_seed(curve_x, joint->constants, &rate);
    midline_torque(&joint->curve, model->phi, 2, y);
    if (ARGUMENT_IS_LOAD)
        rate /= y[1] + model->hysteresis_update.tangent[0];
    const double loss_derivative =
        model->hysteresis.has_friction ? hysteresis_loss_derivative(&model->hysteresis, history, model->phi) : 0.0;
    const double hysteresis_rate = model->hysteresis_update.tangent[0] * rate,
                 loss = history[HISTORY_LOSS] + model->hysteresis_update.loss + model->friction_update.loss;
    const double values[] = {model->phi, y[0],     y[1],     model->hysteresis_update.force[0],
                             loss,       periodic[ERROR], periodic[ERROR_SLOPE], model->friction_update.force[0]};
    const double x_rates[] = {
        rate, y[1] * rate, y[2] * rate, hysteresis_rate, loss_derivative * rate, periodic[ERROR_SLOPE] * seed[0],
        periodic[ERROR_BEND] * seed[0], 0.0};
    enum { N_COMPUTED = N_OUTPUT_ARGUMENTS - PHI };
    _Static_assert(sizeof values == N_COMPUTED * sizeof(double), "a value for each computed argument of outputs");
    _Static_assert(sizeof x_rates == sizeof values, "a rate for each value");
    memcpy(x + PHI, values, sizeof values);
    memcpy(x + N_OUTPUT_ARGUMENTS + PHI, x_rates, sizeof x_rates);
    if (model->friction.has_friction) {
        double friction_x[2 * N_FRICTION_ARGUMENTS], rates[4];
        set_friction_arguments(x, periodic[RIPPLE], friction_x);
        set_friction_arguments(x + N_OUTPUT_ARGUMENTS, periodic[RIPPLE_SLOPE] * seed[0],
                               friction_x + N_FRICTION_ARGUMENTS);
        friction_arguments_seed(friction_x, joint->constants, rates);
        const SliderResultant friction_torque_rate =
            friction_rate(&model->friction, history, model->friction_arguments,
                          (FrictionArguments){rates[0], rates[1], {rates[2], rates[3]}});
        x[N_OUTPUT_ARGUMENTS + DRY_FRICTION] = friction_torque_rate.force[0];
        x[N_OUTPUT_ARGUMENTS + LOSS] += friction_torque_rate.loss;
    }
    outputs_seed(x, joint->constants, n_outputs, result);
}
