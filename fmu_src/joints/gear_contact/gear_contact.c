/* Repeats `GearContactSpring` of the package; the functions of the law are generated. */
#include "gear_contact.h"

#include <math.h>

#include "tabulated_joint.h"

_Static_assert(N_LAW_STATE == 2 || N_LAW_STATE == 0, "real contact area and its elastic fraction, unless the "
                                                     "law has them in closed form");

static bool tabulate(Joint *joint, int steps, Text *reason)
{
    JointModel *model = &joint->model;
    return tabulate_approach(&model->approach, &joint->curve, &model->spots, joint->constants, steps, reason);
}

bool tabulate_model(Joint *joint, Text *reason)
{
    return set_spot_distribution(&joint->model.spots, joint->constants, reason) &&
           refine_curve(joint, tabulate, APPROACH_STEPS, reason);
}

enum { N_CURVE_RESULTS = 2 + N_LAW_STATE }; /* approach from first contact, stiffness, law state */

/* Results x of curve and law at a pressure, and their derivatives with respect to it. In the closing of the contact and
 * beyond the table, the law state is computed by the law instead of the table. */
static bool evaluate_curve(const Joint *joint, double pressure, double *x, double *slopes, Text *reason)
{
    const JointModel *model = &joint->model;
    const Curve *curve = &joint->curve;
    double y[3], load_at_result;
    int segment_hint = 0;
    const double delta = curve_inverse(curve, pressure, &segment_hint, &load_at_result);
    const bool is_inside = delta >= 0.0 && delta < curve->end.x; /* neither in the closing nor beyond the table */
    int segment = 0;
    double t = 0.0;
    if (is_inside) {
        segment = curve_find_segment(curve, delta);
        t = segment_parameter(curve, segment, delta);
        segment_derivatives(curve, segment, t, 2, y);
    } else {
        curve_evaluate(curve, delta, 2, y);
    }
    const double compliance = y[1] > 0.0 ? 1.0 / y[1] : 0.0;
    x[0] = delta - curve->segments[0].x;
    x[1] = y[1];
    slopes[0] = compliance;
    slopes[1] = y[2] * compliance;
    if (is_inside) {
        interpolate_law_state(curve, segment, t, x + 2, slopes + 2);
        for (int q = 0; q < N_LAW_STATE; q++)
            slopes[2 + q] *= compliance;
        return true;
    }
    for (int q = 0; q < N_LAW_STATE; q++)
        x[2 + q] = slopes[2 + q] = 0.0;
    const double u = delta < 0.0 ? model->approach.first_log_area : model->approach.last_log_area;
    return !(pressure >= MIN_PRESSURE) ||
           evaluate_law_state(&model->spots, joint->constants, pressure, u, x + 2, slopes + 2, reason);
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *out, Text *reason)
{
    double pressure, x[1 + N_CURVE_RESULTS], slopes[N_CURVE_RESULTS];
    (void)history, (void)history_end, (void)n_outputs;
    curve_argument(inputs, joint->constants, &pressure);
    x[0] = inputs[0];
    if (!evaluate_curve(joint, pressure, &x[1], slopes, reason))
        return false;
    outputs(x, joint->constants, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history_end;
    enum { N = 1 + N_CURVE_RESULTS };
    double pressure, rate, x[2 * N];
    const double input_and_seed[2] = {inputs[0], seed[0]};
    Text ignored;
    (void)history, (void)n_outputs;
    text_clear(&ignored);
    curve_argument(inputs, joint->constants, &pressure);
    curve_argument_seed(input_and_seed, joint->constants, &rate);
    x[0] = inputs[0];
    x[N] = seed[0];
    evaluate_curve(joint, pressure, &x[1], &x[N + 1], &ignored);
    for (int i = N + 1; i < 2 * N; i++)
        x[i] *= rate;
    outputs_seed(x, joint->constants, result);
}
