#include "system.h"

#include <math.h>
#include <string.h>

/* Size of the joint of a component, in doubles; even, for alignment. */
static size_t joint_doubles(const Component *c)
{
    return (c->size() + 2 * sizeof(double) - 1) / (2 * sizeof(double)) * 2;
}

size_t joint_size(void)
{
    size_t doubles = 0;
    for (size_t i = 0; i < N_COMPONENTS; i++)
        doubles += joint_doubles(&components[i]);
    return sizeof(Joint) + doubles * sizeof(double);
}

void joint_free_tables(Joint *joint)
{
    for (size_t i = 0; i < N_COMPONENTS; i++)
        if (joint->component[i])
            components[i].free_tables(joint->component[i]);
}

/* Append a message with the name of the component before it. */
static void append_with_name(const Component *c, const Text *component_reason, Text *reason)
{
    text_append_format(reason, "%s: %s", c->name, component_reason->line);
}

bool joint_tabulate(Joint *joint, const Data *joint_data, const double *parameters, Text *reason)
{
    (void)joint_data; /* each component has its own */
    double *memory = joint->component_joints;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        Text component_reason;
        text_clear(&component_reason);
        joint->component[i] = (Joint *)memory;
        memory += joint_doubles(c);
        if (!c->tabulate(joint->component[i], c->data, parameters + c->first_parameter, &component_reason)) {
            append_with_name(c, &component_reason, reason);
            return false;
        }
    }
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *outputs, Text *reason)
{
    size_t body = 0;
    const bool is_motion_only = n_outputs <= N_MOTION_OUTPUTS;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const unsigned short *sources = connections + c->first_connection, *targets = sources + c->n_inputs;
        double *values = joint->values + c->first_value, *component_outputs = values + FIRST_INPUT + c->n_inputs;
        values[0] = inputs[-FIRST_INPUT];
        for (size_t k = 0; k < c->n_inputs; k++) {
            const unsigned ref = sources[k];
            values[FIRST_INPUT + k] = !ref                 ? 0.0
                                      : ref < FIRST_OUTPUT ? inputs[ref - FIRST_INPUT]
                                                           : outputs[ref - FIRST_OUTPUT];
        }
        const size_t n_bodies = c->n_states / 2;
        memcpy(component_outputs, outputs + body, n_bodies * sizeof *outputs);
        memcpy(component_outputs + n_bodies, outputs + N_BODIES + body, n_bodies * sizeof *outputs);
        body += n_bodies;
        const size_t n = is_motion_only ? c->n_motion_outputs : c->n_outputs;
        Text component_reason;
        text_clear(&component_reason);
        if (!c->evaluate(joint->component[i], values + FIRST_INPUT, history + c->first_history,
                         history_end + c->first_history, n, component_outputs, &component_reason)) {
            append_with_name(c, &component_reason, reason);
            return false;
        }
        for (size_t k = c->n_states; k < n; k++)
            outputs[targets[k] - FIRST_OUTPUT] = component_outputs[k];
    }
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    size_t body = 0;
    const bool is_motion_only = n_outputs <= N_MOTION_OUTPUTS;
    double *variable_rates = joint->variable_rates, *state_rates = variable_rates + FIRST_OUTPUT;
    (void)inputs;
    memset(state_rates, 0, N_OUTPUTS * sizeof *state_rates);
    memcpy(variable_rates + FIRST_INPUT, seed, (N_INPUTS + N_STATES) * sizeof *seed);
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const unsigned short *sources = connections + c->first_connection, *targets = sources + c->n_inputs;
        const double *values = joint->values + c->first_value;
        double *rate = joint->component_rates, *output_rates = rate + c->n_inputs + c->n_states;
        bool has_rate = false;
        for (size_t k = 0; k < c->n_inputs; k++) {
            rate[k] = variable_rates[sources[k]];
            has_rate |= rate[k] != 0.0;
        }
        const size_t n_bodies = c->n_states / 2;
        memcpy(rate + c->n_inputs, state_rates + body, n_bodies * sizeof *rate);
        memcpy(rate + c->n_inputs + n_bodies, state_rates + N_BODIES + body, n_bodies * sizeof *rate);
        for (size_t k = c->n_inputs; k < c->n_inputs + c->n_states; k++)
            has_rate |= rate[k] != 0.0;
        body += n_bodies;
        if (!has_rate)
            continue;
        const size_t n = is_motion_only ? c->n_motion_outputs : c->n_outputs;
        c->derivative(joint->component[i], values + FIRST_INPUT, history + c->first_history,
                      history_end ? history_end + c->first_history : NULL, rate, n, output_rates);
        for (size_t k = c->n_states; k < n; k++)
            variable_rates[targets[k]] = output_rates[k];
    }
    memcpy(result, state_rates, n_outputs * sizeof *result);
}

unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *outputs)
{
    unsigned bits = 0;
    (void)inputs, (void)outputs;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const double *values = joint->values + c->first_value + FIRST_INPUT;
        bits |= c->find_warnings(joint->component[i], values, values + c->n_inputs) << c->first_warning_bit;
    }
    return bits;
}

void joint_describe_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)inputs, (void)outputs;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const double *values = joint->values + c->first_value + FIRST_INPUT;
        if (c->find_warnings(joint->component[i], values, values + c->n_inputs) << c->first_warning_bit & bit) {
            Text component_reason;
            text_clear(&component_reason);
            c->describe_warning(joint->component[i], values, values + c->n_inputs, bit >> c->first_warning_bit,
                                &component_reason);
            append_with_name(c, &component_reason, text);
            return;
        }
    }
}

#if N_TIME_EVENTS
void joint_event_times(Joint *joint, double *times)
{
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        if (c->event_times)
            c->event_times(joint->component[i], times);
        times += c->n_events;
    }
}
#endif
