/* Entry points of FMI 2.0: each is a thin layer over instance.h. */
#include "fmi2Functions.h"

#define FMI(Name) fmi2##Name
typedef fmi2Component Component;
typedef fmi2Real Real;
#include "alike.h"

/* Messages: the host takes them as a format of printf, in which FMI 2 gives '#' a meaning too. */
static void deliver(const Reporter *to, const char *name, Status status, const char *category,
                    const char *line)
{
    const fmi2CallbackLogger logger = (fmi2CallbackLogger)to->callback;
    char format[2 * sizeof((Text *)0)->line];
    size_t n = 0;
    for (; *line; line++) {
        if (*line == '%' || *line == '#')
            format[n++] = *line;
        format[n++] = *line;
    }
    format[n] = '\0';
    if (logger)
        logger(to->environment, name, STATUS(status), category, format);
}

/* Life */

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    (void)fmuResourceLocation; /* nothing is read at run time */
    (void)visible;
    if (!functions)
        return NULL; /* and no way to say why */
    const Reporter reporter = {deliver, (void (*)(void))functions->logger, functions->componentEnvironment};
    if (fmuType != fmi2ModelExchange && fmuType != fmi2CoSimulation)
        return instance_not_made(__func__, instanceName, reporter,
                                 "the type is unknown; expected fmi2ModelExchange or fmi2CoSimulation");
    return instance_new(__func__, 2, fmuType == fmi2ModelExchange ? MODEL_EXCHANGE : CO_SIMULATION,
                        instanceName, fmuGUID, loggingOn != fmi2False, reporter);
}

ENTRY(fmi2SetupExperiment,
      (fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
       fmi2Boolean stopTimeDefined, fmi2Real stopTime),
      instance_set_experiment(c, __func__, toleranceDefined ? tolerance : 0.0, startTime,
                              stopTimeDefined != fmi2False, stopTime))
ENTRY(fmi2EnterInitializationMode, (fmi2Component c),
      instance_change(c, __func__, BOTH | INSTANTIATED, INITIALIZATION))
ENTRY(fmi2Terminate, (fmi2Component c),
      instance_change(c, __func__, BOTH | EVENT | CONTINUOUS_TIME | STEP, TERMINATED))

/* Variables: all are Real but for a few Boolean parameters */

ENTRY(fmi2GetReal, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]),
      instance_get(c, __func__, vr, nvr, value))
ENTRY(fmi2SetReal, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]),
      instance_set(c, __func__, vr, nvr, value))
ENTRY(fmi2GetBoolean, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[]),
      instance_get_booleans(c, __func__, vr, nvr, value))
ENTRY(fmi2SetBoolean, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[]),
      instance_set_booleans(c, __func__, vr, nvr, value))

#define NO_VARIABLES(name, mode, Value)                                                         \
    ENTRY(name, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, Value value[]),    \
          ((void)vr, (void)value, instance_none(c, __func__, BOTH | mode, NO_SUCH_TYPE, nvr)))
NO_VARIABLES(fmi2GetInteger, READABLE, fmi2Integer)
NO_VARIABLES(fmi2SetInteger, SETTABLE, const fmi2Integer)
NO_VARIABLES(fmi2GetString, READABLE, fmi2String)
NO_VARIABLES(fmi2SetString, SETTABLE, const fmi2String)

/* State */

ENTRY(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *state), state_save(c, __func__, state))
ENTRY(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate state), state_restore(c, __func__, state))
ENTRY(fmi2FreeFMUstate, (fmi2Component c, fmi2FMUstate *state), state_free(c, __func__, state))
ENTRY(fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size),
      state_size(c, __func__, state, size))
ENTRY(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
      state_write(c, __func__, state, bytes, size))
ENTRY(fmi2DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
      state_read(c, __func__, bytes, size, state))

/* Derivatives */

ENTRY(fmi2GetDirectionalDerivative,
      (fmi2Component c, const fmi2ValueReference unknowns[], size_t nUnknown, const fmi2ValueReference knowns[],
       size_t nKnown, const fmi2Real seed[], fmi2Real result[]),
      instance_derivative(c, __func__, unknowns, nUnknown, knowns, nKnown, seed, result))

/* Model exchange, beside what both standards have alike */

ENTRY(fmi2EnterEventMode, (fmi2Component c),
      instance_change(c, __func__, MODEL_EXCHANGE | EVENT | CONTINUOUS_TIME, EVENT))

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo)
{
    if (!instance_allows(c, __func__, MODEL_EXCHANGE | EVENT) ||
        !instance_has(c, __func__, "the event information", eventInfo))
        return fmi2Error;
    bool defined;
    double next;
    const Status status = instance_update_event(c, &defined, &next);
    *eventInfo = (fmi2EventInfo){fmi2False, fmi2False, fmi2False, fmi2False, defined, next};
    return STATUS(status);
}

ENTRY(fmi2GetDerivatives, (fmi2Component c, fmi2Real derivatives[], size_t nx),
      instance_get_rates(c, __func__, derivatives, nx))
ENTRY(fmi2GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real nominal[], size_t nx),
      instance_get_nominals(c, __func__, READABLE | INSTANTIATED, nominal, nx))

/* Co-simulation */

ENTRY(fmi2SetRealInputDerivatives,
      (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[], const fmi2Real value[]),
      instance_set_slopes(c, __func__, vr, nvr, order, value))
ENTRY(fmi2GetRealOutputDerivatives,
      (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[], fmi2Real value[]),
      ((void)vr, (void)order, (void)value,
       instance_none(c, __func__, CO_SIMULATION | STEP | TERMINATED, "derivatives of outputs", nvr)))
ENTRY(fmi2DoStep,
      (fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
       fmi2Boolean noSetFMUStatePriorToCurrentPoint),
      ((void)noSetFMUStatePriorToCurrentPoint,
       instance_step(c, __func__, currentCommunicationPoint, communicationStepSize)))

fmi2Status fmi2CancelStep(fmi2Component c)
{
    if (instance_allows(c, __func__, CO_SIMULATION | ANY_MODE))
        instance_refuse(c, __func__,
                        "no step is pending; expected none, for each step ends before fmi2DoStep returns");
    return fmi2Error;
}

/* Status of the last step; what is not there is discarded, as the standard says. */
static fmi2Status last_status(const Instance *m, const char *function, const void *value, int kind,
                              int expected)
{
    if (!instance_allows(m, function, CO_SIMULATION | STEP | TERMINATED) ||
        !instance_has(m, function, "the pointer to the status", value))
        return fmi2Error;
    if (kind == expected)
        return fmi2OK;
    Text text = {0};
    text_print(&text,
               "%s: there is no such status; expected fmi2GetStatus with fmi2DoStepStatus, "
               "fmi2GetRealStatus with fmi2LastSuccessfulTime, fmi2GetBooleanStatus with fmi2Terminated, "
               "fmi2GetStringStatus with fmi2PendingStatus",
               function);
    instance_report(m, DISCARD, LOG_WARNINGS, text.line);
    return fmi2Discard;
}

#define LAST_STATUS(name, Value, expected, found)                               \
    fmi2Status name(fmi2Component c, const fmi2StatusKind s, Value *value)   \
    {                                                                        \
        const Instance *m = c;                                               \
        const fmi2Status status = last_status(m, __func__, value, (int)s, expected); \
        if (status == fmi2OK)                                                \
            *value = (found);                                                \
        return status;                                                       \
    }
LAST_STATUS(fmi2GetStatus, fmi2Status, fmi2DoStepStatus, STATUS(m->now.last_step))
LAST_STATUS(fmi2GetRealStatus, fmi2Real, fmi2LastSuccessfulTime, m->now.values[0])
LAST_STATUS(fmi2GetIntegerStatus, fmi2Integer, -1, 0)
LAST_STATUS(fmi2GetBooleanStatus, fmi2Boolean, fmi2Terminated, fmi2False)
LAST_STATUS(fmi2GetStringStatus, fmi2String, fmi2PendingStatus, "")
