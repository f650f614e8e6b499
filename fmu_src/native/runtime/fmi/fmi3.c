/* Entry points of FMI 3.0: each is a thin layer over instance.h. */
#include <string.h>

#include "fmi3Functions.h"

#define FMI(Name) fmi3##Name
typedef fmi3Instance Component;
typedef fmi3Float64 Real;
#include "alike.h"

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
    if (eventModeUsed)
        return instance_not_made(__func__, instanceName, reporter,
                                 "event mode is wanted in co-simulation; expected eventModeUsed = false, as the "
                                 "model description says");
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
    return instance_not_made(__func__, instanceName, reporter,
                             "this FMU has no scheduled execution; expected model exchange or co-simulation");
}

ENTRY(fmi3EnterInitializationMode,
      (fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 startTime,
       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime),
      instance_set_experiment(c, __func__, toleranceDefined ? tolerance : 0.0, startTime, stopTimeDefined,
                              stopTime) == OK
          ? instance_change(c, __func__, BOTH | INSTANTIATED, INITIALIZATION)
          : ERROR)
ENTRY(fmi3Terminate, (fmi3Instance c),
      instance_change(c, __func__, BOTH | EVENT | CONTINUOUS_TIME | STEP | RECONFIGURATION, TERMINATED))

/* There is no structural parameter: these modes only take other values of the tunable ones. */

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    const Instance *m = c;
    const bool first = m && m->now.mode == INSTANTIATED;
    return STATUS(instance_change(c, __func__, BOTH | INSTANTIATED | EVENT | STEP,
                                  first ? CONFIGURATION : RECONFIGURATION));
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    const Instance *m = c;
    const bool first = m && m->now.mode == CONFIGURATION;
    const unsigned before = m && m->now.kind == MODEL_EXCHANGE ? EVENT : STEP;
    return STATUS(instance_change(c, __func__, BOTH | CONFIGURATION | RECONFIGURATION,
                                  first ? (unsigned)INSTANTIATED : before));
}

/* Variables: all are Float64 but for a few Boolean parameters */

#define VARIABLES(name, Value, function)                                                       \
    ENTRY(name, (fmi3Instance c, References refs, size_t nRefs, Value values[], size_t n),     \
          instance_counts(c, __func__, "values", n, nRefs) ? function(c, __func__, refs, n, values) : ERROR)
VARIABLES(fmi3GetFloat64, fmi3Float64, instance_get)
VARIABLES(fmi3SetFloat64, const fmi3Float64, instance_set)
VARIABLES(fmi3GetBoolean, fmi3Boolean, instance_get_booleans)
VARIABLES(fmi3SetBoolean, const fmi3Boolean, instance_set_booleans)

#define NO_VALUES(name, mode, parameters, unused)              \
    ENTRY(name, parameters, ((void)refs, (void)values, unused, \
                             instance_none(c, __func__, BOTH | mode, NO_SUCH_TYPE, nRefs | n)))
#define NO_VARIABLES(Type)                                                                                      \
    NO_VALUES(fmi3Get##Type, READABLE, (fmi3Instance c, References refs, size_t nRefs, fmi3##Type values[], size_t n), \
              (void)0)                                                                                          \
    NO_VALUES(fmi3Set##Type, SETTABLE,                                                                          \
              (fmi3Instance c, References refs, size_t nRefs, const fmi3##Type values[], size_t n), (void)0)
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
NO_VALUES(fmi3GetBinary, READABLE,
          (fmi3Instance c, References refs, size_t nRefs, size_t sizes[], fmi3Binary values[], size_t n), (void)sizes)
NO_VALUES(fmi3SetBinary, SETTABLE,
          (fmi3Instance c, References refs, size_t nRefs, const size_t sizes[], const fmi3Binary values[], size_t n),
          (void)sizes)

/* Clocks: none */

#define NO_CLOCKS(name, unused, ...)                                                      \
    fmi3Status name(fmi3Instance c, References refs, size_t nRefs, __VA_ARGS__)           \
    {                                                                                     \
        (void)refs, unused;                                                               \
        return STATUS(instance_none(c, __func__, BOTH | ANY_MODE, NO_SUCH_TYPE, nRefs));  \
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

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clockReference,
                                      fmi3Float64 activationTime)
{
    (void)clockReference, (void)activationTime;
    if (instance_allows(c, __func__, BOTH | ANY_MODE))
        instance_refuse(c, __func__, "this FMU has no model partitions; expected no such call");
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
    return ref < N_VALUES ||
           instance_refuse(m, function, "the value reference is unknown; expected one of the model description") == OK;
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference valueReference,
                                               size_t *nDependencies)
{
    if (!has_dependencies(c, __func__, valueReference) || !HAS(nDependencies))
        return fmi3Error;
    *nDependencies = n_dependencies(valueReference);
    return fmi3OK;
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent,
                                       size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
                                       size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies)
{
    if (!has_dependencies(c, __func__, dependent) ||
        !instance_counts(c, __func__, "dependencies", nDependencies, n_dependencies(dependent)))
        return fmi3Error;
    if (nDependencies == 0)
        return fmi3OK;
    if (!HAS(elementIndicesOfDependent) || !HAS(independents) || !HAS(elementIndicesOfIndependents) ||
        !HAS(dependencyKinds))
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

ENTRY(fmi3GetFMUState, (fmi3Instance c, fmi3FMUState *state), state_save(c, __func__, state))
ENTRY(fmi3SetFMUState, (fmi3Instance c, fmi3FMUState state), state_restore(c, __func__, state))
ENTRY(fmi3FreeFMUState, (fmi3Instance c, fmi3FMUState *state), state_free(c, __func__, state))
ENTRY(fmi3SerializedFMUStateSize, (fmi3Instance c, fmi3FMUState state, size_t *size),
      state_size(c, __func__, state, size))
ENTRY(fmi3SerializeFMUState, (fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size),
      state_write(c, __func__, state, bytes, size))
ENTRY(fmi3DeserializeFMUState, (fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state),
      state_read(c, __func__, bytes, size, state))

/* Derivatives */

#define DERIVATIVE(name, function, nSeeds, nResults)                                                            \
    ENTRY(name,                                                                                                 \
          (fmi3Instance c, References unknowns, size_t nUnknowns, References knowns, size_t nKnowns,            \
           const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity),             \
          instance_counts(c, __func__, "elements of the seed", nSeed, nSeeds) &&                                \
                  instance_counts(c, __func__, "elements of the sensitivity", nSensitivity, nResults)           \
              ? function(c, __func__, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity)                  \
              : ERROR)
DERIVATIVE(fmi3GetDirectionalDerivative, instance_derivative, nKnowns, nUnknowns)
DERIVATIVE(fmi3GetAdjointDerivative, instance_adjoint, nUnknowns, nKnowns)

/* Events: those of the host, who may change parameters in them, and corners of a course over time */

ENTRY(fmi3EnterEventMode, (fmi3Instance c),
      instance_change(c, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME, EVENT))
ENTRY(fmi3EvaluateDiscreteStates, (fmi3Instance c),
      instance_allows(c, __func__, BOTH | INITIALIZATION | EVENT) ? OK : ERROR)

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate,
                                    fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged,
                                    fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)
{
    if (!instance_allows(c, __func__, BOTH | EVENT) || !HAS(discreteStatesNeedUpdate) ||
        !HAS(terminateSimulation) || !HAS(nominalsOfContinuousStatesChanged) ||
        !HAS(valuesOfContinuousStatesChanged) || !HAS(nextEventTimeDefined) || !HAS(nextEventTime))
        return fmi3Error;
    *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = fmi3False;
    return STATUS(instance_update_event(c, nextEventTimeDefined, nextEventTime));
}

/* Model exchange, beside what both standards have alike */

ENTRY(fmi3GetContinuousStateDerivatives, (fmi3Instance c, fmi3Float64 derivatives[], size_t nx),
      instance_get_rates(c, __func__, derivatives, nx))
ENTRY(fmi3GetNominalsOfContinuousStates, (fmi3Instance c, fmi3Float64 nominal[], size_t nx),
      instance_get_nominals(c, __func__, READABLE, nominal, nx))

static Status count(const Instance *m, const char *function, size_t *number, size_t value)
{
    if (!instance_allows(m, function, MODEL_EXCHANGE | ANY_MODE) ||
        !instance_has(m, function, "the pointer to the number", number))
        return ERROR;
    *number = value;
    return OK;
}

ENTRY(fmi3GetNumberOfEventIndicators, (fmi3Instance c, size_t *number), count(c, __func__, number, 0))
ENTRY(fmi3GetNumberOfContinuousStates, (fmi3Instance c, size_t *number), count(c, __func__, number, N_STATES))

/* Co-simulation */

ENTRY(fmi3EnterStepMode, (fmi3Instance c), instance_change(c, __func__, CO_SIMULATION | EVENT, STEP))
ENTRY(fmi3GetOutputDerivatives,
      (fmi3Instance c, References refs, size_t nRefs, const fmi3Int32 orders[], fmi3Float64 values[], size_t n),
      ((void)refs, (void)orders, (void)values,
       instance_none(c, __func__, CO_SIMULATION | STEP | TERMINATED, "derivatives of outputs", nRefs | n)))

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    const Instance *m = c;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!HAS(eventHandlingNeeded) || !HAS(terminateSimulation) || !HAS(earlyReturn) || !HAS(lastSuccessfulTime))
        return fmi3Error;
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    const Status status = instance_step(c, __func__, currentCommunicationPoint, communicationStepSize);
    if (m)
        *lastSuccessfulTime = m->now.values[0];
    return STATUS(status);
}

/* Beyond FMI: many load steps in one call, for programs that load the library without an FMU. */

/* Evaluate a path of `n` points and return how many of them were evaluated; fewer than `n` if one was refused,
 * with a message. The path starts at the accepted inputs, or in the virgin state if `from_rest`; with
 * `each_from_rest` every point is reached on a path of its own from the virgin state.
 *
 * inputs       : value references (n_inputs); their values (n, n_inputs), one row a point
 * outputs      : value references (n_outputs); their values (n, n_outputs) are written */
FMI3_Export size_t jointfmu_follow_path(fmi3Instance c, fmi3Boolean from_rest, fmi3Boolean each_from_rest, size_t n,
                                        size_t n_inputs, const fmi3ValueReference inputs[],
                                        const fmi3Float64 input_values[], size_t n_outputs,
                                        const fmi3ValueReference outputs[], fmi3Float64 output_values[]);
size_t jointfmu_follow_path(fmi3Instance c, fmi3Boolean from_rest, fmi3Boolean each_from_rest, size_t n,
                            size_t n_inputs, const fmi3ValueReference inputs[], const fmi3Float64 input_values[],
                            size_t n_outputs, const fmi3ValueReference outputs[], fmi3Float64 output_values[])
{
    Instance *m = c;
    if (from_rest)
        m->now.warned = 0;
    for (size_t i = 0; i < n; i++) {
        if (each_from_rest || (from_rest && i == 0)) {
            memset(&m->now.path, 0, sizeof m->now.path);
            m->dirty = true;
        }
        if (instance_set(m, __func__, inputs, n_inputs, input_values + i * n_inputs) != OK ||
            instance_accept(m) != OK)
            return i;
        for (size_t k = 0; k < n_outputs; k++)
            output_values[i * n_outputs + k] = m->now.values[outputs[k]];
    }
    return n;
}
