/* Repeats `torque_curve` of the package: the table that is made for every parameter set; the laws in it are
 * generated. A law that gives the table's nodes defines GIVEN_NODES, how many; those of a measured midline are
 * data. */
#include "harmonic_drive.h"

#include <math.h>
#include <string.h>

#include "data.h"
#include "tabulated.h"

#if defined GIVEN_NODES || defined MIDLINE_IS_DATA
/* Each segment is a piece of its own: its bend may jump at the nodes. */
static bool through(Joint *joint, const double (*given)[5], int nodes)
{
    curve_begin(&joint->curve, 0.0);
    for (int k = 0; k + 1 < nodes; k++) {
        const double *left = given[k], *right = given[k + 1];
        curve_piece(&joint->curve, (Node){.x = left[0], .y = left[1], .s = left[2], .bend = left[4]});
        if (!curve_add(&joint->curve, (Node){.x = right[0], .y = right[1], .s = right[2], .bend = right[3]}))
            return false;
    }
    curve_finish(&joint->curve);
    return true;
}
#endif

#ifdef MIDLINE_IS_DATA
_Static_assert((int)CURVE_NODES >= (int)MOST_MIDLINE, "all of them");

static bool midline_of(Joint *joint, Text *why)
{
    (void)why;
    return through(joint, data.midline, (int)data.n_midline);
}
#elif defined GIVEN_NODES
enum { N_GIVEN_NODES = (int)GIVEN_NODES };
_Static_assert(CURVE_NODES >= N_GIVEN_NODES, "all of them");

static bool midline_of(Joint *joint, Text *why)
{
    double given[N_GIVEN_NODES][5];
    (void)why;
    given_nodes(0, joint->c, given[0]);
    return through(joint, (const double (*)[5])given, N_GIVEN_NODES);
}
#else
enum { SMOOTHING, MAX_TORQUE, K_FTS0, N_HEAD }; /* of the pair's numbers */
_Static_assert(CURVE_NODES > DRIVE_STEPS, "one curve at least");

static bool windup(Joint *joint, int steps, Text *why)
{
    double head[N_HEAD], phi = 0.0, K[2];
    pair_head(0, joint->c, head);
    const double smoothing = head[SMOOTHING];
    const double step = same_asinh(head[MAX_TORQUE] / smoothing) / steps, half = 0.5 * step;
    curve_begin(&joint->curve, 0.0);
    for (int k = 0; k <= steps; k++) {
        const double xi = k * step, torque = smoothing * same_sinh(xi);
        stiffness(&torque, joint->c, K);
        if (!(K[0] > MIN_STIFFNESS && K[0] < (1.0 - MIN_STIFFNESS_MARGIN) * head[K_FTS0])) {
            stiffness(&head[MAX_TORQUE], joint->c, K);
            text_print(why,
                       "K_FTS0 = %g N.m/rad and the contact pair give K_WTS = %g N.m/rad, allowed is (%g, %g) "
                       "N.m/rad with K_TS at most %g times K_FTS0",
                       head[K_FTS0], K[0], MIN_STIFFNESS, head[K_FTS0], 1.0 / MIN_STIFFNESS_MARGIN);
            return false;
        }
        const Node node = {.x = phi, .y = torque, .s = K[0], .bend = K[0] * K[1]};
        if (k == 0)
            curve_piece(&joint->curve, node);
        else if (!curve_add(&joint->curve, node))
            return false;
        double rise = 0.0;
        for (int i = 0; i < N_DRIVE_GAUSS && k < steps; i++) {
            const double at = xi + half * (1.0 + DRIVE_GAUSS[i]), inner = smoothing * same_sinh(at);
            stiffness(&inner, joint->c, K);
            rise += DRIVE_GAUSS_WEIGHTS[i] * smoothing * same_cosh(at) / K[0];
        }
        phi += half * rise;
    }
    curve_finish(&joint->curve);
    return true;
}

static bool midline_of(Joint *joint, Text *why)
{
    return refined(joint, windup, DRIVE_STEPS, why);
}
#endif

bool kind_tabulate(Joint *joint, Text *why)
{
    Kind *kind = &joint->kind;
    double head[3], share[2 * HYSTERESIS_SLIDERS], amplitudes[N_HARMONICS], stiffness;
    *kind = (Kind){.errs = false};
    error_amplitudes(0, joint->c, amplitudes);
    for (int i = 0; i < N_HARMONICS; i++)
        kind->errs |= amplitudes[i] != 0.0;
    brake(0, joint->c, &stiffness);
    friction_of(&kind->friction, stiffness);
    hysteresis_head(0, joint->c, head);
    slider_shares(0, joint->c, share);
    return midline_of(joint, why) &&
        hysteresis_of(&kind->hysteresis, head, share, &joint->curve, why);
}

enum { N_ERROR = 3 }; /* kinematic error, its first and its second derivative in phi1 */

static void error_at(const Joint *joint, const double *inputs, double *error)
{
    if (joint->kind.errs)
        kinematic_error(inputs, joint->c, error);
    else
        error[0] = error[1] = error[2] = 0.0;
}

/* Wind-up at inputs, coming from a memory; they are motion or torque. */
static double wind_up(const Joint *joint, const double *inputs, double error, const double *memory)
{
    double x[N_INPUTS + 1], at;
    memcpy(x, inputs, N_INPUTS * sizeof(double));
    x[N_INPUTS] = error;
    argument(x, joint->c, &at);
    if (!ARGUMENT_IS_LOAD)
        return at;
    if (joint->kind.hysteresis.acts)
        return hysteresis_wind_up(&joint->kind.hysteresis, &joint->curve, memory, at);
    return midline_inverse(&joint->curve, at);
}

/* What the outputs are made of: inputs, and what a motion finds in the spring. */
enum { PHI = N_INPUTS, LOAD, STIFF, SLID, LOSS, ERROR, SLOPE, DRY, N_GIVEN };
/* What the friction is made of: inputs, torques of curve and hysteresis, slope of the kinematic error. */
enum { TURN_LOAD = N_INPUTS, TURN_SLID, TURN_SLOPE, N_TURN };

/* The inputs of `turn` out of those of `outputs`. */
static void to_turn(const double *x, double *y)
{
    memcpy(y, x, N_INPUTS * sizeof(double));
    y[TURN_LOAD] = x[LOAD];
    y[TURN_SLID] = x[SLID];
    y[TURN_SLOPE] = x[SLOPE];
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *out,
                    Text *why)
{
    Kind *kind = &joint->kind;
    double x[N_GIVEN], error[N_ERROR];
    (void)why;
    error_at(joint, inputs, error);
    kind->phi = wind_up(joint, inputs, error[0], memory);
    memset(after, 0, N_MEMORY * sizeof *after);
    kind->slid = kind->braked = (SliderSum){.loss = 0.0};
    if (kind->hysteresis.acts)
        kind->slid = hysteresis_at(&kind->hysteresis, memory, kind->phi, after);
    memcpy(x, inputs, N_INPUTS * sizeof(double));
    x[PHI] = kind->phi;
    midline(&joint->curve, kind->phi, 1, &x[LOAD]);
    x[SLID] = kind->slid.force[0];
    x[ERROR] = error[0];
    x[SLOPE] = error[1];
    if (kind->friction.acts) {
        double given[N_TURN], y[4];
        to_turn(x, given);
        turn(given, joint->c, y);
        kind->turn = (Turn){y[0], y[1], {y[2], y[3]}};
        kind->braked = friction_at(&kind->friction, memory, kind->turn, after);
    }
    x[DRY] = kind->braked.force[0];
    x[LOSS] = memory[AT_LOSS] + kind->slid.loss + kind->braked.loss;
    after[AT_WIND_UP] = kind->phi;
    after[AT_LOSS] = x[LOSS];
    outputs(x, joint->c, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    (void)after;
    const Kind *kind = &joint->kind;
    double x[2 * N_GIVEN] = {0.0}, y[3], at[2 * (N_INPUTS + 1)], error[N_ERROR], rate;
    error_at(joint, inputs, error);
    for (int i = 0; i < N_INPUTS; i++) {
        x[i] = at[i] = inputs[i];
        x[N_GIVEN + i] = at[N_INPUTS + 1 + i] = seed[i];
    }
    at[N_INPUTS] = error[0];
    at[2 * N_INPUTS + 1] = error[1] * seed[0];
    argument_seed(at, joint->c, &rate);
    midline(&joint->curve, kind->phi, 2, y);
    if (ARGUMENT_IS_LOAD)
        rate /= y[1] + kind->slid.tangent[0];
    const double heat = kind->hysteresis.acts ? hysteresis_heat(&kind->hysteresis, memory, kind->phi) : 0.0;
    const double slid = kind->slid.tangent[0] * rate, loss = memory[AT_LOSS] + kind->slid.loss + kind->braked.loss;
    const double given[] = {kind->phi, y[0], y[1], kind->slid.force[0], loss, error[0], error[1], kind->braked.force[0]};
    const double slopes[] = {rate, y[1] * rate, y[2] * rate, slid, heat * rate, error[1] * seed[0],
                             error[2] * seed[0], 0.0};
    memcpy(x + PHI, given, sizeof given);
    memcpy(x + N_GIVEN + PHI, slopes, sizeof slopes);
    if (kind->friction.acts) {
        double turning[2 * N_TURN], drift[4];
        to_turn(x, turning);
        to_turn(x + N_GIVEN, turning + N_TURN);
        turn_seed(turning, joint->c, drift);
        const SliderSum brakes =
            friction_rate(&kind->friction, memory, kind->turn, (Turn){drift[0], drift[1], {drift[2], drift[3]}});
        x[N_GIVEN + DRY] = brakes.force[0];
        x[N_GIVEN + LOSS] += brakes.loss;
    }
    outputs_seed(x, joint->c, result);
}
