#include "gear_contact.h"

#include <math.h>

#include "tabulated.h"

static const double NOTHING = 1e-200; /* pressure [Pa] below which no spot touches, as in the package */

static bool tabulate(Joint *joint, int steps, Text *why)
{
    Kind *kind = &joint->kind;
    return approach_tabulate(&kind->approach, &joint->curve, &kind->spots, joint->c, steps, why);
}

bool kind_tabulate(Joint *joint, Text *why)
{
    return spots_begin(&joint->kind.spots, joint->c, why) && refined(joint, tabulate, APPROACH_STEPS, why);
}

/* The curve and the law at a load: approach from first touch, stiffness, state; slopes of all in the
 * pressure behind. */
static bool look_up(const Joint *joint, double pressure, double *x, double *slopes, Text *why)
{
    const Kind *kind = &joint->kind;
    double y[3], state[2 * N_LAW_STATE], u, rate;
    const double delta = curve_inverse(&joint->curve, pressure);
    curve_at(&joint->curve, delta, 2, y);
    const double compliance = y[1] > 0.0 ? 1.0 / y[1] : 0.0;
    x[0] = delta - joint->curve.x[0];
    x[1] = y[1];
    slopes[0] = compliance;
    slopes[1] = y[2] * compliance;
    x[2] = x[3] = slopes[2] = slopes[3] = 0.0;
    if (!(pressure >= NOTHING))
        return true;
    u = approach_guess(&kind->approach, &joint->curve, delta);
    if (!spots_solve(&kind->spots, joint->c, pressure, &u, &rate, why))
        return false;
    law_state[spots_regime(&kind->spots, u)](&u, joint->c, state);
    for (int i = 0; i < N_LAW_STATE; i++) {
        x[2 + i] = state[i];
        slopes[2 + i] = state[N_LAW_STATE + i] / (rate * pressure);
    }
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, double *out, Text *why)
{
    double pressure, x[1 + 4], slopes[4];
    argument(inputs, joint->c, &pressure);
    x[0] = inputs[0];
    if (!look_up(joint, pressure, &x[1], slopes, why))
        return false;
    outputs(x, joint->c, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *seed, double *result)
{
    double pressure, rate, x[2 * (1 + 4)];
    const double at[2] = {inputs[0], seed[0]};
    Text ignored;
    text_clear(&ignored);
    argument(inputs, joint->c, &pressure);
    argument_seed(at, joint->c, &rate);
    x[0] = inputs[0];
    x[5] = seed[0];
    look_up(joint, pressure, &x[1], &x[6], &ignored);
    for (int i = 6; i < 10; i++)
        x[i] *= rate;
    outputs_seed(x, joint->c, result);
}
