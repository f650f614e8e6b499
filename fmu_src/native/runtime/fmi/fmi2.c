/* Functions of FMI 2.0: a thin layer over instance.h. */
#include "fmi2Functions.h"

#define FMI(Name) fmi2##Name
typedef fmi2Component Component;
typedef fmi2Real Real;
#include "fmi_common.h"

/* Call the host's logger. Its message is a printf format, in which FMI 2 also gives '#' a meaning: both are escaped. */
static void log_message(const Logger *logger, const char *name, Status status, const char *category, const char *line)
{
    const fmi2CallbackLogger callback = (fmi2CallbackLogger)logger->callback;
    char format[2 * sizeof((Text *)0)->line];
    size_t n = 0;
    for (; *line; line++) {
        if (*line == '%' || *line == '#')
            format[n++] = *line;
        format[n++] = *line;
    }
    format[n] = '\0';
    if (callback)
        callback(logger->environment, name, STATUS(status), category, format);
}

/* Life cycle */

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
        return NULL; /* without a logger for an error message */
    const Logger logger = {log_message, (void (*)(void))functions->logger, functions->componentEnvironment};
    if (fmuType != fmi2ModelExchange && fmuType != fmi2CoSimulation)
        return instance_refuse_creation(__func__, instanceName, logger,
                                        "the type is unknown; expected fmi2ModelExchange or fmi2CoSimulation");
    return instance_create(__func__, 2, fmuType == fmi2ModelExchange ? MODEL_EXCHANGE : CO_SIMULATION, instanceName,
                           fmuGUID, loggingOn != fmi2False, logger);
}

FMI_FUNCTION(fmi2SetupExperiment,
             (fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
              fmi2Boolean stopTimeDefined, fmi2Real stopTime),
             instance_set_experiment(c, __func__, toleranceDefined ? tolerance : 0.0, startTime,
                                     stopTimeDefined != fmi2False, stopTime))
FMI_FUNCTION(fmi2EnterInitializationMode, (fmi2Component c),
             instance_enter_mode(c, __func__, BOTH_INTERFACES | INSTANTIATED, INITIALIZATION))
FMI_FUNCTION(fmi2Terminate, (fmi2Component c),
             instance_enter_mode(c, __func__, BOTH_INTERFACES | EVENT | CONTINUOUS_TIME | STEP, TERMINATED))

/* Get and set variables: all are Real, except a few Boolean parameters */

FMI_FUNCTION(fmi2GetReal, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]),
             instance_get_values(c, __func__, vr, nvr, value))
FMI_FUNCTION(fmi2SetReal, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]),
             instance_set_values(c, __func__, vr, nvr, value))
FMI_FUNCTION(fmi2GetBoolean, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[]),
             instance_get_booleans(c, __func__, vr, nvr, value))
FMI_FUNCTION(fmi2SetBoolean, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[]),
             instance_set_booleans(c, __func__, vr, nvr, value))

#define EMPTY_ACCESSOR(name, mode, Value)                                                  \
    FMI_FUNCTION(                                                                          \
        name, (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, Value value[]), \
        ((void)vr, (void)value, instance_check_empty(c, __func__, BOTH_INTERFACES | mode, UNSUPPORTED_TYPE, nvr)))
EMPTY_ACCESSOR(fmi2GetInteger, READABLE, fmi2Integer)
EMPTY_ACCESSOR(fmi2SetInteger, SETTABLE, const fmi2Integer)
EMPTY_ACCESSOR(fmi2GetString, READABLE, fmi2String)
EMPTY_ACCESSOR(fmi2SetString, SETTABLE, const fmi2String)

/* FMU states */

FMI_FUNCTION(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *state), state_save(c, __func__, state))
FMI_FUNCTION(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate state), state_restore(c, __func__, state))
FMI_FUNCTION(fmi2FreeFMUstate, (fmi2Component c, fmi2FMUstate *state), state_free(c, __func__, state))
FMI_FUNCTION(fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size),
             state_serialized_size(c, __func__, state, size))
FMI_FUNCTION(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size),
             state_serialize(c, __func__, state, bytes, size))
FMI_FUNCTION(fmi2DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state),
             state_deserialize(c, __func__, bytes, size, state))

/* Derivatives */

FMI_FUNCTION(fmi2GetDirectionalDerivative,
             (fmi2Component c, const fmi2ValueReference unknowns[], size_t nUnknown, const fmi2ValueReference knowns[],
              size_t nKnown, const fmi2Real seed[], fmi2Real result[]),
             instance_directional_derivative(c, __func__, unknowns, nUnknown, knowns, nKnown, seed, result))

/* Model exchange: functions that fmi_common.h does not have */

FMI_FUNCTION(fmi2EnterEventMode, (fmi2Component c),
             instance_enter_mode(c, __func__, MODEL_EXCHANGE | EVENT | CONTINUOUS_TIME, EVENT))

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *eventInfo)
{
    if (!instance_check_mode(c, __func__, MODEL_EXCHANGE | EVENT) ||
        !instance_check_pointer(c, __func__, "the event information", eventInfo))
        return fmi2Error;
    bool time_defined;
    double next_time;
    const Status status = instance_update_discrete_states(c, &time_defined, &next_time);
    *eventInfo = (fmi2EventInfo){fmi2False, fmi2False, fmi2False, fmi2False, time_defined, next_time};
    return STATUS(status);
}

FMI_FUNCTION(fmi2GetDerivatives, (fmi2Component c, fmi2Real derivatives[], size_t nx),
             instance_get_state_derivatives(c, __func__, derivatives, nx))
FMI_FUNCTION(fmi2GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real nominal[], size_t nx),
             instance_get_nominals(c, __func__, READABLE | INSTANTIATED, nominal, nx))

/* Co-simulation */

FMI_FUNCTION(fmi2SetRealInputDerivatives,
             (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
              const fmi2Real value[]),
             instance_set_input_derivatives(c, __func__, vr, nvr, order, value))
FMI_FUNCTION(fmi2GetRealOutputDerivatives,
             (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[], fmi2Real value[]),
             ((void)vr, (void)order, (void)value,
              instance_check_empty(c, __func__, CO_SIMULATION | STEP | TERMINATED, "derivatives of outputs", nvr)))
FMI_FUNCTION(fmi2DoStep,
             (fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
              fmi2Boolean noSetFMUStatePriorToCurrentPoint),
             ((void)noSetFMUStatePriorToCurrentPoint,
              instance_do_step(c, __func__, currentCommunicationPoint, communicationStepSize)))

fmi2Status fmi2CancelStep(fmi2Component c)
{
    if (instance_check_mode(c, __func__, CO_SIMULATION | ANY_MODE))
        instance_log_error(c, __func__,
                           "no step is pending, because each step ends before fmi2DoStep returns; expected no such "
                           "call");
    return fmi2Error;
}

/* Whether a status of the last step is available; if not, the result is fmi2Discard, as in the standard. */
static fmi2Status check_status_kind(const Instance *m, const char *function, const void *value, int status_kind,
                                    int expected)
{
    if (!instance_check_mode(m, function, CO_SIMULATION | STEP | TERMINATED) ||
        !instance_check_pointer(m, function, "the pointer to the status", value))
        return fmi2Error;
    if (status_kind == expected)
        return fmi2OK;
    Text text = {0};
    text_append_format(&text,
                       "%s: there is no such status; expected fmi2GetStatus with fmi2DoStepStatus, "
                       "fmi2GetRealStatus with fmi2LastSuccessfulTime, fmi2GetBooleanStatus with fmi2Terminated, "
                       "fmi2GetStringStatus with fmi2PendingStatus",
                       function);
    instance_log(m, DISCARD, LOG_ERRORS, text.line);
    return fmi2Discard;
}

#define GET_STATUS(name, Value, expected, status_value)                                    \
    fmi2Status name(fmi2Component c, const fmi2StatusKind s, Value *value)                 \
    {                                                                                      \
        const Instance *m = c;                                                             \
        const fmi2Status status = check_status_kind(m, __func__, value, (int)s, expected); \
        if (status == fmi2OK)                                                              \
            *value = (status_value);                                                       \
        return status;                                                                     \
    }
GET_STATUS(fmi2GetStatus, fmi2Status, fmi2DoStepStatus, STATUS(m->state.last_step_status))
GET_STATUS(fmi2GetRealStatus, fmi2Real, fmi2LastSuccessfulTime, m->state.values[0])
GET_STATUS(fmi2GetIntegerStatus, fmi2Integer, -1, 0)
GET_STATUS(fmi2GetBooleanStatus, fmi2Boolean, fmi2Terminated, fmi2False)
GET_STATUS(fmi2GetStringStatus, fmi2String, fmi2PendingStatus, "")
