#include <math.h>
#include <string.h>

#include "instance.h"

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

static void add_outside(Text *text, const Variable *v, double value, int digits)
{
    text_quantity(text, v->name, value, digits, v->unit);
    text_print(text, " is outside %s: %s", v->interval, v->doc);
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
        text_quantity(why, v->name, value, 6, v->unit);
        text_add(why, " is not a whole number, allowed are 1, 2, 3, ...");
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
    Text why = {0};
    for (size_t i = 0; i < N_PARAMETERS; i++)
        check_parameter(&why, &variables[FIRST_PARAMETER + i], parameters[i]);
    const bool again = m->tables_right, allowed = why.length == 0;
    if (allowed)
        m->tables_right = joint_tabulate(m->joint, parameters, &why);
    if (!allowed || !m->tables_right)
        return refuse(m, &why) == OK;
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
            text_quantity(&why, variables[i].name, m->now.values[i], 6, variables[i].unit);
            between = ", ";
        }
    text_print(&why, ": too large, %s is not finite", variables[FIRST_OUTPUT + bad].name);
    return refuse(m, &why);
}

static void warn(Instance *m, unsigned outside)
{
    const double *values = m->now.values;
    for (unsigned bit = 1; bit && bit <= outside; bit <<= 1)
        if (outside & bit) {
            Text text = {0};
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
    if (!joint_evaluate(m->joint, inputs, memory_of(m), m->tried, outputs, &why))
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

void memory_accept(Instance *m)
{
    Path *path = &m->now.path;
    if (!N_MEMORY || memory_of(m) != path->memory[path->last])
        return; /* they are accepted already */
    path->last = 1u - path->last;
    memcpy(path->memory[path->last], m->tried, sizeof m->tried);
    memcpy(path->knowns, m->now.values + FIRST_KNOWN, sizeof path->knowns);
    path->accepted = 1;
}
