#include <math.h>
#include <string.h>

#include "instance.h"

Status instance_accept_inputs(Instance *m)
{
    if (instance_evaluate(m, ERROR) != OK)
        return ERROR;
    path_accept_inputs(m);
    return OK;
}

Status instance_initialize(Instance *m, const char *function)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | INITIALIZATION) || instance_accept_inputs(m) != OK)
        return ERROR;
    instance_warn_of_lost_start_values(m);
    instance_set_mode(m, m->state.interface_type == MODEL_EXCHANGE ? EVENT : STEP);
    return OK;
}

Status instance_update_discrete_states(Instance *m, bool *next_defined, double *next_time)
{
    *next_defined = false;
    *next_time = 0.0;
    if (instance_accept_inputs(m) != OK)
        return ERROR;
#if N_TIME_EVENTS
    const double time = m->state.values[0];
    double times[N_TIME_EVENTS];
    joint_event_times(m->joint, times);
    for (size_t i = 0; i < N_TIME_EVENTS; i++) {
        const double time_tolerance = 1e-14 * (fabs(time) + fabs(times[i])); /* the host's times have round-off */
        if (isfinite(times[i]) && times[i] - time > time_tolerance && !(*next_defined && *next_time <= times[i])) {
            *next_defined = true;
            *next_time = times[i];
        }
    }
#endif
    return OK;
}

/* Whether the host has set a time derivative of an input for this step. */
static bool has_input_derivatives(const InstanceState *state)
{
    bool found = false;
    for (size_t i = 0; i < N_INPUTS; i++)
        found |= state->input_derivatives[i] != 0.0;
    return found;
}

/* Advance time, states and inputs with a derivative to the end of a communication step. If the joint has history or
 * states, the present inputs are accepted first: the load step starts there. */
static Status advance(Instance *m, double size, double end, bool inputs_move)
{
    InstanceState *state = &m->state;
    if ((IS_TIME_DEPENDENT || (N_HISTORY && inputs_move)) && instance_accept_inputs(m) != OK)
        return ERROR;
    if (IS_TIME_DEPENDENT) {
        if (instance_integrate(m, size) != OK)
            return ERROR;
        state->values[0] = end;
    }
    for (size_t i = 0; i < N_INPUTS && inputs_move; i++)
        state->values[FIRST_INPUT + i] += state->input_derivatives[i] * size;
    m->outputs_outdated |= IS_TIME_DEPENDENT || inputs_move;
    if (instance_evaluate(m, ERROR) != OK)
        return ERROR;
    if (inputs_move)
        memset(state->input_derivatives, 0, sizeof state->input_derivatives);
    state->values[0] = end;
    return OK;
}

static Status log_step_error(const Instance *m, const char *function, const char *problem, double time, double size,
                             const char *expected, double limit)
{
    return instance_log_error(m, function, "%s at %.16g s with step %.16g s; expected %s%.16g s", problem, time, size,
                              expected, limit);
}

Status instance_do_step(Instance *m, const char *function, double time, double size)
{
    if (!instance_check_mode(m, function, CO_SIMULATION | STEP))
        return ERROR;
    InstanceState *state = &m->state;
    state->last_step_status = ERROR;
    const double end = time + size;
    if (!(size > 0.0 && isfinite(end)))
        return log_step_error(m, function, "no step is possible", time, size, "finite numbers and a step above ", 0.0);
    const double time_tolerance = 1e-5 * size + 1e-9 * fabs(time); /* the host's times have round-off */
    if (fabs(time - state->values[0]) > time_tolerance)
        return log_step_error(m, function, "the communication point is", time, size, "it at ", state->values[0]);
    if (end > state->stop_time + time_tolerance)
        return log_step_error(m, function, "the step ends after the stop time", time, size, "an end at or before ",
                              state->stop_time);
    const bool inputs_move = has_input_derivatives(state), state_changes = IS_TIME_DEPENDENT || inputs_move;
    if (state_changes && !instance_back_up_state(m, function))
        return ERROR;
    if (advance(m, size, end, inputs_move) != OK) {
        if (state_changes) {
            *state = *m->backup; /* an error leaves the state unchanged */
            m->outputs_outdated = true;
        }
        return ERROR;
    }
    path_accept_inputs(m);
    if (time <= state->start_time)
        instance_warn_of_lost_start_values(m); /* set to 0 between initialization and the first step */
    return state->last_step_status = OK;
}
