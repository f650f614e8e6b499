/* Entry points of FMI 2.0: each is a thin layer over step.h, derivative.h, snapshot.h. */
#include "derivative.h"
#include "snapshot.h"
#include "step.h"

#include "fmi2Functions.h"

/* fmi2Status has the numbers of Status. */
#define STATUS(call) ((fmi2Status)(call))

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

const char *fmi2GetVersion(void)
{
    return fmi2Version;
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
    if (fmuType != fmi2ModelExchange && fmuType != fmi2CoSimulation) {
        instance_not_made(__func__, instanceName, reporter,
                          "the type is unknown; expected fmi2ModelExchange or "
                          "fmi2CoSimulation");
        return NULL;
    }
    return instance_new(__func__, 2, fmuType == fmi2ModelExchange ? MODEL_EXCHANGE : CO_SIMULATION,
                        instanceName, fmuGUID, loggingOn != fmi2False, reporter);
}

void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    return STATUS(instance_select_logs(c, __func__, loggingOn != fmi2False, nCategories, categories));
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance,
                               fmi2Real startTime, fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    return STATUS(instance_set_experiment(c, __func__, toleranceDefined ? tolerance : 0.0, startTime,
                                          stopTimeDefined != fmi2False, stopTime));
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return STATUS(instance_change(c, __func__, BOTH | INSTANTIATED, INITIALIZATION));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return STATUS(instance_initialize(c, __func__));
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return STATUS(instance_change(c, __func__, BOTH | EVENT | CONTINUOUS_TIME | STEP, TERMINATED));
}

fmi2Status fmi2Reset(fmi2Component c)
{
    if (!instance_allows(c, __func__, BOTH | ANY_MODE))
        return fmi2Error;
    instance_reset(c);
    return fmi2OK;
}

/* Variables: all are Real but for a few Boolean parameters */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    return STATUS(instance_get(c, __func__, vr, nvr, value));
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    return STATUS(instance_set(c, __func__, vr, nvr, value));
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    const Instance *m = c;
    if (!instance_can_get_booleans(c, __func__, vr, nvr, value))
        return fmi2Error;
    for (size_t i = 0; i < nvr; i++)
        value[i] = m->now.values[vr[i]] != 0.0 ? fmi2True : fmi2False;
    return fmi2OK;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                          const fmi2Boolean value[])
{
    Instance *m = c;
    if (!instance_can_set_booleans(c, __func__, vr, nvr, value))
        return fmi2Error;
    for (size_t i = 0; i < nvr; i++)
        instance_put(m, vr[i], value[i] != fmi2False ? 1.0 : 0.0);
    return fmi2OK;
}

#define NO_VARIABLES(Type)                                                                                   \
    fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##Type value[]) \
    {                                                                                                        \
        (void)vr, (void)value;                                                                               \
        return STATUS(instance_no_variables(c, __func__, BOTH | READABLE, nvr));                             \
    }                                                                                                        \
    fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,                     \
                             const fmi2##Type value[])                                                       \
    {                                                                                                        \
        (void)vr, (void)value;                                                                               \
        return STATUS(instance_no_variables(c, __func__, BOTH | SETTABLE, nvr));                             \
    }

NO_VARIABLES(Integer)
NO_VARIABLES(String)

/* State */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return STATUS(state_save(c, __func__, FMUstate));
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    return STATUS(state_restore(c, __func__, FMUstate));
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return STATUS(state_free(c, __func__, FMUstate));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    return STATUS(state_size(c, __func__, FMUstate, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[],
                                 size_t size)
{
    return STATUS(state_write(c, __func__, FMUstate, serializedState, size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    return STATUS(state_read(c, __func__, serializedState, size, FMUstate));
}

/* Derivatives */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[],
                                        size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown,
                                        const fmi2Real dvKnown[], fmi2Real dvUnknown[])
{
    return STATUS(
        instance_derivative(c, __func__, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown));
}

/* Model exchange: no event indicators, and states in systems only */

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    return STATUS(instance_change(c, __func__, MODEL_EXCHANGE | EVENT | CONTINUOUS_TIME, EVENT));
}

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

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    return STATUS(instance_change(c, __func__, MODEL_EXCHANGE | EVENT, CONTINUOUS_TIME));
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!instance_allows(c, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME) ||
        !instance_has(c, __func__, "enterEventMode", enterEventMode) ||
        !instance_has(c, __func__, "terminateSimulation", terminateSimulation))
        return fmi2Error;
    *enterEventMode = *terminateSimulation = fmi2False;
    return STATUS(N_MEMORY ? instance_accept(c) : OK);
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    return STATUS(instance_set_time(c, __func__, time));
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx)
{
    return STATUS(instance_set_states(c, __func__, x, nx));
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx)
{
    return STATUS(instance_get_rates(c, __func__, derivatives, nx));
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni)
{
    (void)eventIndicators;
    return instance_allows(c, __func__, MODEL_EXCHANGE | READABLE) &&
                   instance_counts(c, __func__, "event indicators", ni, 0)
               ? fmi2OK
               : fmi2Error;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx)
{
    return STATUS(instance_get_states(c, __func__, x, nx));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx)
{
    return STATUS(instance_get_nominals(c, __func__, READABLE | INSTANTIATED, x_nominal, nx));
}

/* Co-simulation */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                       const fmi2Integer order[], const fmi2Real value[])
{
    return STATUS(instance_set_slopes(c, __func__, vr, nvr, order, value));
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
                                        const fmi2Integer order[], fmi2Real value[])
{
    (void)vr, (void)order, (void)value;
    return instance_allows(c, __func__, CO_SIMULATION | STEP | TERMINATED) &&
                   instance_counts(c, __func__, "derivatives of outputs", nvr, 0)
               ? fmi2OK
               : fmi2Error;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    return STATUS(instance_step(c, __func__, currentCommunicationPoint, communicationStepSize));
}

fmi2Status fmi2CancelStep(fmi2Component c)
{
    if (instance_allows(c, __func__, CO_SIMULATION | ANY_MODE))
        instance_refuse(c, __func__,
                        "no step is pending; expected none, for each step ends before fmi2DoStep returns");
    return fmi2Error;
}

/* Status of the last step; what is not there is discarded, as the standard says. */
static bool has_status(Instance *m, const char *function, const void *value, bool there, fmi2Status *status)
{
    *status = fmi2Error;
    if (!instance_allows(m, function, CO_SIMULATION | STEP | TERMINATED) ||
        !instance_has(m, function, "the pointer to the status", value))
        return false;
    *status = there ? fmi2OK : fmi2Discard;
    if (!there) {
        Text text;
        text_clear(&text);
        text_add(&text, function);
        text_add(&text,
                 ": there is no such status; expected fmi2GetStatus with fmi2DoStepStatus, "
                 "fmi2GetRealStatus with fmi2LastSuccessfulTime, fmi2GetBooleanStatus with fmi2Terminated, "
                 "fmi2GetStringStatus with fmi2PendingStatus");
        instance_report(m, DISCARD, LOG_WARNINGS, text.line);
    }
    return there;
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
{
    const Instance *m = c;
    fmi2Status status;
    if (has_status(c, __func__, value, s == fmi2DoStepStatus, &status))
        *value = STATUS(m->now.last_step);
    return status;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    const Instance *m = c;
    fmi2Status status;
    if (has_status(c, __func__, value, s == fmi2LastSuccessfulTime, &status))
        *value = m->now.values[0];
    return status;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
{
    (void)s;
    fmi2Status status;
    has_status(c, __func__, value, false, &status);
    return status;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    fmi2Status status;
    if (has_status(c, __func__, value, s == fmi2Terminated, &status))
        *value = fmi2False;
    return status;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value)
{
    fmi2Status status;
    if (has_status(c, __func__, value, s == fmi2PendingStatus, &status))
        *value = "";
    return status;
}
