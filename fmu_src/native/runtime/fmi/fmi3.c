/* Functions of FMI 3.0: a thin layer over instance.h. */
#include <string.h>

#include "fmi3Functions.h"

#define FMI(Name) fmi3##Name
typedef fmi3Instance Component;
typedef fmi3Float64 Real;
#include "fmi_common.h"

typedef const fmi3ValueReference *References;

static void log_message(const Logger *logger, const char *name, Status status, const char *category, const char *line)
{
    const fmi3LogMessageCallback log = (fmi3LogMessageCallback)logger->callback;
    (void)name; /* FMI 3 identifies the instance by its environment */
    if (log)
        log(logger->environment, STATUS(status), category, line);
}

/* Life cycle */

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    (void)resourcePath, (void)visible; /* nothing is read or shown at run time */
    const Logger logger = {log_message, (void (*)(void))logMessage, instanceEnvironment};
    return instance_create(__func__, 3, MODEL_EXCHANGE, instanceName, instantiationToken, loggingOn, logger);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)resourcePath, (void)visible, (void)earlyReturnAllowed; /* a step never ends early */
    (void)requiredIntermediateVariables, (void)intermediateUpdate;
    const Logger logger = {log_message, (void (*)(void))logMessage, instanceEnvironment};
    if (eventModeUsed)
        return instance_refuse_creation(__func__, instanceName, logger,
                                        "eventModeUsed = true; expected false, because this FMU has no event mode in "
                                        "co-simulation");
    Instance *m = instance_create(__func__, 3, CO_SIMULATION, instanceName, instantiationToken, loggingOn, logger);
    if (m && nRequiredIntermediateVariables)
        instance_log(m, WARNING, LOG_WARNINGS,
                     "fmi3InstantiateCoSimulation: the required intermediate variables are ignored; "
                     "expected none, because this FMU has no intermediate update");
    return m;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    const Logger logger = {log_message, (void (*)(void))logMessage, instanceEnvironment};
    return instance_refuse_creation(__func__, instanceName, logger,
                                    "this FMU has no scheduled execution; expected model exchange or co-simulation");
}

FMI_FUNCTION(fmi3EnterInitializationMode,
             (fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 startTime,
              fmi3Boolean stopTimeDefined, fmi3Float64 stopTime),
             instance_set_experiment(c, __func__, toleranceDefined ? tolerance : 0.0, startTime, stopTimeDefined,
                                     stopTime) == OK
                 ? instance_enter_mode(c, __func__, BOTH_INTERFACES | INSTANTIATED, INITIALIZATION)
                 : ERROR)
FMI_FUNCTION(fmi3Terminate, (fmi3Instance c),
             instance_enter_mode(c, __func__, BOTH_INTERFACES | EVENT | CONTINUOUS_TIME | STEP | RECONFIGURATION,
                                 TERMINATED))

/* There are no structural parameters: in these modes the host can only set tunable parameters. */

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    const Instance *m = c;
    const bool is_initial = m && m->state.mode == INSTANTIATED;
    return STATUS(instance_enter_mode(c, __func__, BOTH_INTERFACES | INSTANTIATED | EVENT | STEP,
                                      is_initial ? CONFIGURATION : RECONFIGURATION));
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    const Instance *m = c;
    const bool is_initial = m && m->state.mode == CONFIGURATION;
    const unsigned previous_mode = m && m->state.interface_type == MODEL_EXCHANGE ? EVENT : STEP;
    return STATUS(instance_enter_mode(c, __func__, BOTH_INTERFACES | CONFIGURATION | RECONFIGURATION,
                                      is_initial ? (unsigned)INSTANTIATED : previous_mode));
}

/* Get and set variables: all are Float64, except a few Boolean parameters */

#define ACCESSOR(name, Value, function)                                                                         \
    FMI_FUNCTION(name, (fmi3Instance c, References refs, size_t nRefs, Value values[], size_t n),               \
                 instance_check_count(c, __func__, "values", n, nRefs) ? function(c, __func__, refs, n, values) \
                                                                       : ERROR)
ACCESSOR(fmi3GetFloat64, fmi3Float64, instance_get_values)
ACCESSOR(fmi3SetFloat64, const fmi3Float64, instance_set_values)
ACCESSOR(fmi3GetBoolean, fmi3Boolean, instance_get_booleans)
ACCESSOR(fmi3SetBoolean, const fmi3Boolean, instance_set_booleans)

#define EMPTY_ACCESSOR(name, mode, parameters, unused) \
    FMI_FUNCTION(name, parameters,                     \
                 ((void)refs, (void)values, unused,    \
                  instance_check_empty(c, __func__, BOTH_INTERFACES | mode, UNSUPPORTED_TYPE, nRefs | n)))
#define EMPTY_ACCESSORS(Type)                                                                               \
    EMPTY_ACCESSOR(fmi3Get##Type, READABLE,                                                                 \
                   (fmi3Instance c, References refs, size_t nRefs, fmi3##Type values[], size_t n), (void)0) \
    EMPTY_ACCESSOR(fmi3Set##Type, SETTABLE,                                                                 \
                   (fmi3Instance c, References refs, size_t nRefs, const fmi3##Type values[], size_t n), (void)0)
EMPTY_ACCESSORS(Float32)
EMPTY_ACCESSORS(Int8)
EMPTY_ACCESSORS(UInt8)
EMPTY_ACCESSORS(Int16)
EMPTY_ACCESSORS(UInt16)
EMPTY_ACCESSORS(Int32)
EMPTY_ACCESSORS(UInt32)
EMPTY_ACCESSORS(Int64)
EMPTY_ACCESSORS(UInt64)
EMPTY_ACCESSORS(String)
EMPTY_ACCESSOR(fmi3GetBinary, READABLE,
               (fmi3Instance c, References refs, size_t nRefs, size_t sizes[], fmi3Binary values[], size_t n),
               (void)sizes)
EMPTY_ACCESSOR(fmi3SetBinary, SETTABLE,
               (fmi3Instance c, References refs, size_t nRefs, const size_t sizes[], const fmi3Binary values[],
                size_t n),
               (void)sizes)

/* Clocks: none */

#define EMPTY_CLOCK_ACCESSOR(name, unused, ...)                                                                \
    fmi3Status name(fmi3Instance c, References refs, size_t nRefs, __VA_ARGS__)                                \
    {                                                                                                          \
        (void)refs, unused;                                                                                    \
        return STATUS(instance_check_empty(c, __func__, BOTH_INTERFACES | ANY_MODE, UNSUPPORTED_TYPE, nRefs)); \
    }
EMPTY_CLOCK_ACCESSOR(fmi3GetClock, (void)values, fmi3Clock values[])
EMPTY_CLOCK_ACCESSOR(fmi3SetClock, (void)values, const fmi3Clock values[])
EMPTY_CLOCK_ACCESSOR(fmi3GetIntervalDecimal, ((void)intervals, (void)qualifiers), fmi3Float64 intervals[],
                     fmi3IntervalQualifier qualifiers[])
EMPTY_CLOCK_ACCESSOR(fmi3GetIntervalFraction, ((void)counters, (void)resolutions, (void)qualifiers),
                     fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
EMPTY_CLOCK_ACCESSOR(fmi3GetShiftDecimal, (void)shifts, fmi3Float64 shifts[])
EMPTY_CLOCK_ACCESSOR(fmi3GetShiftFraction, ((void)counters, (void)resolutions), fmi3UInt64 counters[],
                     fmi3UInt64 resolutions[])
EMPTY_CLOCK_ACCESSOR(fmi3SetIntervalDecimal, (void)intervals, const fmi3Float64 intervals[])
EMPTY_CLOCK_ACCESSOR(fmi3SetIntervalFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
                     const fmi3UInt64 resolutions[])
EMPTY_CLOCK_ACCESSOR(fmi3SetShiftDecimal, (void)shifts, const fmi3Float64 shifts[])
EMPTY_CLOCK_ACCESSOR(fmi3SetShiftFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
                     const fmi3UInt64 resolutions[])

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clockReference, fmi3Float64 activationTime)
{
    (void)clockReference, (void)activationTime;
    if (instance_check_mode(c, __func__, BOTH_INTERFACES | ANY_MODE))
        instance_log_error(c, __func__, "this FMU has no model partitions; expected no such call");
    return fmi3Error;
}

/* Dependencies of outputs on inputs and states; all variables are scalars, with the element index 0 */

static size_t count_dependencies(fmi3ValueReference ref)
{
    size_t n = 0;
    if (ref >= FIRST_OUTPUT && ref < FIRST_PARAMETER)
        for (size_t i = 0; i < N_INPUTS + N_STATES; i++)
            n += output_dependencies[ref - FIRST_OUTPUT][i];
    return n;
}

static bool check_dependencies(const Instance *m, const char *function, fmi3ValueReference ref)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE))
        return false;
    return ref < N_VALUES ||
           instance_log_error(m, function, "the value reference is unknown; expected one of the model description") ==
               OK;
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference valueReference, size_t *nDependencies)
{
    if (!check_dependencies(c, __func__, valueReference) || !CHECK_POINTER(nDependencies))
        return fmi3Error;
    *nDependencies = count_dependencies(valueReference);
    return fmi3OK;
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
                                       fmi3ValueReference independents[], size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies)
{
    if (!check_dependencies(c, __func__, dependent) ||
        !instance_check_count(c, __func__, "dependencies", nDependencies, count_dependencies(dependent)))
        return fmi3Error;
    if (nDependencies == 0)
        return fmi3OK;
    if (!CHECK_POINTER(elementIndicesOfDependent) || !CHECK_POINTER(independents) ||
        !CHECK_POINTER(elementIndicesOfIndependents) || !CHECK_POINTER(dependencyKinds))
        return fmi3Error;
    for (uint32_t i = 0, n = 0; i < N_INPUTS + N_STATES; i++)
        if (output_dependencies[dependent - FIRST_OUTPUT][i]) {
            elementIndicesOfDependent[n] = elementIndicesOfIndependents[n] = 0;
            independents[n] = FIRST_INPUT + i;
            dependencyKinds[n++] = fmi3Dependent;
        }
    return fmi3OK;
}

/* FMU states */

FMI_FUNCTION(fmi3GetFMUState, (fmi3Instance c, fmi3FMUState *state), state_save(c, __func__, state))
FMI_FUNCTION(fmi3SetFMUState, (fmi3Instance c, fmi3FMUState state), state_restore(c, __func__, state))
FMI_FUNCTION(fmi3FreeFMUState, (fmi3Instance c, fmi3FMUState *state), state_free(c, __func__, state))
FMI_FUNCTION(fmi3SerializedFMUStateSize, (fmi3Instance c, fmi3FMUState state, size_t *size),
             state_serialized_size(c, __func__, state, size))
FMI_FUNCTION(fmi3SerializeFMUState, (fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size),
             state_serialize(c, __func__, state, bytes, size))
FMI_FUNCTION(fmi3DeserializeFMUState, (fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state),
             state_deserialize(c, __func__, bytes, size, state))

/* Derivatives */

#define DERIVATIVE(name, function, nSeeds, nResults)                                                              \
    FMI_FUNCTION(name,                                                                                            \
                 (fmi3Instance c, References unknowns, size_t nUnknowns, References knowns, size_t nKnowns,       \
                  const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity),        \
                 instance_check_count(c, __func__, "elements of the seed", nSeed, nSeeds) &&                      \
                         instance_check_count(c, __func__, "elements of the sensitivity", nSensitivity, nResults) \
                     ? function(c, __func__, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity)             \
                     : ERROR)
DERIVATIVE(fmi3GetDirectionalDerivative, instance_directional_derivative, nKnowns, nUnknowns)
DERIVATIVE(fmi3GetAdjointDerivative, instance_adjoint_derivative, nUnknowns, nKnowns)

/* Events: of the host, at which it may change parameters; time events, where the outputs over time have a corner */

FMI_FUNCTION(fmi3EnterEventMode, (fmi3Instance c),
             instance_enter_mode(c, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME, EVENT))
FMI_FUNCTION(fmi3EvaluateDiscreteStates, (fmi3Instance c),
             instance_check_mode(c, __func__, BOTH_INTERFACES | INITIALIZATION | EVENT) ? OK : ERROR)

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
                                    fmi3Float64 *nextEventTime)
{
    if (!instance_check_mode(c, __func__, BOTH_INTERFACES | EVENT) || !CHECK_POINTER(discreteStatesNeedUpdate) ||
        !CHECK_POINTER(terminateSimulation) || !CHECK_POINTER(nominalsOfContinuousStatesChanged) ||
        !CHECK_POINTER(valuesOfContinuousStatesChanged) || !CHECK_POINTER(nextEventTimeDefined) ||
        !CHECK_POINTER(nextEventTime))
        return fmi3Error;
    *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = fmi3False;
    return STATUS(instance_update_discrete_states(c, nextEventTimeDefined, nextEventTime));
}

/* Model exchange: functions that fmi_common.h does not have */

FMI_FUNCTION(fmi3GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 derivatives[], size_t nx),
             instance_get_state_derivatives(c, __func__, derivatives, nx))
FMI_FUNCTION(fmi3GetNominalsOfContinuousStates, (fmi3Instance c, fmi3Float64 nominal[], size_t nx),
             instance_get_nominals(c, __func__, READABLE, nominal, nx))

static Status get_constant_count(const Instance *m, const char *function, size_t *number, size_t value)
{
    if (!instance_check_mode(m, function, MODEL_EXCHANGE | ANY_MODE) ||
        !instance_check_pointer(m, function, "the pointer to the number", number))
        return ERROR;
    *number = value;
    return OK;
}

FMI_FUNCTION(fmi3GetNumberOfEventIndicators, (fmi3Instance c, size_t *number),
             get_constant_count(c, __func__, number, 0))
FMI_FUNCTION(fmi3GetNumberOfContinuousStates, (fmi3Instance c, size_t *number),
             get_constant_count(c, __func__, number, N_STATES))

/* Co-simulation */

FMI_FUNCTION(fmi3EnterStepMode, (fmi3Instance c), instance_enter_mode(c, __func__, CO_SIMULATION | EVENT, STEP))
FMI_FUNCTION(fmi3GetOutputDerivatives,
             (fmi3Instance c, References refs, size_t nRefs, const fmi3Int32 orders[], fmi3Float64 values[], size_t n),
             ((void)refs, (void)orders, (void)values,
              instance_check_empty(c, __func__, CO_SIMULATION | STEP | TERMINATED, "derivatives of outputs",
                                   nRefs | n)))

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    const Instance *m = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!CHECK_POINTER(eventHandlingNeeded) || !CHECK_POINTER(terminateSimulation) || !CHECK_POINTER(earlyReturn) ||
        !CHECK_POINTER(lastSuccessfulTime))
        return fmi3Error;
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    const Status status = instance_do_step(c, __func__, currentCommunicationPoint, communicationStepSize);
    if (m)
        *lastSuccessfulTime = m->state.values[0];
    return STATUS(status);
}

/* Beyond FMI: many load steps in one call, for programs that load the library without an FMU. */

/* Evaluate a path of `n` points and return how many of them were evaluated; fewer than `n` if one was refused,
 * with a message. The path starts in the virgin state; with `each_from_rest` every point is reached on a path of
 * its own from the virgin state.
 *
 * inputs       : value references (n_inputs); their values (n, n_inputs), one row a point
 * outputs      : value references (n_outputs); their values (n, n_outputs) are written */
FMI3_Export size_t jointfmu_follow_path(fmi3Instance c, fmi3Boolean each_from_rest, size_t n, size_t n_inputs,
                                        const fmi3ValueReference inputs[],
                                        const fmi3Float64 input_values[], size_t n_outputs,
                                        const fmi3ValueReference outputs[], fmi3Float64 output_values[]);
size_t jointfmu_follow_path(fmi3Instance c, fmi3Boolean each_from_rest, size_t n, size_t n_inputs,
                            const fmi3ValueReference inputs[], const fmi3Float64 input_values[], size_t n_outputs,
                            const fmi3ValueReference outputs[], fmi3Float64 output_values[])
{
    Instance *m = c;
    m->state.reported_warnings = 0;
    for (size_t i = 0; i < n; i++) {
        if (each_from_rest || i == 0) {
            memset(&m->state.path, 0, sizeof m->state.path);
            m->outputs_outdated = true;
        }
        if (instance_set_values(m, __func__, inputs, n_inputs, input_values + i * n_inputs) != OK ||
            instance_accept_inputs(m) != OK)
            return i;
        for (size_t k = 0; k < n_outputs; k++)
            output_values[i * n_outputs + k] = m->state.values[outputs[k]];
    }
    return n;
}
