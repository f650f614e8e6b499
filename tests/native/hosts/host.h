/* A small host of FMUs for the tests: it loads a library, resolves every function of FMI 2 or FMI 3, and
 * counts what the FMU logs. With -DLINKED the FMU is part of the program, as sanitizers like it. */
#ifndef HOST_H
#define HOST_H

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef LINKED
#include "fmi2Functions.h"
#include "fmi3Functions.h"
#else
#include "fmi2TypesPlatform.h"

#include "fmi2FunctionTypes.h"
#include "fmi3FunctionTypes.h"
#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#define NOGDI /* it would define ERROR */
#include <windows.h>
#else
#include <dlfcn.h>
#endif
#endif

#define FMI2_FUNCTIONS(X)                                                                                    \
    X(GetTypesPlatform) X(GetVersion) X(SetDebugLogging) X(Instantiate) X(FreeInstance) X(SetupExperiment)   \
    X(EnterInitializationMode) X(ExitInitializationMode) X(Terminate) X(Reset) X(GetReal) X(GetInteger)      \
    X(GetBoolean) X(GetString) X(SetReal) X(SetInteger) X(SetBoolean) X(SetString) X(GetFMUstate)            \
    X(SetFMUstate) X(FreeFMUstate) X(SerializedFMUstateSize) X(SerializeFMUstate) X(DeSerializeFMUstate)     \
    X(GetDirectionalDerivative) X(EnterEventMode) X(NewDiscreteStates) X(EnterContinuousTimeMode)            \
    X(CompletedIntegratorStep) X(SetTime) X(SetContinuousStates) X(GetDerivatives) X(GetEventIndicators)     \
    X(GetContinuousStates) X(GetNominalsOfContinuousStates) X(SetRealInputDerivatives)                       \
    X(GetRealOutputDerivatives) X(DoStep) X(CancelStep) X(GetStatus) X(GetRealStatus) X(GetIntegerStatus)    \
    X(GetBooleanStatus) X(GetStringStatus)

#define FMI3_FUNCTIONS(X)                                                                                    \
    X(GetVersion) X(SetDebugLogging) X(InstantiateModelExchange) X(InstantiateCoSimulation)                  \
    X(InstantiateScheduledExecution) X(FreeInstance) X(EnterInitializationMode) X(ExitInitializationMode)    \
    X(EnterEventMode) X(Terminate) X(Reset) X(GetFloat32) X(GetFloat64) X(GetInt8) X(GetUInt8) X(GetInt16)   \
    X(GetUInt16) X(GetInt32) X(GetUInt32) X(GetInt64) X(GetUInt64) X(GetBoolean) X(GetString) X(GetBinary)   \
    X(GetClock) X(SetFloat32) X(SetFloat64) X(SetInt8) X(SetUInt8) X(SetInt16) X(SetUInt16) X(SetInt32)      \
    X(SetUInt32) X(SetInt64) X(SetUInt64) X(SetBoolean) X(SetString) X(SetBinary) X(SetClock)                \
    X(GetNumberOfVariableDependencies) X(GetVariableDependencies) X(GetFMUState) X(SetFMUState)              \
    X(FreeFMUState) X(SerializedFMUStateSize) X(SerializeFMUState) X(DeserializeFMUState)                    \
    X(GetDirectionalDerivative) X(GetAdjointDerivative) X(EnterConfigurationMode) X(ExitConfigurationMode)   \
    X(GetIntervalDecimal) X(GetIntervalFraction) X(GetShiftDecimal) X(GetShiftFraction)                      \
    X(SetIntervalDecimal) X(SetIntervalFraction) X(SetShiftDecimal) X(SetShiftFraction)                      \
    X(EvaluateDiscreteStates) X(UpdateDiscreteStates) X(EnterContinuousTimeMode) X(CompletedIntegratorStep)  \
    X(SetTime) X(SetContinuousStates) X(GetContinuousStateDerivatives) X(GetEventIndicators)                 \
    X(GetContinuousStates) X(GetNominalsOfContinuousStates) X(GetNumberOfEventIndicators)                    \
    X(GetNumberOfContinuousStates) X(EnterStepMode) X(GetOutputDerivatives) X(DoStep)                        \
    X(ActivateModelPartition)

typedef struct {
    int version; /* 2 or 3: which of the two is loaded */
    struct {
#define X(name) fmi2##name##TYPE *name;
        FMI2_FUNCTIONS(X)
#undef X
    } two;
    struct {
#define X(name) fmi3##name##TYPE *name;
        FMI3_FUNCTIONS(X)
#undef X
    } three;
} Library;

/* Statuses, the same in both versions. */
enum { OK, WARNING, DISCARD, ERROR };

/* What an instance logged. */
typedef struct {
    unsigned errors, warnings, events;
    char last[1024];
} Log;

typedef struct {
    const Library *library;
    void *instance;
    bool exchange; /* model exchange */
    double time;
    Log log;
} Fmu;

static inline void fail(const char *file, int line, const char *what, const char *logged)
{
    fprintf(stderr, "%s:%d: failed: %s\n", file, line, what);
    if (logged)
        fprintf(stderr, "last message: %s\n", logged);
    exit(1);
}
#define CHECK(condition, log) ((condition) ? (void)0 : fail(__FILE__, __LINE__, #condition, (log)->last))
/* The same call in both versions, of `library`. */
#define CALL(fmi2, fmi3) (library.version == 2 ? (int)library.two.fmi2 : (int)library.three.fmi3)
#define MUST(call, fmu) CHECK((int)(call) == OK, &(fmu)->log)

/* Loading */

#ifndef LINKED
static inline void *symbol(void *library, const char *name)
{
#ifdef _WIN32
    FARPROC found = GetProcAddress((HMODULE)library, name);
    void *address = NULL;
    memcpy(&address, &found, sizeof address);
#else
    void *address = dlsym(library, name);
#endif
    if (!address)
        fail(__FILE__, __LINE__, name, "is not exported");
    return address;
}
#endif

static inline Library load(const char *path, const char *version)
{
    Library f;
    memset(&f, 0, sizeof f);
    f.version = atoi(version);
#ifdef LINKED
    (void)path;
#define X(name) f.two.name = fmi2##name;
    FMI2_FUNCTIONS(X)
#undef X
#define X(name) f.three.name = fmi3##name;
    FMI3_FUNCTIONS(X)
#undef X
#else
#ifdef _WIN32
    void *library = LoadLibraryA(path);
    const char *reason = "LoadLibrary failed";
#else
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const char *reason = library ? "" : dlerror();
#endif
    if (!library)
        fail(__FILE__, __LINE__, path, reason);
    void *address;
#define X(name) address = symbol(library, "fmi2" #name), memcpy(&f.two.name, &address, sizeof address);
    if (f.version == 2) {
        FMI2_FUNCTIONS(X)
    }
#undef X
#define X(name) address = symbol(library, "fmi3" #name), memcpy(&f.three.name, &address, sizeof address);
    if (f.version == 3) {
        FMI3_FUNCTIONS(X)
    }
#undef X
#endif
    return f;
}

/* Logging: the environment of an instance is its Log. */

static inline void note(Log *log, int status, const char *category, const char *line)
{
    snprintf(log->last, sizeof log->last, "%s", line);
    CHECK(line[0] != '\0', log);
    for (const char *c = line; *c; c++)
        CHECK((unsigned char)*c >= ' ', log); /* one line, no control characters */
    if (status == ERROR || status == DISCARD) {
        CHECK(strcmp(category, "logStatusError") == 0, log);
        log->errors++;
    } else if (status == WARNING) {
        CHECK(strcmp(category, "logStatusWarning") == 0, log);
        log->warnings++;
    } else {
        CHECK(status == OK && strcmp(category, "logEvents") == 0, log);
        log->events++;
    }
}

static inline void logger2(void *environment, const char *name, fmi2Status status, const char *category,
                           const char *message, ...)
{
    char line[1024];
    va_list rest;
    va_start(rest, message);
    vsnprintf(line, sizeof line, message, rest); /* as FMI 2 wants it */
    va_end(rest);
    CHECK(name != NULL, (Log *)environment);
    note(environment, (int)status, category, line);
}

static inline void logger3(void *environment, fmi3Status status, const char *category, const char *message)
{
    note(environment, (int)status, category, message);
}

/* Both versions in one */

static inline bool fmu_instantiate(Fmu *fmu, const Library *f, const char *token, bool exchange, bool logging)
{
    memset(fmu, 0, sizeof *fmu);
    fmu->library = f;
    fmu->exchange = exchange;
    const fmi2CallbackFunctions callbacks = {logger2, NULL, NULL, NULL, &fmu->log};
    if (f->version == 2)
        fmu->instance = f->two.Instantiate("test", exchange ? fmi2ModelExchange : fmi2CoSimulation, token, "",
                                           &callbacks, fmi2False, logging);
    else if (exchange)
        fmu->instance =
            f->three.InstantiateModelExchange("test", token, "", false, logging, &fmu->log, logger3);
    else
        fmu->instance = f->three.InstantiateCoSimulation("test", token, "", false, logging, false, false,
                                                         NULL, 0, &fmu->log, logger3, NULL);
    return fmu->instance != NULL;
}

static inline int fmu_enter(Fmu *fmu)
{
    const Library *f = fmu->library;
    if (f->version == 3)
        return (int)f->three.EnterInitializationMode(fmu->instance, false, 0.0, 0.0, false, 0.0);
    const int status = (int)f->two.SetupExperiment(fmu->instance, fmi2False, 0.0, 0.0, fmi2False, 0.0);
    return status == OK ? (int)f->two.EnterInitializationMode(fmu->instance) : status;
}

static inline int fmu_exit(Fmu *fmu)
{
    const Library *f = fmu->library;
    return f->version == 2 ? (int)f->two.ExitInitializationMode(fmu->instance)
                           : (int)f->three.ExitInitializationMode(fmu->instance);
}

static inline int fmu_set(Fmu *fmu, const uint32_t refs[], size_t n, const double values[])
{
    const Library *f = fmu->library;
    return f->version == 2 ? (int)f->two.SetReal(fmu->instance, refs, n, values)
                           : (int)f->three.SetFloat64(fmu->instance, refs, n, values, n);
}

static inline int fmu_get(Fmu *fmu, const uint32_t refs[], size_t n, double values[])
{
    const Library *f = fmu->library;
    return f->version == 2 ? (int)f->two.GetReal(fmu->instance, refs, n, values)
                           : (int)f->three.GetFloat64(fmu->instance, refs, n, values, n);
}

static inline int fmu_step(Fmu *fmu, double size)
{
    const Library *f = fmu->library;
    bool event, terminate, early;
    double last;
    const int status =
        f->version == 2
            ? (int)f->two.DoStep(fmu->instance, fmu->time, size, fmi2True)
            : (int)f->three.DoStep(fmu->instance, fmu->time, size, true, &event, &terminate, &early, &last);
    if (status == OK)
        fmu->time += size;
    return status;
}

static inline int fmu_reset(Fmu *fmu)
{
    const Library *f = fmu->library;
    fmu->time = 0.0;
    return f->version == 2 ? (int)f->two.Reset(fmu->instance) : (int)f->three.Reset(fmu->instance);
}

static inline void fmu_free(Fmu *fmu)
{
    if (fmu->library->version == 2)
        fmu->library->two.FreeInstance(fmu->instance);
    else
        fmu->library->three.FreeInstance(fmu->instance);
    fmu->instance = NULL;
}

/* Bring an instance into a mode:
 * n instantiated, c configuration, i initialization, e event, t continuous time, s step, r reconfiguration,
 * x terminated. */
static inline void fmu_reach(Fmu *fmu, char mode)
{
    const Library *f = fmu->library;
    void *c = fmu->instance;
    if (mode == 'c')
        MUST(f->three.EnterConfigurationMode(c), fmu);
    if (mode == 'n' || mode == 'c')
        return;
    MUST(fmu_enter(fmu), fmu);
    if (mode == 'i')
        return;
    MUST(fmu_exit(fmu), fmu);
    if (mode == 't' && f->version == 2)
        MUST(f->two.EnterContinuousTimeMode(c), fmu);
    else if (mode == 't')
        MUST(f->three.EnterContinuousTimeMode(c), fmu);
    else if (mode == 'x' && f->version == 2)
        MUST(f->two.Terminate(c), fmu);
    else if (mode == 'x')
        MUST(f->three.Terminate(c), fmu);
    else if (mode == 'r')
        MUST(f->three.EnterConfigurationMode(c), fmu);
}

/* Value references: inputs from 1, then outputs, then parameters. */

enum { MAX_VARIABLES = 128 };

typedef struct {
    size_t inputs, outputs, parameters;
    uint32_t refs[MAX_VARIABLES]; /* refs[i] is i */
} Layout;

static inline Layout layout(const char *inputs, const char *outputs, const char *parameters)
{
    Layout v = {strtoul(inputs, NULL, 10), strtoul(outputs, NULL, 10), strtoul(parameters, NULL, 10), {0}};
    if (v.inputs + v.outputs + v.parameters >= MAX_VARIABLES)
        fail(__FILE__, __LINE__, "too many variables", NULL);
    for (uint32_t i = 0; i < MAX_VARIABLES; i++)
        v.refs[i] = i;
    return v;
}

static inline const uint32_t *input_refs(const Layout *v)
{
    return v->refs + 1;
}

static inline const uint32_t *output_refs(const Layout *v)
{
    return v->refs + 1 + v->inputs;
}

static inline const uint32_t *parameter_refs(const Layout *v)
{
    return v->refs + 1 + v->inputs + v->outputs;
}

#endif
