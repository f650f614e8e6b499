#include "tabulated.h"

#include <math.h>
#include <string.h>

_Static_assert(N_WARNINGS <= 32, "joint_outside has a bit for each");

size_t joint_size(void)
{
    return sizeof(Joint);
}

static void text_interval(Text *text, double low, double high, bool low_open, bool high_open)
{
    text_print(text, "%s%g, %g%s", low_open ? "(" : "[", low, high, high_open ? ")" : "]");
}

/* Whether the ends are NaN, crossed, or differ by less than the digits that a message shows. */
static bool empty(double low, double high, bool open)
{
    if (low == high)
        return open;
    const double shown = 1e-5 * fmin(fabs(low), fabs(high));
    return !(low < high) || (high - low <= shown && shown < INFINITY);
}

static bool check_limits(const Joint *joint, Text *why)
{
    double ends[2 * N_LIMITS + 1];
    parameter_limits(0, joint->c, ends);
    for (int i = 0; i < N_LIMITS; i++) {
        const Limit *limit = &limits[i];
        const double value = joint->c[limit->parameter], low = ends[2 * i], high = ends[2 * i + 1];
        const bool above = limit->low_open ? value > low : value >= low;
        const bool below = limit->high_open ? value < high : value <= high;
        if (above && below)
            continue;
        const Variable *variable = &variables[FIRST_PARAMETER + limit->parameter];
        text_quantity(why, variable->name, value, 6, variable->unit);
        if (empty(low, high, limit->low_open || limit->high_open)) {
            text_add(why, ": the other parameters leave no value for it");
        } else {
            text_add(why, " is outside ");
            text_interval(why, low, high, limit->low_open, limit->high_open);
        }
        text_print(why, ": %s", limit->doc);
        return false;
    }
    return true;
}

bool joint_tabulate(Joint *joint, const double *parameters, Text *why)
{
    memcpy(joint->c, parameters, N_PARAMETERS * sizeof(double));
    memcpy(joint->c + N_PARAMETERS, data.fixed, N_FIXED * sizeof(double));
    law_constants(joint->c, 0, joint->c + N_PARAMETERS + N_FIXED);
    return check_limits(joint, why) && kind_tabulate(joint, why);
}

bool refined(Joint *joint, Tabulate tabulate, int steps, Text *why)
{
    for (int factor = 1; factor <= MAX_REFINEMENT; factor *= 2) {
        if (!tabulate(joint, steps * factor, why)) {
            if (why->length == 0)
                text_print(why, "the table needs more than %g nodes: the law is not smooth enough with these parameters",
                           (double)CURVE_NODES);
            return false;
        }
        if (joint->curve.error <= MAX_ERROR)
            return true;
    }
    text_print(why,
               "the table of %g nodes has an interpolation error of %.2g, allowed is %g: "
               "the law is not smooth enough with these parameters",
               (double)joint->curve.n, joint->curve.error, MAX_ERROR);
    return false;
}

/* Low and high end of every warning. */
static void outside(const Joint *joint, const double *inputs, double *ends)
{
    double x[N_INPUTS + 2];
    memcpy(x, inputs, N_INPUTS * sizeof(double));
    x[N_INPUTS] = joint->curve.end.x;
    x[N_INPUTS + 1] = joint->curve.end.y;
    outside_limits(x, joint->c, ends);
}

static double watched(const Warning *warning, const double *inputs, const double *outputs)
{
    return warning->variable < N_INPUTS ? inputs[warning->variable] : outputs[warning->variable - N_INPUTS];
}

unsigned joint_outside(Joint *joint, const double *inputs, const double *outputs)
{
    double ends[2 * N_WARNINGS];
    unsigned bits = 0;
    outside(joint, inputs, ends);
    for (unsigned i = 0; i < N_WARNINGS; i++) {
        const double value = watched(&warnings[i], inputs, outputs);
        if (value < ends[2 * i] || value > ends[2 * i + 1])
            bits |= 1u << i;
    }
    return bits;
}

void joint_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    double ends[2 * N_WARNINGS];
    unsigned i = 0;
    while (i + 1 < N_WARNINGS && bit != 1u << i)
        i++;
    outside(joint, inputs, ends);
    const Variable *variable = &variables[FIRST_INPUT + warnings[i].variable];
    const double low = ends[2 * i], high = ends[2 * i + 1];
    text_quantity(text, variable->name, watched(&warnings[i], inputs, outputs), 6, variable->unit);
    text_add(text, " is outside ");
    text_interval(text, low, high, isinf(low), isinf(high));
    text_print(text, variable->unit[0] ? " %s: %s" : "%s: %s", variable->unit, warnings[i].doc);
}
