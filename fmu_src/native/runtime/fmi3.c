/* Entry points of FMI 3.0: each is a thin layer over step.h, derivative.h, snapshot.h. */
#include "derivative.h"
#include "snapshot.h"
#include "step.h"

#include "fmi3Functions.h"

/* fmi3Status has the numbers of Status. */
#define STATUS(call) ((fmi3Status)(call))

typedef const fmi3ValueReference *References;

static void deliver(const Reporter *to, const char *name, Status status, const char *category,
                    const char *line)
{
    const fmi3LogMessageCallback log = (fmi3LogMessageCallback)to->callback;
    (void)name; /* the host knows it by the environment */
    if (log)
        log(to->environment, STATUS(status), category, line);
}

/* Life */

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    (void)resourcePath, (void)visible; /* nothing is read or shown at run time */
    const Reporter reporter = {deliver, (void (*)(void))logMessage, instanceEnvironment};
    return instance_new(__func__, 3, MODEL_EXCHANGE, instanceName, instantiationToken, loggingOn, reporter);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment,
                                         fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    (void)resourcePath, (void)visible, (void)earlyReturnAllowed; /* a step never ends early */
    (void)requiredIntermediateVariables, (void)intermediateUpdate;
    const Reporter reporter = {deliver, (void (*)(void))logMessage, instanceEnvironment};
    if (eventModeUsed) {
        instance_not_made(__func__, instanceName, reporter,
                          "event mode is wanted in co-simulation; expected eventModeUsed = false, as the model "
                          "description says");
        return NULL;
    }
    Instance *m =
        instance_new(__func__, 3, CO_SIMULATION, instanceName, instantiationToken, loggingOn, reporter);
    if (m && nRequiredIntermediateVariables)
        instance_report(m, WARNING, LOG_WARNINGS,
                        "fmi3InstantiateCoSimulation: intermediate variables are wanted and left out; "
                        "expected none, for there is no intermediate update");
    return m;
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath, fmi3Boolean visible,
    fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
    fmi3ClockUpdateCallback clockUpdate, fmi3LockPreemptionCallback lockPreemption,
    fmi3UnlockPreemptionCallback unlockPreemption)
{
    (void)instantiationToken, (void)resourcePath, (void)visible, (void)loggingOn;
    (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    const Reporter reporter = {deliver, (void (*)(void))logMessage, instanceEnvironment};
    instance_not_made(__func__, instanceName, reporter,
                      "this FMU has no scheduled execution; expected model exchange or co-simulation");
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    instance_free(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    return STATUS(instance_select_logs(instance, __func__, loggingOn, nCategories, categories));
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined,
                                       fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    if (instance_set_experiment(instance, __func__, toleranceDefined ? tolerance : 0.0, startTime, stopTimeDefined,
                                stopTime) != OK)
        return fmi3Error;
    return STATUS(instance_change(instance, __func__, BOTH | INSTANTIATED, INITIALIZATION));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    return STATUS(instance_initialize(instance, __func__));
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    return STATUS(instance_change(instance, __func__, BOTH | EVENT | CONTINUOUS_TIME | STEP | RECONFIGURATION,
                                  TERMINATED));
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    if (!instance_allows(instance, __func__, BOTH | ANY_MODE))
        return fmi3Error;
    instance_reset(instance);
    return fmi3OK;
}

/* There is no structural parameter: these modes only take other values of the tunable ones. */

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
    const Instance *m = instance;
    const bool first = m && m->now.mode == INSTANTIATED;
    return STATUS(instance_change(instance, __func__, BOTH | INSTANTIATED | EVENT | STEP,
                                  first ? CONFIGURATION : RECONFIGURATION));
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
    const Instance *m = instance;
    const bool first = m && m->now.mode == CONFIGURATION;
    const unsigned before = m && m->now.kind == MODEL_EXCHANGE ? EVENT : STEP;
    return STATUS(instance_change(instance, __func__, BOTH | CONFIGURATION | RECONFIGURATION,
                                  first ? (unsigned)INSTANTIATED : before));
}

/* Variables: all are Float64 but for a few Boolean parameters */

fmi3Status fmi3GetFloat64(fmi3Instance instance, References valueReferences, size_t nValueReferences,
                          fmi3Float64 values[], size_t nValues)
{
    if (nValues != nValueReferences &&
        !instance_counts(instance, __func__, "values", nValues, nValueReferences))
        return fmi3Error;
    return STATUS(instance_get(instance, __func__, valueReferences, nValueReferences, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, References valueReferences, size_t nValueReferences,
                          const fmi3Float64 values[], size_t nValues)
{
    if (nValues != nValueReferences &&
        !instance_counts(instance, __func__, "values", nValues, nValueReferences))
        return fmi3Error;
    return STATUS(instance_set(instance, __func__, valueReferences, nValueReferences, values));
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, References valueReferences, size_t nValueReferences,
                          fmi3Boolean values[], size_t nValues)
{
    const Instance *m = instance;
    if (!instance_counts(m, __func__, "values", nValues, nValueReferences) ||
        !instance_can_get_booleans(instance, __func__, valueReferences, nValueReferences, values))
        return fmi3Error;
    for (size_t i = 0; i < nValues; i++)
        values[i] = m->now.values[valueReferences[i]] != 0.0;
    return fmi3OK;
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, References valueReferences, size_t nValueReferences,
                          const fmi3Boolean values[], size_t nValues)
{
    Instance *m = instance;
    if (!instance_counts(m, __func__, "values", nValues, nValueReferences) ||
        !instance_can_set_booleans(instance, __func__, valueReferences, nValueReferences, values))
        return fmi3Error;
    for (size_t i = 0; i < nValues; i++)
        instance_put(m, valueReferences[i], values[i] ? 1.0 : 0.0);
    return fmi3OK;
}

#define NO_VARIABLES(Type)                                                                                   \
    fmi3Status fmi3Get##Type(fmi3Instance instance, References valueReferences, size_t nValueReferences,     \
                             fmi3##Type values[], size_t nValues)                                            \
    {                                                                                                        \
        (void)valueReferences, (void)values;                                                                 \
        return STATUS(                                                                                       \
            instance_no_variables(instance, __func__, BOTH | READABLE, nValueReferences | nValues));         \
    }                                                                                                        \
    fmi3Status fmi3Set##Type(fmi3Instance instance, References valueReferences, size_t nValueReferences,     \
                             const fmi3##Type values[], size_t nValues)                                      \
    {                                                                                                        \
        (void)valueReferences, (void)values;                                                                 \
        return STATUS(                                                                                       \
            instance_no_variables(instance, __func__, BOTH | SETTABLE, nValueReferences | nValues));         \
    }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(String)

fmi3Status fmi3GetBinary(fmi3Instance instance, References valueReferences, size_t nValueReferences,
                         size_t valueSizes[], fmi3Binary values[], size_t nValues)
{
    (void)valueReferences, (void)valueSizes, (void)values;
    return STATUS(instance_no_variables(instance, __func__, BOTH | READABLE, nValueReferences | nValues));
}

fmi3Status fmi3SetBinary(fmi3Instance instance, References valueReferences, size_t nValueReferences,
                         const size_t valueSizes[], const fmi3Binary values[], size_t nValues)
{
    (void)valueReferences, (void)valueSizes, (void)values;
    return STATUS(instance_no_variables(instance, __func__, BOTH | SETTABLE, nValueReferences | nValues));
}

/* Clocks: none */

#define NO_CLOCKS(name, unused, ...)                                                                         \
    fmi3Status name(fmi3Instance instance, References valueReferences, size_t nValueReferences, __VA_ARGS__) \
    {                                                                                                        \
        (void)valueReferences, unused;                                                                       \
        return STATUS(instance_no_variables(instance, __func__, BOTH | ANY_MODE, nValueReferences));         \
    }

NO_CLOCKS(fmi3GetClock, (void)values, fmi3Clock values[])
NO_CLOCKS(fmi3SetClock, (void)values, const fmi3Clock values[])
NO_CLOCKS(fmi3GetIntervalDecimal, ((void)intervals, (void)qualifiers), fmi3Float64 intervals[],
          fmi3IntervalQualifier qualifiers[])
NO_CLOCKS(fmi3GetIntervalFraction, ((void)counters, (void)resolutions, (void)qualifiers),
          fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NO_CLOCKS(fmi3GetShiftDecimal, (void)shifts, fmi3Float64 shifts[])
NO_CLOCKS(fmi3GetShiftFraction, ((void)counters, (void)resolutions), fmi3UInt64 counters[],
          fmi3UInt64 resolutions[])
NO_CLOCKS(fmi3SetIntervalDecimal, (void)intervals, const fmi3Float64 intervals[])
NO_CLOCKS(fmi3SetIntervalFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
          const fmi3UInt64 resolutions[])
NO_CLOCKS(fmi3SetShiftDecimal, (void)shifts, const fmi3Float64 shifts[])
NO_CLOCKS(fmi3SetShiftFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
          const fmi3UInt64 resolutions[])

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clockReference,
                                      fmi3Float64 activationTime)
{
    (void)clockReference, (void)activationTime;
    if (instance_allows(instance, __func__, BOTH | ANY_MODE))
        instance_refuse(instance, __func__, "this FMU has no model partitions; expected no such call");
    return fmi3Error;
}

/* Dependencies: an output on inputs and states, element 0 being the whole variable */

static size_t n_dependencies(fmi3ValueReference ref)
{
    size_t n = 0;
    if (ref >= FIRST_OUTPUT && ref < FIRST_PARAMETER)
        for (size_t i = 0; i < N_INPUTS + N_STATES; i++)
            n += depends[ref - FIRST_OUTPUT][i];
    return n;
}

static bool has_dependencies(const Instance *m, const char *function, fmi3ValueReference ref)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE))
        return false;
    if (ref < N_VALUES)
        return true;
    instance_refuse(m, function, "the value reference is unknown; expected one of the model description");
    return false;
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference valueReference,
                                               size_t *nDependencies)
{
    if (!has_dependencies(instance, __func__, valueReference) ||
        !instance_has(instance, __func__, "nDependencies", nDependencies))
        return fmi3Error;
    *nDependencies = n_dependencies(valueReference);
    return fmi3OK;
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent,
                                       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                       size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies)
{
    if (!has_dependencies(instance, __func__, dependent) ||
        !instance_counts(instance, __func__, "dependencies", nDependencies, n_dependencies(dependent)))
        return fmi3Error;
    if (nDependencies == 0)
        return fmi3OK;
    if (!instance_has(instance, __func__, "elementIndicesOfDependent", elementIndicesOfDependent) ||
        !instance_has(instance, __func__, "independents", independents) ||
        !instance_has(instance, __func__, "elementIndicesOfIndependents", elementIndicesOfIndependents) ||
        !instance_has(instance, __func__, "dependencyKinds", dependencyKinds))
        return fmi3Error;
    for (uint32_t i = 0, n = 0; i < N_INPUTS + N_STATES; i++)
        if (depends[dependent - FIRST_OUTPUT][i]) {
            elementIndicesOfDependent[n] = elementIndicesOfIndependents[n] = 0;
            independents[n] = FIRST_INPUT + i;
            dependencyKinds[n++] = fmi3Dependent;
        }
    return fmi3OK;
}

/* State */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return STATUS(state_save(instance, __func__, FMUState));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    return STATUS(state_restore(instance, __func__, FMUState));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return STATUS(state_free(instance, __func__, FMUState));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    return STATUS(state_size(instance, __func__, FMUState, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[],
                                 size_t size)
{
    return STATUS(state_write(instance, __func__, FMUState, serializedState, size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState)
{
    return STATUS(state_read(instance, __func__, serializedState, size, FMUState));
}

/* Derivatives */

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, References unknowns, size_t nUnknowns,
                                        References knowns, size_t nKnowns, const fmi3Float64 seed[],
                                        size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity)
{
    if (!instance_counts(instance, __func__, "elements of the seed", nSeed, nKnowns) ||
        !instance_counts(instance, __func__, "elements of the sensitivity", nSensitivity, nUnknowns))
        return fmi3Error;
    return STATUS(
        instance_derivative(instance, __func__, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity));
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, References unknowns, size_t nUnknowns,
                                    References knowns, size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
                                    fmi3Float64 sensitivity[], size_t nSensitivity)
{
    if (!instance_counts(instance, __func__, "elements of the seed", nSeed, nUnknowns) ||
        !instance_counts(instance, __func__, "elements of the sensitivity", nSensitivity, nKnowns))
        return fmi3Error;
    return STATUS(
        instance_adjoint(instance, __func__, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity));
}

/* Events: those of the host, who may change parameters in them, and corners of a course over time */

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    return STATUS(instance_change(instance, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME, EVENT));
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    return instance_allows(instance, __func__, BOTH | INITIALIZATION | EVENT) ? fmi3OK : fmi3Error;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)
{
    if (!instance_allows(instance, __func__, BOTH | EVENT) ||
        !instance_has(instance, __func__, "discreteStatesNeedUpdate", discreteStatesNeedUpdate) ||
        !instance_has(instance, __func__, "terminateSimulation", terminateSimulation) ||
        !instance_has(instance, __func__, "nominalsOfContinuousStatesChanged",
                      nominalsOfContinuousStatesChanged) ||
        !instance_has(instance, __func__, "valuesOfContinuousStatesChanged",
                      valuesOfContinuousStatesChanged) ||
        !instance_has(instance, __func__, "nextEventTimeDefined", nextEventTimeDefined) ||
        !instance_has(instance, __func__, "nextEventTime", nextEventTime))
        return fmi3Error;
    *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = fmi3False;
    return STATUS(instance_update_event(instance, nextEventTimeDefined, nextEventTime));
}

/* Model exchange: no event indicators, and states in systems only */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    return STATUS(instance_change(instance, __func__, MODEL_EXCHANGE | EVENT, CONTINUOUS_TIME));
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!instance_allows(instance, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME) ||
        !instance_has(instance, __func__, "enterEventMode", enterEventMode) ||
        !instance_has(instance, __func__, "terminateSimulation", terminateSimulation))
        return fmi3Error;
    *enterEventMode = *terminateSimulation = fmi3False;
    return STATUS(N_MEMORY ? instance_accept(instance) : OK);
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    return STATUS(instance_set_time(instance, __func__, time));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 continuousStates[],
                                   size_t nContinuousStates)
{
    return STATUS(instance_set_states(instance, __func__, continuousStates, nContinuousStates));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[],
                                             size_t nContinuousStates)
{
    return STATUS(instance_get_rates(instance, __func__, derivatives, nContinuousStates));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 eventIndicators[],
                                  size_t nEventIndicators)
{
    (void)eventIndicators;
    return instance_allows(instance, __func__, MODEL_EXCHANGE | READABLE) &&
                   instance_counts(instance, __func__, "event indicators", nEventIndicators, 0)
               ? fmi3OK
               : fmi3Error;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 continuousStates[],
                                   size_t nContinuousStates)
{
    return STATUS(instance_get_states(instance, __func__, continuousStates, nContinuousStates));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[],
                                             size_t nContinuousStates)
{
    return STATUS(instance_get_nominals(instance, __func__, READABLE, nominals, nContinuousStates));
}

static fmi3Status count(fmi3Instance instance, const char *function, size_t *number, size_t value)
{
    if (!instance_allows(instance, function, MODEL_EXCHANGE | ANY_MODE) ||
        !instance_has(instance, function, "the pointer to the number", number))
        return fmi3Error;
    *number = value;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *nEventIndicators)
{
    return count(instance, __func__, nEventIndicators, 0);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *nContinuousStates)
{
    return count(instance, __func__, nContinuousStates, N_STATES);
}

/* Co-simulation */

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    return STATUS(instance_change(instance, __func__, CO_SIMULATION | EVENT, STEP));
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, References valueReferences,
                                    size_t nValueReferences, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t nValues)
{
    (void)valueReferences, (void)orders, (void)values;
    return instance_allows(instance, __func__, CO_SIMULATION | STEP | TERMINATED) &&
                   instance_counts(instance, __func__, "derivatives of outputs", nValueReferences | nValues,
                                   0)
               ? fmi3OK
               : fmi3Error;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
                      fmi3Float64 communicationStepSize, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
                      fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
                      fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    const Instance *m = instance;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!instance_has(m, __func__, "eventHandlingNeeded", eventHandlingNeeded) ||
        !instance_has(m, __func__, "terminateSimulation", terminateSimulation) ||
        !instance_has(m, __func__, "earlyReturn", earlyReturn) ||
        !instance_has(m, __func__, "lastSuccessfulTime", lastSuccessfulTime))
        return fmi3Error;
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    const Status status = instance_step(instance, __func__, currentCommunicationPoint, communicationStepSize);
    if (m)
        *lastSuccessfulTime = m->now.values[0];
    return STATUS(status);
}
