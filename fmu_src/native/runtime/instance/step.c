#include <math.h>
#include <string.h>

#include "instance.h"

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

/* To the end of a step: inputs with a derivative move, along a path from where they are where there is a memory;
 * states move over it. */
static Status move(Instance *m, double size, double end, bool sloping)
{
    State *now = &m->now;
    if ((MOVES || (N_MEMORY && sloping)) && instance_accept(m) != OK)
        return ERROR;
    if (MOVES) {
        if (instance_advance(m, size) != OK)
            return ERROR;
        now->values[0] = end;
    }
    for (size_t i = 0; i < N_INPUTS && sloping; i++)
        now->values[FIRST_INPUT + i] += now->slopes[i] * size;
    m->dirty |= MOVES || sloping;
    if (instance_evaluate(m) != OK)
        return ERROR;
    if (sloping)
        memset(now->slopes, 0, sizeof now->slopes);
    now->values[0] = end;
    return OK;
}

static Status refuse_step(const Instance *m, const char *function, const char *what, double time, double size,
                          const char *expected, double limit)
{
    return instance_refuse(m, function, "%s at %.16g s with step %.16g s; expected %s%.16g s", what, time, size,
                           expected, limit);
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
    const bool sloping = has_slopes(now), changes = MOVES || sloping;
    if (changes)
        m->kept = *now;
    if (move(m, size, end, sloping) != OK) {
        if (changes) {
            *now = m->kept; /* a refusal changes nothing */
            m->dirty = true;
        }
        return ERROR;
    }
    memory_accept(m);
    return now->last_step = OK;
}
