#include "derivative.h"

#include <math.h>
#include <string.h>

#include "memory.h"

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
    double *direction = m->seed, *change = m->change;
    memset(m->seed, 0, sizeof m->seed);
    for (size_t i = 0; i < n_knowns; i++) {
        if (!isfinite(seed[i]))
            return refuse_derivative(m, function, knowns[i]);
        direction[knowns[i] - FIRST_INPUT] += seed[i];
    }
    joint_derivative(m->joint, m->now.values + FIRST_INPUT, memory_of(m), memory_after(m), direction, change);
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
        double *direction = m->seed, *change = m->change;
        memset(m->seed, 0, sizeof m->seed);
        direction[knowns[j] - FIRST_INPUT] = 1.0;
        joint_derivative(m->joint, m->now.values + FIRST_INPUT, memory_of(m), memory_after(m), direction, change);
        result[j] = 0.0;
        for (size_t i = 0; i < n_unknowns; i++)
            result[j] += seed[i] * change[unknowns[i] - FIRST_OUTPUT];
        if (!isfinite(result[j]))
            return refuse_derivative(m, function, knowns[j]);
    }
    return OK;
}
