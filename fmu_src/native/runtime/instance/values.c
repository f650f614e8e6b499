#include <math.h>
#include <string.h>

#include "instance.h"

/* Calls that hosts make in each step, to set inputs and to get outputs, are checked in one short loop (is_fast_path).
 * All other calls are checked variable by variable, with an error message. */

/* Whether a value reference is one of `count` references from `first` on. */
static bool is_in_range(uint32_t ref, uint32_t first, uint32_t count)
{
    return ref - first < count;
}

static bool all_in_range(const uint32_t refs[], size_t n, uint32_t first, uint32_t count)
{
    bool all_inside = true;
    for (size_t i = 0; i < n; i++)
        all_inside &= is_in_range(refs[i], first, count);
    return all_inside;
}

/* Log an error in the access to a variable; returns false. */
static bool log_variable_error(const Instance *m, const char *function, uint32_t ref, const char *problem)
{
    return instance_log_error(m, function, "%s%s", variables[ref].name, problem) == OK;
}

static bool check_reference(const Instance *m, const char *function, uint32_t ref)
{
    const uint32_t first = m->fmi_version == 2 ? FIRST_INPUT : 0; /* the time is no variable in FMI 2 */
    return (ref >= first && ref < N_VALUES) ||
           instance_log_error(m, function, "value reference %zu is unknown; expected %zu to %zu", (size_t)ref,
                              (size_t)first, (size_t)N_VALUES - 1) == OK;
}

/* Whether a variable is Boolean, or is not, as the called function requires. */
static bool check_type(const Instance *m, const char *function, uint32_t ref, bool is_boolean)
{
    return (variables[ref].is_boolean != 0) == is_boolean ||
           log_variable_error(m, function, ref,
                              is_boolean ? " is a number; expected a Boolean" : " is a Boolean; expected a number");
}

static bool check_arrays(const Instance *m, const char *function, size_t n, const void *refs, const void *values)
{
    return n == 0 || (instance_check_pointer(m, function, "the array of value references", refs) &&
                      instance_check_pointer(m, function, "the array of values", values));
}

/* Set */

/* Whether the variable can be set in the present mode. */
static bool check_settable(const Instance *m, const char *function, uint32_t ref, bool is_boolean)
{
    if (!check_reference(m, function, ref) || !check_type(m, function, ref, is_boolean))
        return false;
    if (is_in_range(ref, FIRST_INPUT, N_INPUTS) ||
        ((m->state.mode & STATES_SETTABLE) && is_in_range(ref, FIRST_OUTPUT, N_STATES)))
        return true;
    if (!is_in_range(ref, FIRST_PARAMETER, N_PARAMETERS))
        return log_variable_error(m, function, ref,
                                  ref == 0 ? " is the independent variable; expected an input or a parameter"
                                           : " is an output; expected an input or a parameter");
    if (m->state.mode == CONTINUOUS_TIME)
        return log_variable_error(m, function, ref,
                                  " is a tunable parameter set in continuous-time mode; expected event mode");
    return true;
}

static bool check_set(Instance *m, const char *function, const uint32_t refs[], size_t n, const void *values,
                      bool is_boolean)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | SETTABLE) || !check_arrays(m, function, n, refs, values))
        return false;
    for (size_t i = 0; i < n; i++)
        if (!check_settable(m, function, refs[i], is_boolean))
            return false;
    m->parameters_changed = true;
    return true;
}

void instance_set_parameter(Instance *m, uint32_t ref, double value)
{
    if (m->state.values[ref] != value)
        path_restart(m);
    m->state.values[ref] = value;
}

Status instance_set_values(Instance *m, const char *function, const uint32_t refs[], size_t n, const double values[])
{
    const bool is_fast_path =
        m && (m->state.mode & SETTABLE) && refs && values && all_in_range(refs, n, FIRST_INPUT, N_INPUTS);
    if (!is_fast_path && !check_set(m, function, refs, n, values, false))
        return ERROR;
    for (size_t i = 0; i < n; i++)
        if (N_HISTORY && !is_fast_path && is_in_range(refs[i], FIRST_PARAMETER, N_PARAMETERS))
            instance_set_parameter(m, refs[i], values[i]);
        else
            m->state.values[refs[i]] = values[i];
    m->outputs_outdated = true;
    return OK;
}

Status instance_set_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n, const void *values)
{
    if (!check_set(m, function, refs, n, values, true))
        return ERROR;
    for (size_t i = 0; i < n; i++)
        instance_set_parameter(m, refs[i],
                               m->fmi_version == 2 ? ((const int *)values)[i] != 0 : ((const bool *)values)[i]);
    m->outputs_outdated = true;
    return OK;
}

Status instance_set_input_derivatives(Instance *m, const char *function, const uint32_t refs[], size_t n,
                                      const int32_t orders[], const double values[])
{
    if (!instance_check_mode(m, function, CO_SIMULATION | INSTANTIATED | INITIALIZATION | STEP) ||
        !check_arrays(m, function, n, refs, values) ||
        (n && !instance_check_pointer(m, function, "the array of orders", orders)))
        return ERROR;
    for (size_t i = 0; i < n; i++) {
        if (!check_reference(m, function, refs[i]))
            return ERROR;
        const char *problem = !is_in_range(refs[i], FIRST_INPUT, N_INPUTS) ? " is not an input; expected one"
                              : orders[i] != 1 ? " is given a derivative of another order; expected order 1"
                              : !isfinite(values[i])
                                  ? " is given a derivative that is not finite; expected a finite one"
                                  : NULL;
        if (problem) {
            log_variable_error(m, function, refs[i], problem);
            return ERROR;
        }
    }
    for (size_t i = 0; i < n; i++)
        m->state.input_derivatives[refs[i] - FIRST_INPUT] = values[i];
    return OK;
}

/* Get */

static Status check_get(Instance *m, const char *function, const uint32_t refs[], size_t n, const void *values,
                        bool is_boolean)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | READABLE) || !check_arrays(m, function, n, refs, values))
        return ERROR;
    bool has_output = false;
    for (size_t i = 0; i < n; i++) {
        if (!check_reference(m, function, refs[i]) || !check_type(m, function, refs[i], is_boolean))
            return ERROR;
        has_output |= is_in_range(refs[i], FIRST_OUTPUT, N_OUTPUTS);
    }
    return has_output ? instance_evaluate(m, trial_refusal(m, false)) : OK;
}

Status instance_get_values(Instance *m, const char *function, const uint32_t refs[], size_t n, double values[])
{
    const bool is_fast_path = m && !m->outputs_outdated && (m->state.mode & READABLE) && refs && values &&
                              all_in_range(refs, n, FIRST_OUTPUT, N_OUTPUTS);
    const Status status = is_fast_path ? OK : check_get(m, function, refs, n, values, false);
    for (size_t i = 0; i < n && status == OK; i++)
        values[i] = m->state.values[refs[i]];
    return status;
}

Status instance_get_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n, void *values)
{
    const Status status = check_get(m, function, refs, n, values, true);
    for (size_t i = 0; i < n && status == OK; i++)
        if (m->fmi_version == 2)
            ((int *)values)[i] = m->state.values[refs[i]] != 0.0;
        else
            ((bool *)values)[i] = m->state.values[refs[i]] != 0.0;
    return status;
}

Status instance_check_empty(const Instance *m, const char *function, unsigned allowed_modes, const char *name, size_t n)
{
    return instance_check_mode(m, function, allowed_modes) && instance_check_count(m, function, name, n, 0) ? OK
                                                                                                            : ERROR;
}

/* Derivatives */

/* Whether all seeds, or all derivatives of variables, are finite. */
static bool check_finite(const Instance *m, const char *function, const uint32_t refs[], size_t n,
                         const double values[])
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]))
            return instance_log_error(m, function,
                                      "the derivative of %s is not finite; expected a finite seed, not too large",
                                      variables[refs[i]].name) == OK;
    return true;
}

/* Check the arguments of a derivative and evaluate the outputs. The unknowns must be outputs, the knowns inputs or
 * states; the seed has one finite number for each of the n `seed_variables`. */
static Status check_derivative_arguments(Instance *m, const char *function, const uint32_t unknowns[],
                                         size_t n_unknowns, const uint32_t knowns[], size_t n_knowns,
                                         const uint32_t seed_variables[], size_t n, const double seed[],
                                         const double result[])
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | READABLE) ||
        (n_unknowns && !instance_check_pointer(m, function, "the array of unknowns", unknowns)) ||
        (n_knowns && !instance_check_pointer(m, function, "the array of knowns", knowns)))
        return ERROR;
    for (size_t i = 0; i < n_unknowns; i++)
        if (!check_reference(m, function, unknowns[i]) ||
            !(is_in_range(unknowns[i], FIRST_OUTPUT, N_OUTPUTS) ||
              log_variable_error(m, function, unknowns[i], " is among the unknowns; expected outputs")))
            return ERROR;
    for (size_t i = 0; i < n_knowns; i++)
        if (!check_reference(m, function, knowns[i]) ||
            !(is_in_range(knowns[i], FIRST_INPUT, N_INPUTS) || is_in_range(knowns[i], FIRST_OUTPUT, N_STATES) ||
              log_variable_error(m, function, knowns[i], " is among the knowns; expected inputs")))
            return ERROR;
    const size_t n_results = n_unknowns + n_knowns - n;
    const Status status = instance_evaluate(m, trial_refusal(m, true));
    if (status != OK)
        return status;
    const bool is_valid = (n == 0 || instance_check_pointer(m, function, "the seed", seed)) &&
                          (n_results == 0 || instance_check_pointer(m, function, "the array of sensitivities", result)) &&
                          check_finite(m, function, seed_variables, n, seed);
    return is_valid ? OK : ERROR;
}

/* Derivatives of all outputs along m->seed. */
static void update_sensitivity(Instance *m)
{
    joint_derivative(m->joint, m->state.values + FIRST_INPUT, path_start_history(m), path_end_history(m), m->seed,
                     N_OUTPUTS, m->sensitivity);
}

Status instance_directional_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                                       const uint32_t knowns[], size_t n_knowns, const double seed[], double result[])
{
    const Status status = check_derivative_arguments(m, function, unknowns, n_unknowns, knowns, n_knowns, knowns,
                                                     n_knowns, seed, result);
    if (status != OK)
        return status;
    memset(m->seed, 0, sizeof m->seed);
    for (size_t i = 0; i < n_knowns; i++)
        m->seed[knowns[i] - FIRST_INPUT] += seed[i];
    update_sensitivity(m);
    for (size_t i = 0; i < n_unknowns; i++)
        result[i] = m->sensitivity[unknowns[i] - FIRST_OUTPUT];
    return check_finite(m, function, unknowns, n_unknowns, result) ? OK : ERROR;
}

Status instance_adjoint_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                                   const uint32_t knowns[], size_t n_knowns, const double seed[], double result[])
{
    const Status status = check_derivative_arguments(m, function, unknowns, n_unknowns, knowns, n_knowns, unknowns,
                                                     n_unknowns, seed, result);
    if (status != OK)
        return status;
    for (size_t j = 0; j < n_knowns; j++) {
        memset(m->seed, 0, sizeof m->seed);
        m->seed[knowns[j] - FIRST_INPUT] = 1.0;
        update_sensitivity(m);
        result[j] = 0.0;
        for (size_t i = 0; i < n_unknowns; i++)
            result[j] += seed[i] * m->sensitivity[unknowns[i] - FIRST_OUTPUT];
    }
    return check_finite(m, function, knowns, n_knowns, result) ? OK : ERROR;
}
