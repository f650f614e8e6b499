#include "step.h"

#include <math.h>
#include <string.h>

#include "memory.h"

Status instance_accept(Instance *m)
{
    if (instance_evaluate(m) != OK)
        return ERROR;
    memory_accept(m);
    return OK;
}

Status instance_initialize(Instance *m, const char *function)
{
    if (!instance_allows(m, function, BOTH | INITIALIZATION) || instance_accept(m) != OK)
        return ERROR;
    instance_enter(m, m->now.kind == MODEL_EXCHANGE ? EVENT : STEP);
    return OK;
}

Status instance_update_event(Instance *m, bool *defined, double *next)
{
    *defined = false;
    *next = 0.0;
    if (instance_accept(m) != OK)
        return ERROR;
#if N_EVENTS
    const double now = m->now.values[0];
    double times[N_EVENTS];
    joint_events(m->joint, times);
    for (size_t i = 0; i < N_EVENTS; i++) {
        const double slack = 1e-14 * (fabs(now) + fabs(times[i])); /* hosts round times in their own ways */
        if (isfinite(times[i]) && times[i] - now > slack && !(*defined && *next <= times[i])) {
            *defined = true;
            *next = times[i];
        }
    }
#endif
    return OK;
}

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
    m->kept = *now;
    if (instance_accept(m) != OK)
        return ERROR;
    if (instance_advance(m, size) != OK) {
        *now = m->kept;
        m->dirty = true;
        return ERROR;
    }
    now->values[0] = end;
    m->dirty = true;
    const bool sloping = has_slopes(now);
    if ((sloping ? evaluate_moved(m, size) : instance_evaluate(m)) != OK) {
        *now = m->kept;
        m->dirty = true;
        return ERROR;
    }
    return OK;
}

/* A step of a joint with memory whose inputs move: from where they are to where their derivatives lead; a
 * refusal changes nothing. */
static Status step_along(Instance *m, double size)
{
    m->kept = m->now;
    if (instance_accept(m) == OK && evaluate_moved(m, size) == OK)
        return OK;
    m->now = m->kept;
    m->dirty = true;
    return ERROR;
}

static Status step_resting(Instance *m, double size, double end)
{
    const bool sloping = has_slopes(&m->now);
    if ((!sloping ? instance_evaluate(m) : N_MEMORY ? step_along(m, size) : evaluate_moved(m, size)) != OK)
        return ERROR;
    m->now.values[0] = end;
    return OK;
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
    if ((MOVES ? step_moving(m, size, end) : step_resting(m, size, end)) != OK)
        return ERROR;
    memory_accept(m);
    return now->last_step = OK;
}
