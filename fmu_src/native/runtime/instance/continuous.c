#include <string.h>

#include "instance.h"

/* Continuous states: positions and speeds of bodies. Their derivatives are outputs. Joints have no states. */

#if !HAS_IMPLICIT_STEP
#if N_STATES
enum { POSITION = FIRST_OUTPUT, SPEED, ACCELERATION };

/* Acceleration at the start of a step. Inputs that lag behind, by a number of steps that is a parameter, are
 * extrapolated linearly from their last change. */
static double start_acceleration(Instance *m)
{
    const InstanceState *state = &m->state;
    double values[FIRST_PARAMETER];
    Text ignored;
    text_clear(&ignored);
    memcpy(values, state->values, sizeof values);
    if (state->previous_step_size > 0.0)
        for (size_t i = 0; i < N_INPUTS; i++)
            values[FIRST_INPUT + i] +=
                state->values[FIRST_LAG_PARAMETER + i] * (values[FIRST_INPUT + i] - state->previous_inputs[i]);
    joint_evaluate(m->joint, values + FIRST_INPUT, path_start_history(m), m->trial_history, N_OUTPUTS,
                   values + FIRST_OUTPUT, &ignored);
    return values[ACCELERATION];
}

/* One step of velocity Verlet; its positions are those of the leapfrog scheme. The speed at the end of a step needs the
 * acceleration there, which is known in the next step only. Until then the acceleration at the start replaces it. */
Status instance_integrate(Instance *m, double size)
{
    InstanceState *state = &m->state;
    double *x = state->values;
    const double acceleration = start_acceleration(m);
    if (state->previous_step_size > 0.0)
        x[SPEED] += 0.5 * state->previous_step_size * (acceleration - state->previous_acceleration);
    x[POSITION] += size * (x[SPEED] + 0.5 * size * acceleration);
    x[SPEED] += size * acceleration;
    memcpy(state->previous_inputs, x + FIRST_INPUT, sizeof state->previous_inputs);
    state->previous_acceleration = acceleration;
    state->previous_step_size = size;
    return OK;
}
#else
static const double state_nominals[1];

Status instance_integrate(Instance *m, double size)
{
    (void)m, (void)size;
    return OK;
}
#endif
#endif

/* Whether an array of continuous states of the host is valid, and the call is allowed in the present mode. */
static bool check_states_array(Instance *m, const char *function, unsigned allowed_modes, const double x[], size_t n)
{
    return instance_check_mode(m, function, MODEL_EXCHANGE | allowed_modes) &&
           instance_check_count(m, function, "continuous states", n, N_STATES) &&
           (n == 0 || instance_check_pointer(m, function, "the array of continuous states", x));
}

Status instance_set_continuous_states(Instance *m, const char *function, const double x[], size_t n)
{
    /* FMI 2.0 allows event mode in 3.1, not in 3.2.3; importers set the states right after initialization. */
    if (!check_states_array(m, function, EVENT | CONTINUOUS_TIME, x, n))
        return ERROR;
    if (n) {
        memcpy(m->state.values + FIRST_OUTPUT, x, n * sizeof *x);
        m->outputs_outdated = true;
    }
    return OK;
}

Status instance_get_continuous_states(Instance *m, const char *function, double x[], size_t n)
{
    if (!check_states_array(m, function, READABLE, x, n))
        return ERROR;
    if (n)
        memcpy(x, m->state.values + FIRST_OUTPUT, n * sizeof *x);
    return OK;
}

Status instance_get_state_derivatives(Instance *m, const char *function, double x[], size_t n)
{
    if (!check_states_array(m, function, READABLE, x, n))
        return ERROR;
    const Status status = n ? instance_evaluate(m, trial_refusal(m, false)) : OK;
    if (n && status == OK)
        memcpy(x, m->state.values + FIRST_OUTPUT + N_BODIES, n * sizeof *x);
    return status;
}

Status instance_get_nominals(Instance *m, const char *function, unsigned allowed_modes, double x[], size_t n)
{
    if (!check_states_array(m, function, allowed_modes, x, n))
        return ERROR;
    if (n)
        memcpy(x, state_nominals, n * sizeof *x);
    return OK;
}
