#include <math.h>
#include <string.h>

#include "instance.h"

/* Errors in values: the message has name, value and allowed values. */

static Status log_refusal(const Instance *m, Status refusal, const Text *reason)
{
    instance_log(m, refusal, LOG_ERRORS, reason->line);
    return refusal;
}

/* Whether a variable has an allowed value. */
static bool is_inside(const Variable *v, double value)
{
    if (value > v->low && value < v->high)
        return true;
    return isfinite(value) && ((value == v->low && !v->low_open) || (value == v->high && !v->high_open));
}

static void append_outside_interval(Text *text, const Variable *v, double value, int digits)
{
    text_append_quantity(text, v->name, value, digits, v->unit);
    text_append_format(text, " is outside %s: %s", v->interval, v->doc);
}

/* Parameters and tables */

static void check_parameter(Text *reason, const Variable *v, double value)
{
    const bool is_in_interval = is_inside(v, value);
    if (is_in_interval && !(v->is_integer && value != floor(value)))
        return;
    if (reason->length)
        text_append(reason, "; ");
    if (is_in_interval) {
        text_append_quantity(reason, v->name, value, 6, v->unit);
        text_append(reason, " is not a whole number, allowed are 1, 2, 3, ...");
    } else {
        append_outside_interval(reason, v, value, 10);
    }
}

/* Check the parameters and compute the tables, if the parameters have changed. */
static bool update_tables(Instance *m)
{
    const double *parameters = m->state.values + FIRST_PARAMETER;
    if (m->tables_are_valid && memcmp(m->tabulated_parameters, parameters, sizeof m->tabulated_parameters) == 0) {
        m->parameters_changed = false;
        return true;
    }
    Text reason = {0};
    for (size_t i = 0; i < N_PARAMETERS; i++)
        check_parameter(&reason, &variables[FIRST_PARAMETER + i], parameters[i]);
    const bool had_tables = m->tables_are_valid, are_allowed = reason.length == 0;
    if (are_allowed)
        m->tables_are_valid = joint_tabulate(m->joint, &data, parameters, &reason);
    if (!are_allowed || !m->tables_are_valid)
        return log_refusal(m, ERROR, &reason) == OK;
    memcpy(m->tabulated_parameters, parameters, sizeof m->tabulated_parameters);
    m->parameters_changed = false;
    if (had_tables)
        instance_log(m, OK, LOG_EVENTS, "tables evaluated again for changed parameters");
    return true;
}

/* Outputs */

static Status log_input_refusal(const Instance *m, Status refusal, size_t i)
{
    Text reason;
    text_clear(&reason);
    append_outside_interval(&reason, &variables[FIRST_INPUT + i], m->state.values[FIRST_INPUT + i], 6);
    return log_refusal(m, refusal, &reason);
}

/* Largest number of inputs in a refusal: a system has hundreds, and the reason must fit. */
enum { MAX_INPUTS_IN_ERROR_MESSAGE = 4 };

/* Number of inputs with a larger magnitude than input i; of equal ones the first counts as larger. */
static size_t magnitude_rank(const double *inputs, size_t i)
{
    size_t rank = 0;
    for (size_t j = 0; j < N_INPUTS; j++)
        rank += fabs(inputs[j]) > fabs(inputs[i]) || (j < i && fabs(inputs[j]) == fabs(inputs[i]));
    return rank;
}

static Status log_output_refusal(const Instance *m, Status refusal)
{
    Text reason;
    text_clear(&reason);
    const char *separator = "";
    size_t first_infinite = 0, omitted = 0;
    while (isfinite(m->state.values[FIRST_OUTPUT + first_infinite]))
        first_infinite++;
    for (size_t i = FIRST_INPUT; i < FIRST_OUTPUT; i++)
        if (m->state.values[i] != 0.0) {
            if (magnitude_rank(m->state.values + FIRST_INPUT, i - FIRST_INPUT) >= MAX_INPUTS_IN_ERROR_MESSAGE) {
                omitted++;
                continue;
            }
            text_append(&reason, separator);
            text_append_quantity(&reason, variables[i].name, m->state.values[i], 6, variables[i].unit);
            separator = ", ";
        }
    if (omitted)
        text_append_format(&reason, " and %zu more", omitted);
    text_append_format(&reason, ": the inputs are too large, the output %s is not finite",
                       variables[FIRST_OUTPUT + first_infinite].name);
    return log_refusal(m, refusal, &reason);
}

/* Whether the host has set an input to 0 whose start value is not 0. */
static bool has_lost_start_value(const Instance *m, size_t i)
{
    return m->state.values[i] == 0.0 && data.start[i] != 0.0;
}

void instance_warn_of_lost_start_values(Instance *m)
{
    Text text;
    text_clear(&text);
    for (size_t i = FIRST_INPUT; i < FIRST_OUTPUT; i++)
        if (has_lost_start_value(m, i)) {
            text_append(&text, text.length ? ", " : "");
            text_append_quantity(&text, variables[i].name, 0.0, 6, variables[i].unit);
            text_append_quantity(&text, " in place of its start value", data.start[i], 6, variables[i].unit);
        }
    if (text.length == 0 || (m->state.reported_warnings & LOST_START_VALUE))
        return;
    text_append(&text, ": some tools set all inputs to 0; connect the input, or set its value");
    instance_log(m, WARNING, LOG_WARNINGS, text.line);
    m->state.reported_warnings |= LOST_START_VALUE;
}

/* Warnings that would not exist if inputs that the host has set to 0 had their start values. */
static unsigned find_warnings_of_lost_start_values(Instance *m, unsigned warning_bits)
{
    double inputs[N_INPUTS + 1]; /* C has no empty arrays */
    for (size_t i = 0; i < N_INPUTS; i++)
        inputs[i] = has_lost_start_value(m, FIRST_INPUT + i) ? data.start[FIRST_INPUT + i]
                                                             : m->state.values[FIRST_INPUT + i];
    return warning_bits & ~joint_find_warnings(m->joint, inputs, m->state.values + FIRST_OUTPUT);
}

static void log_warnings(Instance *m, unsigned warning_bits)
{
    const double *values = m->state.values;
    const unsigned lost_bits = find_warnings_of_lost_start_values(m, warning_bits);
    if (lost_bits)
        instance_warn_of_lost_start_values(m);
    for (unsigned bit = 1; bit && bit <= warning_bits; bit <<= 1)
        if (warning_bits & ~lost_bits & bit) {
            Text text = {0};
            joint_describe_warning(m->joint, values + FIRST_INPUT, values + FIRST_OUTPUT, bit, &text);
            instance_log(m, WARNING, LOG_WARNINGS, text.line);
        }
    m->state.reported_warnings |= warning_bits;
}

/* Round inputs up to their minimum if they are below it by at most the margin: solvers vary inputs a little to form
 * derivatives, and their results have round-off. */
static void round_inputs(double inputs[])
{
    for (size_t i = 0; i < N_INPUTS; i++) {
        const Variable *v = &variables[FIRST_INPUT + i];
        if (inputs[i] < v->low && inputs[i] >= v->low - v->margin)
            inputs[i] = v->low;
    }
}

Status instance_evaluate(Instance *m, Status refusal)
{
    if (!m->outputs_outdated)
        return OK;
    if (m->parameters_changed && !update_tables(m))
        return ERROR;
    const double *inputs = m->state.values + FIRST_INPUT;
    double *outputs = m->state.values + FIRST_OUTPUT;
    round_inputs(m->state.values + FIRST_INPUT);
    for (size_t i = 0; i < N_INPUTS; i++)
        if (!is_inside(&variables[FIRST_INPUT + i], inputs[i]))
            return log_input_refusal(m, refusal, i);
    Text reason;
    text_clear(&reason);
    if (!joint_evaluate(m->joint, inputs, path_start_history(m), m->trial_history, N_OUTPUTS, outputs, &reason))
        return log_refusal(m, refusal, &reason);
    bool all_finite = true;
    for (size_t i = 0; i < N_OUTPUTS; i++)
        all_finite &= fabs(outputs[i]) < INFINITY;
    if (!all_finite)
        return log_output_refusal(m, refusal);
    const unsigned warning_bits = joint_find_warnings(m->joint, inputs, outputs) & ~m->state.reported_warnings;
    if (warning_bits)
        log_warnings(m, warning_bits);
    m->outputs_outdated = false;
    return OK;
}

void path_accept_inputs(Instance *m)
{
    AcceptedPath *path = &m->state.path;
    if (!N_HISTORY || path_start_history(m) != path->history[path->end_index])
        return; /* the present inputs are the accepted ones */
    path->end_index = 1u - path->end_index;
    memcpy(path->history[path->end_index], m->trial_history, sizeof m->trial_history);
    memcpy(path->variables, m->state.values + FIRST_PATH_VARIABLE, sizeof path->variables);
    path->has_accepted_inputs = 1;
}
