#include "instance.h"

#include <math.h>
#include <string.h>

/* Refusals: the line says which value is wrong and what is allowed. */

static Status refuse(const Instance *m, const Text *why)
{
    instance_report(m, ERROR, LOG_ERRORS, why->line);
    return ERROR;
}

static bool inside(const Variable *v, double value)
{
    if (value > v->low && value < v->high)
        return true;
    return isfinite(value) && ((value == v->low && !v->low_open) || (value == v->high && !v->high_open));
}

static void add_value(Text *text, const Variable *v, double value, int digits)
{
    text_add(text, v->name);
    text_add(text, " = ");
    text_number(text, value, digits);
    if (v->unit[0]) {
        text_add(text, " ");
        text_add(text, v->unit);
    }
}

static void add_outside(Text *text, const Variable *v, double value, int digits)
{
    add_value(text, v, value, digits);
    text_add(text, " is outside ");
    text_add(text, v->interval);
    text_add(text, ": ");
    text_add(text, v->doc);
}

/* Parameters and tables */

static void check_parameter(Text *why, const Variable *v, double value)
{
    const bool in = inside(v, value);
    if (in && !(v->whole && value != floor(value)))
        return;
    if (why->length)
        text_add(why, "; ");
    if (in) {
        add_value(why, v, value, 6);
        text_add(why, " is no whole number, allowed are 1, 2, 3, ...");
    } else {
        add_outside(why, v, value, 10);
    }
}

/* Make the tables those of the present parameters. */
static bool tabulate(Instance *m)
{
    const double *parameters = m->now.values + FIRST_PARAMETER;
    if (m->tables_right && memcmp(m->tabulated, parameters, sizeof m->tabulated) == 0) {
        m->parameters_changed = false;
        return true;
    }
    Text why;
    text_clear(&why);
    for (size_t i = 0; i < N_PARAMETERS; i++)
        check_parameter(&why, &variables[FIRST_PARAMETER + i], parameters[i]);
    if (why.length) {
        refuse(m, &why);
        return false;
    }
    const bool again = m->tables_right;
    m->tables_right = joint_tabulate(m->joint, parameters, &why);
    if (!m->tables_right) {
        refuse(m, &why);
        return false;
    }
    memcpy(m->tabulated, parameters, sizeof m->tabulated);
    m->parameters_changed = false;
    if (again)
        instance_report(m, OK, LOG_EVENTS, "tables evaluated again for changed parameters");
    return true;
}

/* Outputs */

static Status refuse_input(const Instance *m, size_t i)
{
    Text why;
    text_clear(&why);
    add_outside(&why, &variables[FIRST_INPUT + i], m->now.values[FIRST_INPUT + i], 6);
    return refuse(m, &why);
}

static Status refuse_outputs(const Instance *m)
{
    Text why;
    text_clear(&why);
    const char *between = "";
    size_t bad = 0;
    while (isfinite(m->now.values[FIRST_OUTPUT + bad]))
        bad++;
    for (size_t i = FIRST_INPUT; i < FIRST_OUTPUT; i++)
        if (m->now.values[i] != 0.0) {
            text_add(&why, between);
            add_value(&why, &variables[i], m->now.values[i], 6);
            between = ", ";
        }
    text_add(&why, ": too large, ");
    text_add(&why, variables[FIRST_OUTPUT + bad].name);
    text_add(&why, " is not finite");
    return refuse(m, &why);
}

static void warn(Instance *m, unsigned outside)
{
    const double *values = m->now.values;
    for (unsigned bit = 1; bit && bit <= outside; bit <<= 1)
        if (outside & bit) {
            Text text;
            text_clear(&text);
            joint_warning(m->joint, values + FIRST_INPUT, values + FIRST_OUTPUT, bit, &text);
            instance_report(m, WARNING, LOG_WARNINGS, text.line);
        }
    m->now.warned |= outside;
}

Status instance_evaluate(Instance *m)
{
    if (!m->dirty)
        return OK;
    if (m->parameters_changed && !tabulate(m))
        return ERROR;
    const double *inputs = m->now.values + FIRST_INPUT;
    double *outputs = m->now.values + FIRST_OUTPUT;
    for (size_t i = 0; i < N_INPUTS; i++)
        if (!inside(&variables[FIRST_INPUT + i], inputs[i]))
            return refuse_input(m, i);
    Text why;
    text_clear(&why);
    if (!joint_evaluate(m->joint, inputs, outputs, &why))
        return refuse(m, &why);
    bool finite = true;
    for (size_t i = 0; i < N_OUTPUTS; i++)
        finite &= fabs(outputs[i]) < INFINITY;
    if (!finite)
        return refuse_outputs(m);
    const unsigned outside = joint_outside(m->joint, inputs, outputs) & ~m->now.warned;
    if (outside)
        warn(m, outside);
    m->dirty = false;
    return OK;
}

/* Steps */

static bool has_slopes(const State *now)
{
    bool any = false;
    for (size_t i = 0; i < N_INPUTS; i++)
        any |= now->slopes[i] != 0.0;
    return any;
}

/* Evaluate at the end of a step, to which inputs with a derivative move; a refusal changes nothing. */
static Status evaluate_moved(Instance *m, double size)
{
    State *now = &m->now;
    double before[N_INPUTS], *inputs = now->values + FIRST_INPUT;
    for (size_t i = 0; i < N_INPUTS; i++) {
        before[i] = inputs[i];
        inputs[i] += now->slopes[i] * size;
    }
    m->dirty = true;
    if (instance_evaluate(m) != OK) {
        memcpy(inputs, before, sizeof before);
        return ERROR;
    }
    memset(now->slopes, 0, sizeof now->slopes);
    return OK;
}

static Status refuse_step(const Instance *m, const char *function, const char *what, double time, double size,
                          const char *expected, double limit)
{
    Text text;
    text_clear(&text);
    text_add(&text, what);
    text_add(&text, " at ");
    text_number(&text, time, 16);
    text_add(&text, " s with step ");
    text_number(&text, size, 16);
    text_add(&text, " s; expected ");
    text_add(&text, expected);
    text_number(&text, limit, 16);
    text_add(&text, " s");
    return instance_refuse(m, function, text.line);
}

/* A step over which states move; a refusal changes nothing. */
static Status step_moving(Instance *m, double size, double end)
{
    State *now = &m->now;
    const State before = *now;
    if (instance_evaluate(m) != OK)
        return ERROR;
    instance_advance(m, size);
    now->values[0] = end;
    m->dirty = true;
    const bool sloping = has_slopes(now);
    if ((sloping ? evaluate_moved(m, size) : instance_evaluate(m)) != OK) {
        *now = before;
        m->dirty = true;
        return ERROR;
    }
    return now->last_step = OK;
}

Status instance_step(Instance *m, const char *function, double time, double size)
{
    if (!instance_allows(m, function, CO_SIMULATION | STEP))
        return ERROR;
    State *now = &m->now;
    now->last_step = ERROR;
    const double end = time + size;
    if (!(size > 0.0 && isfinite(end)))
        return refuse_step(m, function, "no step is possible", time, size, "finite numbers and a step above ",
                           0.0);
    const double slack = 1e-5 * size + 1e-9 * fabs(time); /* hosts round times in their own ways */
    if (fabs(time - now->values[0]) > slack)
        return refuse_step(m, function, "the communication point is", time, size, "it at ", now->values[0]);
    if (end > now->stop + slack)
        return refuse_step(m, function, "the step ends after the stop time", time, size, "an end until ",
                           now->stop);
    if (MOVES)
        return step_moving(m, size, end);

    if ((has_slopes(now) ? evaluate_moved(m, size) : instance_evaluate(m)) != OK)
        return ERROR;
    now->values[0] = end;
    return now->last_step = OK;
}

/* Derivatives */

static Status refuse_derivative(const Instance *m, const char *function, uint32_t ref)
{
    Text text;
    text_clear(&text);
    text_add(&text, "the derivative of ");
    text_add(&text, variables[ref].name);
    text_add(&text, " is not finite; expected a finite seed, not too large");
    return instance_refuse(m, function, text.line);
}

Status instance_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                           const uint32_t knowns[], size_t n_knowns, const double seed[], double result[])
{
    if (!instance_can_differentiate(m, function, unknowns, n_unknowns, knowns, n_knowns) ||
        (n_knowns && !instance_has(m, function, "the seed", seed)) ||
        (n_unknowns && !instance_has(m, function, "the array of sensitivities", result)))
        return ERROR;
    double direction[N_INPUTS + N_STATES] = {0.0}, change[N_OUTPUTS];
    for (size_t i = 0; i < n_knowns; i++) {
        if (!isfinite(seed[i]))
            return refuse_derivative(m, function, knowns[i]);
        direction[knowns[i] - FIRST_INPUT] += seed[i];
    }
    joint_derivative(m->joint, m->now.values + FIRST_INPUT, direction, change);
    for (size_t i = 0; i < n_unknowns; i++) {
        result[i] = change[unknowns[i] - FIRST_OUTPUT];
        if (!isfinite(result[i]))
            return refuse_derivative(m, function, unknowns[i]);
    }
    return OK;
}

Status instance_adjoint(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                        const uint32_t knowns[], size_t n_knowns, const double seed[], double result[])
{
    if (!instance_can_differentiate(m, function, unknowns, n_unknowns, knowns, n_knowns) ||
        (n_unknowns && !instance_has(m, function, "the seed", seed)) ||
        (n_knowns && !instance_has(m, function, "the array of sensitivities", result)))
        return ERROR;
    for (size_t i = 0; i < n_unknowns; i++)
        if (!isfinite(seed[i]))
            return refuse_derivative(m, function, unknowns[i]);
    for (size_t j = 0; j < n_knowns; j++) {
        double direction[N_INPUTS + N_STATES] = {0.0}, change[N_OUTPUTS];
        direction[knowns[j] - FIRST_INPUT] = 1.0;
        joint_derivative(m->joint, m->now.values + FIRST_INPUT, direction, change);
        result[j] = 0.0;
        for (size_t i = 0; i < n_unknowns; i++)
            result[j] += seed[i] * change[unknowns[i] - FIRST_OUTPUT];
        if (!isfinite(result[j]))
            return refuse_derivative(m, function, knowns[j]);
    }
    return OK;
}
