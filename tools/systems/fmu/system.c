#include "system.h"

#include <math.h>
#include <string.h>

/* Numbers of doubles that a component's own joint takes. */
static size_t room_of(const Component *c)
{
    return (c->size() + 2 * sizeof(double) - 1) / (2 * sizeof(double)) * 2;
}

size_t joint_size(void)
{
    size_t room = 0;
    for (size_t i = 0; i < N_COMPONENTS; i++)
        room += room_of(&components[i]);
    return sizeof(Joint) + room * sizeof(double);
}

/* A reason with the component's name before it. */
static void name_it(const Component *c, const Text *inner, Text *why)
{
    text_print(why, "%s: %s", c->name, inner->line);
}

bool joint_tabulate(Joint *joint, const double *parameters, Text *why)
{
    double *room = joint->room;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        Text inner;
        text_clear(&inner);
        joint->part[i] = (Joint *)room;
        room += room_of(c);
        if (!c->tabulate(joint->part[i], parameters + c->parameters, &inner)) {
            name_it(c, &inner, why);
            return false;
        }
    }
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *outputs,
                    Text *why)
{
    size_t body = 0;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const unsigned short *from = wires + c->wire, *to = from + c->n_inputs;
        double *row = joint->rows + c->row, *found = row + FIRST_INPUT + c->n_inputs;
        row[0] = inputs[-FIRST_INPUT];
        for (size_t k = 0; k < c->n_inputs; k++) {
            const unsigned ref = from[k];
            row[FIRST_INPUT + k] = !ref                ? 0.0
                                   : ref < FIRST_OUTPUT ? inputs[ref - FIRST_INPUT]
                                                        : outputs[ref - FIRST_OUTPUT];
        }
        if (c->n_states) {
            found[0] = outputs[body];
            found[1] = outputs[N_BODIES + body];
            body++;
        }
        Text inner;
        text_clear(&inner);
        if (!c->evaluate(joint->part[i], row + FIRST_INPUT, memory + c->memory, after + c->memory, found,
                         &inner)) {
            name_it(c, &inner, why);
            return false;
        }
        for (size_t k = c->n_states; k < c->n_outputs; k++)
            outputs[to[k] - FIRST_OUTPUT] = found[k];
    }
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    size_t body = 0;
    (void)inputs;
    memcpy(result, seed + N_INPUTS, N_STATES * sizeof *result);
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const unsigned short *from = wires + c->wire, *to = from + c->n_inputs;
        const double *row = joint->rows + c->row;
        double *slope = joint->slopes + c->row, *found = slope + c->n_inputs + c->n_states;
        bool moves = false;
        for (size_t k = 0; k < c->n_inputs; k++) {
            const unsigned ref = from[k];
            slope[k] = !ref                ? 0.0
                       : ref < FIRST_OUTPUT ? seed[ref - FIRST_INPUT]
                                            : result[ref - FIRST_OUTPUT];
            moves |= slope[k] != 0.0;
        }
        if (c->n_states) {
            slope[c->n_inputs] = result[body];
            slope[c->n_inputs + 1] = result[N_BODIES + body];
            moves |= result[body] != 0.0 || result[N_BODIES + body] != 0.0;
            body++;
        }
        if (moves)
            c->derivative(joint->part[i], row + FIRST_INPUT, memory + c->memory, after ? after + c->memory : NULL,
                          slope, found);
        for (size_t k = c->n_states; k < c->n_outputs; k++)
            result[to[k] - FIRST_OUTPUT] = moves ? found[k] : 0.0;
    }
}

unsigned joint_outside(Joint *joint, const double *inputs, const double *outputs)
{
    unsigned found = 0;
    (void)inputs, (void)outputs;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const double *row = joint->rows + c->row + FIRST_INPUT;
        found |= c->outside(joint->part[i], row, row + c->n_inputs) << c->warnings;
    }
    return found;
}

void joint_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)inputs, (void)outputs;
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        const double *row = joint->rows + c->row + FIRST_INPUT;
        if (c->outside(joint->part[i], row, row + c->n_inputs) << c->warnings & bit) {
            Text inner;
            text_clear(&inner);
            c->warning(joint->part[i], row, row + c->n_inputs, bit >> c->warnings, &inner);
            name_it(c, &inner, text);
            return;
        }
    }
}

#if N_EVENTS
void joint_events(Joint *joint, double *times)
{
    for (size_t i = 0; i < N_COMPONENTS; i++) {
        const Component *c = &components[i];
        if (c->events)
            c->events(joint->part[i], times);
        times += c->n_events;
    }
}
#endif
