#include <math.h>
#include <string.h>

#include "instance.h"

/* Every check below comes in two parts: a short loop for what hosts do in each step (inputs to set, outputs
 * to read), and a long way that takes everything else and finds the words for what is wrong. */

/* Whether a reference is one of `count` from the first on. */
static bool among(uint32_t ref, uint32_t first, uint32_t count)
{
    return ref - first < count;
}

static bool all_among(const uint32_t refs[], size_t n, uint32_t first, uint32_t count)
{
    bool inside = true;
    for (size_t i = 0; i < n; i++)
        inside &= among(refs[i], first, count);
    return inside;
}

/* Say what is wrong with a variable. */
static bool refused(const Instance *m, const char *function, uint32_t ref, const char *what)
{
    return instance_refuse(m, function, "%s%s", variables[ref].name, what) == OK;
}

static bool known(const Instance *m, const char *function, uint32_t ref)
{
    const uint32_t first = m->version == 2 ? FIRST_INPUT : 0; /* FMI 2 lists no time */
    return (ref >= first && ref < N_VALUES) ||
           instance_refuse(m, function, "value reference %zu is unknown; expected %zu to %zu", (size_t)ref,
                           (size_t)first, (size_t)N_VALUES - 1) == OK;
}

static bool of_type(const Instance *m, const char *function, uint32_t ref, bool boolean)
{
    return (variables[ref].boolean != 0) == boolean ||
           refused(m, function, ref,
                   boolean ? " is a number; expected a Boolean" : " is a Boolean; expected a number");
}

static bool has_arrays(const Instance *m, const char *function, size_t n, const void *refs,
                       const void *values)
{
    return n == 0 || (instance_has(m, function, "the array of value references", refs) &&
                      instance_has(m, function, "the array of values", values));
}

/* Set */

static bool settable(const Instance *m, const char *function, uint32_t ref, bool boolean)
{
    if (!known(m, function, ref) || !of_type(m, function, ref, boolean))
        return false;
    if (among(ref, FIRST_INPUT, N_INPUTS) ||
        ((m->now.mode & STATES_SETTABLE) && among(ref, FIRST_OUTPUT, N_STATES)))
        return true;
    if (!among(ref, FIRST_PARAMETER, N_PARAMETERS))
        return refused(m, function, ref,
                       ref == 0 ? " is the independent variable; expected an input or a parameter"
                                : " is an output; expected an input or a parameter");
    if (m->now.mode == CONTINUOUS_TIME)
        return refused(m, function, ref,
                       " is a tunable parameter set in continuous-time mode; expected event mode");
    return true;
}

static bool can_set(Instance *m, const char *function, const uint32_t refs[], size_t n, const void *values,
                    bool boolean)
{
    if (!instance_allows(m, function, BOTH | SETTABLE) || !has_arrays(m, function, n, refs, values))
        return false;
    for (size_t i = 0; i < n; i++)
        if (!settable(m, function, refs[i], boolean))
            return false;
    m->parameters_changed = true;
    return true;
}

void instance_put(Instance *m, uint32_t ref, double value)
{
    if (m->now.values[ref] != value)
        memory_settle(m);
    m->now.values[ref] = value;
}

Status instance_set(Instance *m, const char *function, const uint32_t refs[], size_t n, const double values[])
{
    const bool quick =
        m && (m->now.mode & SETTABLE) && refs && values && all_among(refs, n, FIRST_INPUT, N_INPUTS);
    if (!quick && !can_set(m, function, refs, n, values, false))
        return ERROR;
    for (size_t i = 0; i < n; i++)
        if (N_MEMORY && !quick && among(refs[i], FIRST_PARAMETER, N_PARAMETERS))
            instance_put(m, refs[i], values[i]);
        else
            m->now.values[refs[i]] = values[i];
    m->dirty = true;
    return OK;
}

Status instance_set_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n,
                             const void *values)
{
    if (!can_set(m, function, refs, n, values, true))
        return ERROR;
    for (size_t i = 0; i < n; i++)
        instance_put(m, refs[i], m->version == 2 ? ((const int *)values)[i] != 0 : ((const bool *)values)[i]);
    m->dirty = true;
    return OK;
}

Status instance_set_slopes(Instance *m, const char *function, const uint32_t refs[], size_t n,
                           const int32_t orders[], const double values[])
{
    if (!instance_allows(m, function, CO_SIMULATION | INSTANTIATED | INITIALIZATION | STEP) ||
        !has_arrays(m, function, n, refs, values) ||
        (n && !instance_has(m, function, "the array of orders", orders)))
        return ERROR;
    for (size_t i = 0; i < n; i++) {
        if (!known(m, function, refs[i]))
            return ERROR;
        const char *wrong = !among(refs[i], FIRST_INPUT, N_INPUTS) ? " is not an input; expected one"
                            : orders[i] != 1 ? " is given a derivative of another order; expected order 1"
                            : !isfinite(values[i])
                                ? " is given a derivative that is not finite; expected a finite one"
                                : NULL;
        if (wrong) {
            refused(m, function, refs[i], wrong);
            return ERROR;
        }
    }
    for (size_t i = 0; i < n; i++)
        m->now.slopes[refs[i] - FIRST_INPUT] = values[i];
    return OK;
}

/* Get */

static bool can_get(Instance *m, const char *function, const uint32_t refs[], size_t n, const void *values,
                    bool boolean)
{
    if (!instance_allows(m, function, BOTH | READABLE) || !has_arrays(m, function, n, refs, values))
        return false;
    bool output = false;
    for (size_t i = 0; i < n; i++) {
        if (!known(m, function, refs[i]) || !of_type(m, function, refs[i], boolean))
            return false;
        output |= among(refs[i], FIRST_OUTPUT, N_OUTPUTS);
    }
    return !output || instance_evaluate(m) == OK;
}

Status instance_get(Instance *m, const char *function, const uint32_t refs[], size_t n, double values[])
{
    const bool quick = m && !m->dirty && (m->now.mode & READABLE) && refs && values &&
                       all_among(refs, n, FIRST_OUTPUT, N_OUTPUTS);
    if (!quick && !can_get(m, function, refs, n, values, false))
        return ERROR;
    for (size_t i = 0; i < n; i++)
        values[i] = m->now.values[refs[i]];
    return OK;
}

Status instance_get_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n, void *values)
{
    if (!can_get(m, function, refs, n, values, true))
        return ERROR;
    for (size_t i = 0; i < n; i++)
        if (m->version == 2)
            ((int *)values)[i] = m->now.values[refs[i]] != 0.0;
        else
            ((bool *)values)[i] = m->now.values[refs[i]] != 0.0;
    return OK;
}

Status instance_none(const Instance *m, const char *function, unsigned where, const char *what, size_t n)
{
    return instance_allows(m, function, where) && instance_counts(m, function, what, n, 0) ? OK : ERROR;
}

/* Derivatives */

static bool are_finite(const Instance *m, const char *function, const uint32_t refs[], size_t n, const double values[])
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]))
            return instance_refuse(m, function,
                                   "the derivative of %s is not finite; expected a finite seed, not too large",
                                   variables[refs[i]].name) == OK;
    return true;
}

/* Whether unknowns are outputs and knowns inputs, and the outputs right; the seed is of so many of them. */
static bool can_differentiate(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                              const uint32_t knowns[], size_t n_knowns, const uint32_t seeded[], size_t n,
                              const double seed[], const double result[])
{
    if (!instance_allows(m, function, BOTH | READABLE) ||
        (n_unknowns && !instance_has(m, function, "the array of unknowns", unknowns)) ||
        (n_knowns && !instance_has(m, function, "the array of knowns", knowns)))
        return false;
    for (size_t i = 0; i < n_unknowns; i++)
        if (!known(m, function, unknowns[i]) ||
            !(among(unknowns[i], FIRST_OUTPUT, N_OUTPUTS) ||
              refused(m, function, unknowns[i], " is among the unknowns; expected outputs")))
            return false;
    for (size_t i = 0; i < n_knowns; i++)
        if (!known(m, function, knowns[i]) ||
            !(among(knowns[i], FIRST_INPUT, N_INPUTS) || among(knowns[i], FIRST_OUTPUT, N_STATES) ||
              refused(m, function, knowns[i], " is among the knowns; expected inputs")))
            return false;
    const size_t n_results = n_unknowns + n_knowns - n;
    return instance_evaluate(m) == OK && (n == 0 || instance_has(m, function, "the seed", seed)) &&
           (n_results == 0 || instance_has(m, function, "the array of sensitivities", result)) &&
           are_finite(m, function, seeded, n, seed);
}

/* Change of the outputs along m->seed. */
static void differentiate(Instance *m)
{
    joint_derivative(m->joint, m->now.values + FIRST_INPUT, memory_of(m), memory_after(m), m->seed, m->change);
}

Status instance_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                           const uint32_t knowns[], size_t n_knowns, const double seed[], double result[])
{
    if (!can_differentiate(m, function, unknowns, n_unknowns, knowns, n_knowns, knowns, n_knowns, seed, result))
        return ERROR;
    memset(m->seed, 0, sizeof m->seed);
    for (size_t i = 0; i < n_knowns; i++)
        m->seed[knowns[i] - FIRST_INPUT] += seed[i];
    differentiate(m);
    for (size_t i = 0; i < n_unknowns; i++)
        result[i] = m->change[unknowns[i] - FIRST_OUTPUT];
    return are_finite(m, function, unknowns, n_unknowns, result) ? OK : ERROR;
}

Status instance_adjoint(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                        const uint32_t knowns[], size_t n_knowns, const double seed[], double result[])
{
    if (!can_differentiate(m, function, unknowns, n_unknowns, knowns, n_knowns, unknowns, n_unknowns, seed, result))
        return ERROR;
    for (size_t j = 0; j < n_knowns; j++) {
        memset(m->seed, 0, sizeof m->seed);
        m->seed[knowns[j] - FIRST_INPUT] = 1.0;
        differentiate(m);
        result[j] = 0.0;
        for (size_t i = 0; i < n_unknowns; i++)
            result[j] += seed[i] * m->change[unknowns[i] - FIRST_OUTPUT];
    }
    return are_finite(m, function, knowns, n_knowns, result) ? OK : ERROR;
}
