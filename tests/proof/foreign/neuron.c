/* An FMU that is none of ours, FMI 2.0 for both interfaces: a leaky neuron that integrates and fires.
 *
 *   x' = on gain u - x / T;  where x reaches the limit (a state event) it fires and x = 0;
 *   every period (a time event) x is sampled.
 *
 * Steps of co-simulation are exact while inputs rest. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

enum { X, RATE, U, LIMIT, T, PERIOD, SAMPLED, REALS };
enum { GAIN, FIRED, INTEGERS };

typedef struct {
    double real[REALS], time, next;
    int integer[INTEGERS], on;
} Neuron;

#define SELF Neuron *m = c

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    if (strcmp(guid, "neuron"))
        return NULL;
    const Neuron start = {.real = {[LIMIT] = 1.0, [T] = 1.0, [PERIOD] = 0.25}, .integer = {[GAIN] = 1}, .on = 1};
    Neuron *m = malloc(sizeof *m);
    *m = start;
    return m;
}

void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean a, fmi2Real b, fmi2Real start, fmi2Boolean d, fmi2Real e)
{
    SELF;
    m->time = start;
    return fmi2OK;
}

static double drive(const Neuron *m)
{
    return m->on ? m->integer[GAIN] * m->real[U] : 0.0;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    SELF;
    const double period = m->real[PERIOD];
    m->next = period * (floor(m->time / period + 1e-9) + 1.0);
    return fmi2OK;
}

/* Both events, if it is time for them. */
static void events(Neuron *m)
{
    if (m->time >= m->next - 1e-9) {
        m->real[SAMPLED] = m->real[X];
        m->next += m->real[PERIOD];
    }
    if (m->real[X] >= m->real[LIMIT] - 1e-9) {
        m->real[X] = 0.0;
        m->integer[FIRED]++;
    }
}

/* Co-simulation: from event to event. */
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real begin, fmi2Real size, fmi2Boolean a)
{
    SELF;
    const double end = begin + size;
    for (m->time = begin; m->time < end;) {
        const double rest = m->real[T] * drive(m), x = m->real[X], part = (rest - m->real[LIMIT]) / (rest - x);
        const double fires = part > 0.0 && part < 1.0 ? m->time - m->real[T] * log(part) : HUGE_VAL;
        const double until = fmin(end, fmin(fires, m->next));
        m->real[X] = rest + (x - rest) * exp((m->time - until) / m->real[T]);
        m->time = until;
        events(m);
    }
    return fmi2OK;
}

/* Model exchange */

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info)
{
    SELF;
    const int fired = m->integer[FIRED];
    events(m);
    memset(info, 0, sizeof *info);
    info->valuesOfContinuousStatesChanged = fired != m->integer[FIRED];
    info->nextEventTimeDefined = fmi2True;
    info->nextEventTime = m->next;
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    SELF;
    m->time = time;
    return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n)
{
    SELF;
    m->real[X] = x[0];
    return fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    SELF;
    x[0] = m->real[X];
    return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real rates[], size_t n)
{
    SELF;
    rates[0] = drive(m) - m->real[X] / m->real[T];
    return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real z[], size_t n)
{
    SELF;
    z[0] = m->real[X] - m->real[LIMIT];
    return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t n)
{
    x[0] = 1.0;
    return fmi2OK;
}

/* Values */

#define ACCESS(Type, member)                                                                                     \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##Type v[])            \
    {                                                                                                            \
        SELF;                                                                                                    \
        for (size_t i = 0; i < n; i++)                                                                           \
            v[i] = (member)[r[i]];                                                                               \
        return fmi2OK;                                                                                           \
    }                                                                                                            \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##Type v[])      \
    {                                                                                                            \
        SELF;                                                                                                    \
        for (size_t i = 0; i < n; i++)                                                                           \
            (member)[r[i]] = v[i];                                                                               \
        return fmi2OK;                                                                                           \
    }

ACCESS(Real, m->real)
ACCESS(Integer, m->integer)
ACCESS(Boolean, &m->on)

#define NOTHING(name)                                                                                            \
    fmi2Status name(fmi2Component c)                                                                             \
    {                                                                                                            \
        return fmi2OK;                                                                                           \
    }

NOTHING(fmi2EnterInitializationMode)
NOTHING(fmi2EnterEventMode)
NOTHING(fmi2EnterContinuousTimeMode)
NOTHING(fmi2Terminate)
NOTHING(fmi2Reset)
