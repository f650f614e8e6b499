/* Repeats `Hysteresis` and `Friction` of the package; the rule of a slider, their shares and limits are generated. */
#include "harmonic_drive.h"

#include <math.h>

#include "model.h"

enum { LOSS, STIFFNESS, RATED }; /* of the drive's numbers */

void midline(const Curve *curve, double phi, int order, double *y)
{
    curve_at(curve, fabs(phi), order, y);
    y[0] = copysign(y[0], phi);
    if (order == 2)
        y[2] = phi < 0.0 ? -y[2] : y[2];
}

double midline_inverse(const Curve *curve, double torque)
{
    double carried;
    int nearest = 0;
    return copysign(curve_inverse(curve, fabs(torque), &nearest, &carried), torque);
}

/* Hysteresis */

_Static_assert(HYSTERESIS_SLIDERS % 4 == 0, "as sliders_line needs them");

static Sliders sliders_of(const Hysteresis *h, const double *memory)
{
    return (Sliders){h->K, h->per_K, h->limit, h->limit, memory + AT_FORCE};
}

SliderSum hysteresis_at(const Hysteresis *hysteresis, const double *memory, double phi, double *after)
{
    const Sliders s = sliders_of(hysteresis, memory);
    SliderSum sum;
    sliders_line(HYSTERESIS_SLIDERS, &s, phi - memory[AT_WIND_UP], after + AT_FORCE, &sum);
    return sum;
}

double hysteresis_heat(const Hysteresis *hysteresis, const double *memory, double phi)
{
    const Sliders s = sliders_of(hysteresis, memory);
    return sliders_heat(HYSTERESIS_SLIDERS, &s, phi - memory[AT_WIND_UP]);
}

double hysteresis_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *memory,
                          double torque)
{
    const double least = midline_inverse(curve, torque - hysteresis->most);
    const double largest = midline_inverse(curve, torque + hysteresis->most);
    const Sliders sliders = sliders_of(hysteresis, memory);
    double phi = fmin(fmax(memory[AT_WIND_UP], least), largest), low = -INFINITY, high = INFINITY;
    for (int k = 0; k < MAX_ITERATIONS; k++) {
        double y[2], tangent;
        midline(curve, phi, 1, y);
        const double rest = torque - (y[0] + sliders_force(HYSTERESIS_SLIDERS, &sliders, phi - memory[AT_WIND_UP], &tangent));
        const double step = phi + rest / (y[1] + tangent);
        if (rest > 0.0)
            low = phi;
        else if (rest < 0.0)
            high = phi;
        const double next = step >= low && step <= high ? step : 0.5 * (low + high);
        const double change = fabs(next - phi);
        phi = next;
        if (change <= WIND_UP_TOLERANCE * (fabs(phi) + hysteresis->length))
            break;
    }
    return phi;
}

/* Friction against the midline on the way back from a torque, at a wind-up. */
static double opening(const Hysteresis *hysteresis, const Curve *curve, double torque, double half)
{
    const double rest[N_MEMORY] = {0.0};
    const double turn = hysteresis_wind_up(hysteresis, curve, rest, torque);
    const Sliders s = sliders_of(hysteresis, rest);
    double tangent;
    return 2.0 * sliders_force(HYSTERESIS_SLIDERS, &s, 0.5 * (turn - half), &tangent) -
        sliders_force(HYSTERESIS_SLIDERS, &s, turn, &tangent);
}

static double extra_stiffness(const double *head, const Curve *curve, double least)
{
    if (head[STIFFNESS] > 0.0)
        return head[STIFFNESS];
    const double back = curve_inverse_safe(curve, head[RATED] - least) - 0.5 * head[LOSS];
    return fmax(curve->first.s, 2.0 * MIN_REVERSAL_RATIO * least / back);
}

static void set_limit(Hysteresis *hysteresis, const double *share, double limit, double stiffness)
{
    hysteresis->acts = limit > 0.0;
    hysteresis->most = limit;
    hysteresis->length = limit / stiffness;
    for (int i = 0; i < HYSTERESIS_SLIDERS; i++)
        hysteresis->limit[i] = limit * share[HYSTERESIS_SLIDERS + i];
}

bool hysteresis_of(Hysteresis *hysteresis, const double *head, const double *share, const Curve *curve,
                   Text *why)
{
    double y[2];
    curve_at(curve, 0.5 * head[LOSS], 1, y);
    const double least = y[0];
    if (!(least < 0.5 * head[RATED])) {
        text_print(why, "hysteresis_loss = %g rad is outside [0, %g) rad: above it the hysteresis friction would exceed half of the rated torque",
                   head[LOSS], 2.0 * curve_inverse_safe(curve, 0.5 * head[RATED]));
        return false;
    }
    const double stiffness = extra_stiffness(head, curve, least);
    for (int i = 0; i < HYSTERESIS_SLIDERS; i++) {
        hysteresis->K[i] = stiffness * share[i];
        hysteresis->per_K[i] = 1.0 / hysteresis->K[i];
    }
    double limit = least;
    for (int k = 0; k < MAX_LIMIT_ITERATIONS; k++) {
        set_limit(hysteresis, share, limit, stiffness);
        if (!hysteresis->acts)
            return true;
        const double before = limit, open = opening(hysteresis, curve, head[RATED], 0.5 * head[LOSS]);
        limit *= open > 0.0 ? least / open : INFINITY;
        if (!(limit < head[RATED]))
            break;
        if (fabs(limit - before) <= LIMIT_TOLERANCE * limit)
            return true;
    }
    text_print(why,
               "hysteresis_stiffness = %g N.m/rad is too small for a loop through rated torque that opens by %g rad; "
               "allowed are 0 and larger ones",
               head[STIFFNESS], head[LOSS]);
    return false;
}

/* Friction at the wave generator */

_Static_assert(FRICTION_SLIDERS % 4 == 0, "as sliders_line needs them");

void friction_of(Friction *friction, double stiffness)
{
    friction->acts = stiffness > 0.0;
    for (int i = 0; i < FRICTION_SLIDERS; i++) {
        friction->K[i] = stiffness * BRAKE_SPRINGS[i];
        friction->per_K[i] = friction->acts ? 1.0 / friction->K[i] : 0.0;
    }
}

/* On the first path the drive has turned to where it is. */
static double way(const double *memory, Turn turn)
{
    return memory[AT_BEGUN] > 0.0 ? turn.angle - memory[AT_ANGLE] : PRIOR_ROTATION_TIME * turn.speed;
}

/* Each slider is held by the limit on the side of the force that it would have if it stuck. */
static void limits_at(const Friction *friction, const double *memory, double shift, const double *limit,
                      double *each)
{
    for (int i = 0; i < FRICTION_SLIDERS; i++)
        each[i] = limit[memory[AT_BRAKE + i] + friction->K[i] * shift < 0.0] * BRAKE_LIMITS[i];
}

SliderSum friction_at(const Friction *friction, const double *memory, Turn turn, double *after)
{
    double start[FRICTION_SLIDERS], end[FRICTION_SLIDERS];
    const double shift = way(memory, turn);
    limits_at(friction, memory, shift, memory + AT_LIMIT, start);
    limits_at(friction, memory, shift, turn.limit, end);
    const Sliders s = {friction->K, friction->per_K, start, end, memory + AT_BRAKE};
    SliderSum sum;
    sliders_line(FRICTION_SLIDERS, &s, shift, after + AT_BRAKE, &sum);
    after[AT_ANGLE] = turn.angle;
    after[AT_LIMIT] = turn.limit[0];
    after[AT_LIMIT + 1] = turn.limit[1];
    after[AT_BEGUN] = 1.0;
    if (!(memory[AT_BEGUN] > 0.0))
        sum.loss = 0.0;
    return sum;
}

SliderSum friction_rate(const Friction *friction, const double *memory, Turn turn, Turn rate)
{
    const bool begun = memory[AT_BEGUN] > 0.0;
    double start[FRICTION_SLIDERS], end[FRICTION_SLIDERS], rises[FRICTION_SLIDERS];
    const double shift = way(memory, turn);
    limits_at(friction, memory, shift, memory + AT_LIMIT, start);
    limits_at(friction, memory, shift, turn.limit, end);
    limits_at(friction, memory, shift, rate.limit, rises);
    const Sliders s = {friction->K, friction->per_K, start, end, memory + AT_BRAKE};
    SliderSum sum;
    sliders_line_rate(FRICTION_SLIDERS, &s, shift, begun ? rate.angle : PRIOR_ROTATION_TIME * rate.speed, rises, &sum);
    if (!begun)
        sum.loss = 0.0;
    return sum;
}
