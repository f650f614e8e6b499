/* Midline, hysteresis and friction of a drive. Repeats hysteresis.py and friction.py of the package; return mapping,
 * shares and limits of the sliders are generated. */
#include "harmonic_drive.h"

#include <math.h>

#include "model.h"

enum { HYSTERESIS_LOSS, HYSTERESIS_STIFFNESS, RATED_TORQUE }; /* results of `hysteresis_constants` */

void midline_torque(const Curve *curve, double phi, int order, double *y)
{
    curve_evaluate(curve, fabs(phi), order, y);
    y[0] = copysign(y[0], phi);
    if (order == 2)
        y[2] = phi < 0.0 ? -y[2] : y[2];
}

double midline_wind_up(const Curve *curve, double torque)
{
    double load_at_result;
    int segment_hint = 0;
    return copysign(curve_inverse(curve, fabs(torque), &segment_hint, &load_at_result), torque);
}

/* Hysteresis */

_Static_assert(HYSTERESIS_SLIDER_COUNT % 4 == 0, "as sliders_advance_1d requires");

static Sliders1D hysteresis_sliders(const Hysteresis *h, const double *history)
{
    return (Sliders1D){h->K, h->compliance, h->limit, h->limit, history + HISTORY_FORCE};
}

SliderResultant hysteresis_advance(const Hysteresis *hysteresis, const double *history, double phi, double *history_end)
{
    const Sliders1D sliders = hysteresis_sliders(hysteresis, history);
    SliderResultant sum;
    sliders_advance_1d(hysteresis->use_avx, HYSTERESIS_SLIDER_COUNT, &sliders, phi - history[HISTORY_WIND_UP],
                       history_end + HISTORY_FORCE, &sum);
    return sum;
}

double hysteresis_loss_derivative(const Hysteresis *hysteresis, const double *history, double phi)
{
    const Sliders1D sliders = hysteresis_sliders(hysteresis, history);
    return sliders_loss_derivative_1d(HYSTERESIS_SLIDER_COUNT, &sliders, phi - history[HISTORY_WIND_UP]);
}

double hysteresis_solve_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *history, double torque)
{
    const double lower = midline_wind_up(curve, torque - hysteresis->limit_torque);
    const double upper = midline_wind_up(curve, torque + hysteresis->limit_torque);
    const Sliders1D sliders = hysteresis_sliders(hysteresis, history);
    double phi = fmin(fmax(history[HISTORY_WIND_UP], lower), upper), low = -INFINITY, high = INFINITY;
    for (int k = 0; k < MAX_INVERSION_ITERATIONS; k++) {
        double y[2], tangent;
        midline_torque(curve, phi, 1, y);
        const double residual =
            torque -
            (y[0] + sliders_force_1d(HYSTERESIS_SLIDER_COUNT, &sliders, phi - history[HISTORY_WIND_UP], &tangent));
        const double step = phi + residual / (y[1] + tangent);
        if (residual > 0.0)
            low = phi;
        else if (residual < 0.0)
            high = phi;
        const double next = step >= low && step <= high ? step : 0.5 * (low + high);
        const double change = fabs(next - phi);
        phi = next;
        if (change <= WIND_UP_TOLERANCE * (fabs(phi) + hysteresis->characteristic_wind_up))
            break;
    }
    return phi;
}

/* Negative friction torque [N.m] on unloading from a torque [N.m], at the wind-up half_opening [rad], by Masing's
 * rule. */
static double unloading_friction(const Hysteresis *hysteresis, const Curve *curve, double torque, double half_opening)
{
    const double virgin[N_HISTORY] = {0.0};
    const double turn_wind_up = hysteresis_solve_wind_up(hysteresis, curve, virgin, torque);
    const Sliders1D sliders = hysteresis_sliders(hysteresis, virgin);
    double tangent;
    return 2.0 * sliders_force_1d(HYSTERESIS_SLIDER_COUNT, &sliders, 0.5 * (turn_wind_up - half_opening), &tangent) -
           sliders_force_1d(HYSTERESIS_SLIDER_COUNT, &sliders, turn_wind_up, &tangent);
}

/* K_h [N.m/rad]; half_loop_torque is the torque of the midline at half of hysteresis_loss. */
static double initial_stiffness(const double *constants, const Curve *curve, double half_loop_torque)
{
    if (constants[HYSTERESIS_STIFFNESS] > 0.0)
        return constants[HYSTERESIS_STIFFNESS];
    const double back =
        curve_inverse_safeguarded(curve, constants[RATED_TORQUE] - half_loop_torque) - 0.5 * constants[HYSTERESIS_LOSS];
    return fmax(curve->start.stiffness, 2.0 * MIN_UNLOADING_OVER_REVERSAL_WIND_UP * half_loop_torque / back);
}

/* Set M_f and what follows from it. */
static void set_limit_torque(Hysteresis *hysteresis, const double *shares, double limit, double stiffness)
{
    hysteresis->has_friction = limit > 0.0;
    hysteresis->limit_torque = limit;
    hysteresis->characteristic_wind_up = limit / stiffness;
    for (int i = 0; i < HYSTERESIS_SLIDER_COUNT; i++)
        hysteresis->limit[i] = limit * shares[HYSTERESIS_SLIDER_COUNT + i];
}

bool hysteresis_tabulate(Hysteresis *hysteresis, const double *constants, const double *shares, const Curve *curve,
                         Text *reason)
{
    double y[2];
    curve_evaluate(curve, 0.5 * constants[HYSTERESIS_LOSS], 1, y);
    const double half_loop_torque = y[0];
    if (!(half_loop_torque < 0.5 * constants[RATED_TORQUE])) {
        text_append_format(
            reason,
            "hysteresis_loss = %g rad is outside [0, %g) rad: above it the hysteresis friction would exceed half of "
            "the rated torque",
            constants[HYSTERESIS_LOSS], 2.0 * curve_inverse_safeguarded(curve, 0.5 * constants[RATED_TORQUE]));
        return false;
    }
    const double stiffness = initial_stiffness(constants, curve, half_loop_torque);
    for (int i = 0; i < HYSTERESIS_SLIDER_COUNT; i++) {
        hysteresis->K[i] = stiffness * shares[i];
        hysteresis->compliance[i] = 1.0 / hysteresis->K[i];
    }
    double limit = half_loop_torque;
    for (int k = 0; k < MAX_FRICTION_LIMIT_ITERATIONS; k++) {
        set_limit_torque(hysteresis, shares, limit, stiffness);
        if (!hysteresis->has_friction)
            return true;
        const double previous = limit, opening_friction = unloading_friction(hysteresis, curve, constants[RATED_TORQUE],
                                                                             0.5 * constants[HYSTERESIS_LOSS]);
        limit *= opening_friction > 0.0 ? half_loop_torque / opening_friction : INFINITY;
        if (!(limit < constants[RATED_TORQUE]))
            break;
        if (fabs(limit - previous) <= FRICTION_LIMIT_TOLERANCE * limit)
            return true;
    }
    text_append_format(
        reason,
        "hysteresis_stiffness = %g N.m/rad is too small for a loop up to rated torque with hysteresis_loss = %g rad; "
        "expected a larger value, or 0 for the default",
        constants[HYSTERESIS_STIFFNESS], constants[HYSTERESIS_LOSS]);
    return false;
}

/* Friction at the wave generator */

_Static_assert(FRICTION_SLIDER_COUNT % 4 == 0, "as sliders_advance_1d requires");

void friction_tabulate(Friction *friction, double stiffness)
{
    friction->has_friction = stiffness > 0.0;
    for (int i = 0; i < FRICTION_SLIDER_COUNT; i++) {
        friction->K[i] = stiffness * STIFFNESS_SHARES[i];
        friction->compliance[i] = friction->has_friction ? 1.0 / friction->K[i] : 0.0;
    }
}

/* Angle [rad] that the wave generator has rotated in the load step. In the first one it comes from its speed, see
 * PRIOR_ROTATION_TIME. */
static double rotation_increment(const double *history, FrictionArguments arguments)
{
    return history[HISTORY_BEGUN] > 0.0 ? arguments.angle - history[HISTORY_ANGLE]
                                        : PRIOR_ROTATION_TIME * arguments.speed;
}

/* Friction limits of the sliders: each has that of the sign of its elastic predictor. */
static inline void slider_limits(const Friction *friction, const double *history, double increment,
                                 const double *limit, double *restrict slider_limit)
{
    const double positive = limit[0], negative = limit[1];
    for (int i = 0; i < FRICTION_SLIDER_COUNT; i++)
        slider_limit[i] =
            (history[HISTORY_FRICTION_TORQUE + i] + friction->K[i] * increment < 0.0 ? negative : positive) *
            LIMIT_SHARES[i];
}

SliderResultant friction_advance(const Friction *friction, const double *history, FrictionArguments arguments,
                                 double *history_end)
{
    double limit_start[FRICTION_SLIDER_COUNT], limit_end[FRICTION_SLIDER_COUNT];
    const double increment = rotation_increment(history, arguments);
    slider_limits(friction, history, increment, history + HISTORY_LIMIT, limit_start);
    slider_limits(friction, history, increment, arguments.limit, limit_end);
    const Sliders1D sliders = {friction->K, friction->compliance, limit_start, limit_end,
                               history + HISTORY_FRICTION_TORQUE};
    SliderResultant sum;
    sliders_advance_1d(friction->use_avx, FRICTION_SLIDER_COUNT, &sliders, increment,
                       history_end + HISTORY_FRICTION_TORQUE, &sum);
    history_end[HISTORY_ANGLE] = arguments.angle;
    history_end[HISTORY_LIMIT] = arguments.limit[0];
    history_end[HISTORY_LIMIT + 1] = arguments.limit[1];
    history_end[HISTORY_BEGUN] = 1.0;
    if (!(history[HISTORY_BEGUN] > 0.0))
        sum.loss = 0.0;
    return sum;
}

SliderResultant friction_rate(const Friction *friction, const double *history, FrictionArguments arguments,
                              FrictionArguments rate)
{
    const bool has_begun = history[HISTORY_BEGUN] > 0.0;
    double limit_start[FRICTION_SLIDER_COUNT], limit_end[FRICTION_SLIDER_COUNT], limit_rate[FRICTION_SLIDER_COUNT];
    const double increment = rotation_increment(history, arguments);
    slider_limits(friction, history, increment, history + HISTORY_LIMIT, limit_start);
    slider_limits(friction, history, increment, arguments.limit, limit_end);
    slider_limits(friction, history, increment, rate.limit, limit_rate);
    const Sliders1D sliders = {friction->K, friction->compliance, limit_start, limit_end,
                               history + HISTORY_FRICTION_TORQUE};
    SliderResultant sum;
    sliders_advance_1d_rate(FRICTION_SLIDER_COUNT, &sliders, increment,
                            has_begun ? rate.angle : PRIOR_ROTATION_TIME * rate.speed, limit_rate, &sum);
    if (!has_begun)
        sum.loss = 0.0;
    return sum;
}
