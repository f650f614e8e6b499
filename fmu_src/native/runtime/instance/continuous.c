#include <string.h>

#include "instance.h"

/* Continuous states: positions and speeds of bodies, whose rates are outputs. Joints have none. */

#if !IMPLICIT
#if N_STATES
enum { POSITION = FIRST_OUTPUT, SPEED, RATE };

/* Rate of the speed at the begin of a step. Inputs that lag behind are carried on along their last change,
 * by as many steps as they lag. */
static double rate_at_begin(Instance *m)
{
    const State *now = &m->now;
    double at[FIRST_PARAMETER];
    Text ignored;
    text_clear(&ignored);
    memcpy(at, now->values, sizeof at);
    if (now->last_size > 0.0)
        for (size_t i = 0; i < N_INPUTS; i++)
            at[FIRST_INPUT + i] += now->values[LAGS + i] * (at[FIRST_INPUT + i] - now->last_inputs[i]);
    joint_evaluate(m->joint, at + FIRST_INPUT, memory_of(m), m->tried, at + FIRST_OUTPUT, &ignored);
    return at[RATE];
}

/* Velocity Verlet: positions are those of the leapfrog scheme. The speed at the end of a step needs the rate
 * there, which is known in the next step only: until then the rate at its begin stands in for it. */
Status instance_advance(Instance *m, double size)
{
    State *now = &m->now;
    double *x = now->values;
    const double rate = rate_at_begin(m);
    if (now->last_size > 0.0)
        x[SPEED] += 0.5 * now->last_size * (rate - now->last_rate);
    x[POSITION] += size * (x[SPEED] + 0.5 * size * rate);
    x[SPEED] += size * rate;
    memcpy(now->last_inputs, x + FIRST_INPUT, sizeof now->last_inputs);
    now->last_rate = rate;
    now->last_size = size;
    return OK;
}
#else
static const double nominals[1];

Status instance_advance(Instance *m, double size)
{
    (void)m, (void)size;
    return OK;
}
#endif
#endif

static bool fit(Instance *m, const char *function, unsigned where, const double x[], size_t n)
{
    return instance_allows(m, function, MODEL_EXCHANGE | where) &&
           instance_counts(m, function, "continuous states", n, N_STATES) &&
           (n == 0 || instance_has(m, function, "the array of continuous states", x));
}

Status instance_set_states(Instance *m, const char *function, const double x[], size_t n)
{
    /* FMI 2.0 allows event mode in 3.1, not in 3.2.3; importers set the states right after initialization. */
    if (!fit(m, function, EVENT | CONTINUOUS_TIME, x, n))
        return ERROR;
    if (n) {
        memcpy(m->now.values + FIRST_OUTPUT, x, n * sizeof *x);
        m->dirty = true;
    }
    return OK;
}

Status instance_get_states(Instance *m, const char *function, double x[], size_t n)
{
    if (!fit(m, function, READABLE, x, n))
        return ERROR;
    if (n)
        memcpy(x, m->now.values + FIRST_OUTPUT, n * sizeof *x);
    return OK;
}

Status instance_get_rates(Instance *m, const char *function, double x[], size_t n)
{
    if (!fit(m, function, READABLE, x, n) || (n && instance_evaluate(m) != OK))
        return ERROR;
    if (n)
        memcpy(x, m->now.values + FIRST_OUTPUT + N_BODIES, n * sizeof *x);
    return OK;
}

Status instance_get_nominals(Instance *m, const char *function, unsigned where, double x[], size_t n)
{
    if (!fit(m, function, where, x, n))
        return ERROR;
    if (n)
        memcpy(x, nominals, n * sizeof *x);
    return OK;
}
