/* Repeats `GearContactSpring.approach` of the package; the laws in it are generated. */
#include "gear_contact.h"

#include <math.h>

#include "tabulated.h"

_Static_assert(N_LAW_STATE == 2 || N_LAW_STATE == 0, "real contact area and its elastic part, unless the "
                                                       "law has them in closed form");

static bool tabulate(Joint *joint, int steps, Text *why)
{
    Kind *kind = &joint->kind;
    return approach_tabulate(&kind->approach, &joint->curve, &kind->spots, joint->c, steps, why);
}

bool kind_tabulate(Joint *joint, Text *why)
{
    return spots_begin(&joint->kind.spots, joint->c, why) && refined(joint, tabulate, APPROACH_STEPS, why);
}

enum { N_FOUND = 2 + N_LAW_STATE }; /* approach from first touch, stiffness, state */

/* The curve and the law at a pressure, and the slopes of all in it. Below the table of the law, while the
 * contact closes, and above it the law itself is asked. */
static bool look_up(const Joint *joint, double pressure, double *x, double *slopes, Text *why)
{
    const Kind *kind = &joint->kind;
    const Curve *curve = &joint->curve;
    double y[3], carried;
    int nearest = 0;
    const double delta = curve_inverse(curve, pressure, &nearest, &carried);
    curve_at(curve, delta, 2, y);
    const double compliance = y[1] > 0.0 ? 1.0 / y[1] : 0.0;
    x[0] = delta - curve->x[0];
    x[1] = y[1];
    slopes[0] = compliance;
    slopes[1] = y[2] * compliance;
    if (delta >= 0.0 && delta < curve->end.x) {
        const int segment = curve_segment(curve, delta);
        const double t = (delta - curve->x[segment]) * curve->per[segment];
        approach_state(&kind->approach, curve, segment, t, x + 2, slopes + 2);
        for (int q = 0; q < N_LAW_STATE; q++)
            slopes[2 + q] *= compliance;
        return true;
    }
    for (int q = 0; q < N_LAW_STATE; q++)
        x[2 + q] = slopes[2 + q] = 0.0;
    const double u = delta < 0.0 ? kind->approach.first : kind->approach.last;
    return !(pressure >= MIN_PRESSURE) ||
           approach_exact(&kind->spots, joint->c, pressure, u, x + 2, slopes + 2, why);
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *out,
                    Text *why)
{
    double pressure, x[1 + N_FOUND], slopes[N_FOUND];
    (void)memory, (void)after;
    argument(inputs, joint->c, &pressure);
    x[0] = inputs[0];
    if (!look_up(joint, pressure, &x[1], slopes, why))
        return false;
    outputs(x, joint->c, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    (void)after;
    enum { N = 1 + N_FOUND };
    double pressure, rate, x[2 * N];
    const double at[2] = {inputs[0], seed[0]};
    Text ignored;
    (void)memory;
    text_clear(&ignored);
    argument(inputs, joint->c, &pressure);
    argument_seed(at, joint->c, &rate);
    x[0] = inputs[0];
    x[N] = seed[0];
    look_up(joint, pressure, &x[1], &x[N + 1], &ignored);
    for (int i = N + 1; i < 2 * N; i++)
        x[i] *= rate;
    outputs_seed(x, joint->c, result);
}
