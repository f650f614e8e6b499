#include "tabulated_joint.h"

#include <math.h>
#include <string.h>

_Static_assert(N_VALIDITY_LIMITS <= 31, "joint_find_warnings has a bit for each, below LOST_START_VALUE");

size_t joint_size(void)
{
    return sizeof(Joint);
}

void joint_free_tables(Joint *joint)
{
    curve_free(&joint->curve);
}

static void append_interval(Text *text, double low, double high, bool low_open, bool high_open)
{
    text_append_format(text, "%s%g, %g%s", low_open ? "(" : "[", low, high, high_open ? ")" : "]");
}

/* Whether an interval has no values: its bounds are NaN, crossed, or equal to within the digits of a message. */
static bool is_empty_interval(double low, double high, bool open)
{
    if (low == high)
        return open;
    const double resolution = 1e-5 * fmin(fabs(low), fabs(high));
    return !(low < high) || (high - low <= resolution && resolution < INFINITY);
}

/* Check the intervals of parameters that depend on other parameters. */
static bool check_parameter_limits(const Joint *joint, Text *reason)
{
    double bounds[2 * N_PARAMETER_LIMITS + 1];
    parameter_limit_bounds(0, joint->constants, bounds);
    for (int i = 0; i < N_PARAMETER_LIMITS; i++) {
        const ParameterLimit *limit = &limited_parameters[i];
        const double value = joint->constants[limit->parameter], low = bounds[2 * i], high = bounds[2 * i + 1];
        const bool is_above = limit->low_open ? value > low : value >= low;
        const bool is_below = limit->high_open ? value < high : value <= high;
        if (is_above && is_below)
            continue;
        const Variable *variable = &variables[FIRST_PARAMETER + limit->parameter];
        text_append_quantity(reason, variable->name, value, 6, variable->unit);
        if (is_empty_interval(low, high, limit->low_open || limit->high_open)) {
            text_append(reason, ": the other parameters leave no value for it");
        } else {
            text_append(reason, " is outside ");
            append_interval(reason, low, high, limit->low_open, limit->high_open);
        }
        text_append_format(reason, ": %s", limit->doc);
        return false;
    }
    return true;
}

bool joint_tabulate(Joint *joint, const Data *joint_data, const double *parameters, Text *reason)
{
    memcpy(joint->constants, parameters, N_PARAMETERS * sizeof(double));
    joint->data = joint_data;
    memcpy(joint->constants + N_PARAMETERS, joint_data->hidden_parameters, N_HIDDEN_PARAMETERS * sizeof(double));
    law_constants(joint->constants, 0, joint->constants + N_PARAMETERS + N_HIDDEN_PARAMETERS);
    return check_parameter_limits(joint, reason) && tabulate_model(joint, reason);
}

bool refine_curve(Joint *joint, TabulateFunction tabulate, int steps, Text *reason)
{
    for (int factor = 1; factor <= MAX_STEP_COUNT_FACTOR; factor *= 2) {
        if (!tabulate(joint, steps * factor, reason)) {
            if (reason->length == 0)
                text_append_format(
                    reason,
                    "the table of the law needs more than %g nodes: "
                    "the law is not smooth enough with these parameters; check them for extreme values",
                    (double)CURVE_NODES);
            return false;
        }
        if (joint->curve.error <= MAX_INTERPOLATION_ERROR)
            return true;
    }
    text_append_format(reason,
                       "the table of the law has an interpolation error of %.2g with %g nodes, allowed is %g: "
                       "the law is not smooth enough with these parameters; check them for extreme values",
                       joint->curve.error, (double)joint->curve.n, MAX_INTERPOLATION_ERROR);
    return false;
}

/* Lower and upper bound of each validity limit. */
static void find_validity_bounds(const Joint *joint, const double *inputs, double *bounds)
{
    double x[N_INPUTS + 2];
    memcpy(x, inputs, N_INPUTS * sizeof(double));
    x[N_INPUTS] = joint->curve.end.x;
    x[N_INPUTS + 1] = joint->curve.end.y;
    validity_bounds(x, joint->constants, bounds);
}

/* Value of the variable of a validity limit. */
static double watched_value(const ValidityLimit *limit, const double *inputs, const double *outputs)
{
    return limit->variable < N_INPUTS ? inputs[limit->variable] : outputs[limit->variable - N_INPUTS];
}

unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *outputs)
{
    double bounds[2 * N_VALIDITY_LIMITS];
    unsigned warning_bits = 0;
    find_validity_bounds(joint, inputs, bounds);
    for (unsigned i = 0; i < N_VALIDITY_LIMITS; i++) {
        const double value = watched_value(&validity_limits[i], inputs, outputs);
        if (value < bounds[2 * i] || value > bounds[2 * i + 1])
            warning_bits |= 1u << i;
    }
    return warning_bits;
}

void joint_describe_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    double bounds[2 * N_VALIDITY_LIMITS];
    unsigned i = 0;
    while (i + 1 < N_VALIDITY_LIMITS && bit != 1u << i)
        i++;
    find_validity_bounds(joint, inputs, bounds);
    const Variable *variable = &variables[FIRST_INPUT + validity_limits[i].variable];
    const double low = bounds[2 * i], high = bounds[2 * i + 1];
    text_append_quantity(text, variable->name, watched_value(&validity_limits[i], inputs, outputs), 6, variable->unit);
    text_append(text, " is outside ");
    append_interval(text, low, high, isinf(low), isinf(high));
    text_append_format(text, variable->unit[0] ? " %s: %s" : "%s: %s", variable->unit, validity_limits[i].doc);
}
