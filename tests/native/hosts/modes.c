/* modes LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS
 *
 * Every function in every mode, of both kinds of instances: OK where the standard allows the call, else ERROR
 * with one message that names the function. */
#include "host.h"

#define ANY "ncietsrx" /* modes are those of fmu_reach */

typedef struct {
    const char *name, *exchange, *co_simulation; /* modes in which it is allowed */
    int (*call)(void *c);
} Call;

static Library library;

/* Arguments that are right unless the entry says otherwise; filled for each mode. */
static uint32_t in, out;
static double number, zero, one = 1.0;
static void *state, *nothing;
static fmi3Byte bytes[1 << 17];
static size_t size;

#define CALLS2(X)                                                                                            \
    X(SetDebugLogging, ANY, ANY, (c, 1, 0, NULL))                                                            \
    X(SetupExperiment, "n", "n", (c, 0, 0.0, 0.0, 0, 0.0))                                                   \
    X(EnterInitializationMode, "n", "n", (c))                                                                \
    X(ExitInitializationMode, "i", "i", (c))                                                                 \
    X(Terminate, "et", "s", (c))                                                                             \
    X(Reset, ANY, ANY, (c))                                                                                  \
    X(GetReal, "ietx", "isx", (c, &out, 1, &number))                                                         \
    X(GetInteger, "ietx", "isx", (c, NULL, 0, NULL))                                                         \
    X(GetBoolean, "ietx", "isx", (c, NULL, 0, NULL))                                                         \
    X(GetString, "ietx", "isx", (c, NULL, 0, NULL))                                                          \
    X(SetReal, "niet", "nis", (c, &in, 1, &zero))                                                            \
    X(SetInteger, "niet", "nis", (c, NULL, 0, NULL))                                                         \
    X(SetBoolean, "niet", "nis", (c, NULL, 0, NULL))                                                         \
    X(SetString, "niet", "nis", (c, NULL, 0, NULL))                                                          \
    X(GetFMUstate, ANY, ANY, (c, &state))                                                                    \
    X(SetFMUstate, ANY, ANY, (c, state))                                                                     \
    X(FreeFMUstate, ANY, ANY, (c, &nothing))                                                                 \
    X(SerializedFMUstateSize, ANY, ANY, (c, state, &size))                                                   \
    X(SerializeFMUstate, ANY, ANY, (c, state, (char *)bytes, size))                                          \
    X(DeSerializeFMUstate, ANY, ANY, (c, (char *)bytes, size, &state))                                       \
    X(GetDirectionalDerivative, "ietx", "isx", (c, &out, 1, &in, 1, &one, &number))                          \
    X(EnterEventMode, "et", "", (c))                                                                         \
    X(NewDiscreteStates, "e", "", (c, &(fmi2EventInfo){0}))                                                  \
    X(EnterContinuousTimeMode, "e", "", (c))                                                                 \
    X(CompletedIntegratorStep, "t", "", (c, 1, &(fmi2Boolean){0}, &(fmi2Boolean){0}))                        \
    X(SetTime, "et", "", (c, 0.0))                                                                           \
    X(SetContinuousStates, "et", "", (c, NULL, 0))                                                           \
    X(GetDerivatives, "ietx", "", (c, NULL, 0))                                                              \
    X(GetEventIndicators, "ietx", "", (c, NULL, 0))                                                          \
    X(GetContinuousStates, "ietx", "", (c, NULL, 0))                                                         \
    X(GetNominalsOfContinuousStates, "nietx", "", (c, NULL, 0))                                              \
    X(SetRealInputDerivatives, "", "nis", (c, &in, 1, &(fmi2Integer){1}, &one))                              \
    X(GetRealOutputDerivatives, "", "sx", (c, NULL, 0, NULL, NULL))                                          \
    X(DoStep, "", "s", (c, 0.0, 1.0, 1))                                                                     \
    X(CancelStep, "", "", (c))                                                                               \
    X(GetStatus, "", "sx", (c, fmi2DoStepStatus, &(fmi2Status){0}))                                          \
    X(GetRealStatus, "", "sx", (c, fmi2LastSuccessfulTime, &number))                                         \
    X(GetBooleanStatus, "", "sx", (c, fmi2Terminated, &(fmi2Boolean){0}))                                    \
    X(GetStringStatus, "", "sx", (c, fmi2PendingStatus, &(fmi2String){0}))
#define X(name, exchange, co_simulation, arguments)                                                          \
    static int call2_##name(void *c)                                                                         \
    {                                                                                                        \
        return (int)library.two.name arguments;                                                              \
    }
CALLS2(X)
#undef X
#define X(name, exchange, co_simulation, arguments) {"fmi2" #name, exchange, co_simulation, call2_##name},
static const Call calls2[] = {CALLS2(X){NULL, NULL, NULL, NULL}};
#undef X

#define NO_VALUES(X, name) X(name, "ietx", "isx", (c, NULL, 0, NULL, 0))
#define NO_SETTING(X, name) X(name, "ncietr", "ncisr", (c, NULL, 0, NULL, 0))
#define CALLS3(X)                                                                                            \
    X(SetDebugLogging, ANY, ANY, (c, true, 0, NULL))                                                         \
    X(EnterInitializationMode, "n", "n", (c, false, 0.0, 0.0, false, 0.0))                                   \
    X(ExitInitializationMode, "i", "i", (c))                                                                 \
    X(EnterEventMode, "t", "", (c))                                                                          \
    X(Terminate, "etr", "sr", (c))                                                                           \
    X(Reset, ANY, ANY, (c))                                                                                  \
    X(GetFloat64, "ietx", "isx", (c, &out, 1, &number, 1))                                                   \
    X(SetFloat64, "ncietr", "ncisr", (c, &in, 1, &zero, 1))                                                  \
    NO_VALUES(X, GetFloat32) NO_VALUES(X, GetInt8) NO_VALUES(X, GetUInt8) NO_VALUES(X, GetInt16)             \
    NO_VALUES(X, GetUInt16) NO_VALUES(X, GetInt32) NO_VALUES(X, GetUInt32) NO_VALUES(X, GetInt64)            \
    NO_VALUES(X, GetUInt64) NO_VALUES(X, GetBoolean) NO_VALUES(X, GetString)                                 \
    NO_SETTING(X, SetFloat32) NO_SETTING(X, SetInt8) NO_SETTING(X, SetUInt8) NO_SETTING(X, SetInt16)         \
    NO_SETTING(X, SetUInt16) NO_SETTING(X, SetInt32) NO_SETTING(X, SetUInt32) NO_SETTING(X, SetInt64)        \
    NO_SETTING(X, SetUInt64) NO_SETTING(X, SetBoolean) NO_SETTING(X, SetString)                              \
    X(GetBinary, "ietx", "isx", (c, NULL, 0, NULL, NULL, 0))                                                 \
    X(SetBinary, "ncietr", "ncisr", (c, NULL, 0, NULL, NULL, 0))                                             \
    X(GetClock, ANY, ANY, (c, NULL, 0, NULL))                                                                \
    X(SetClock, ANY, ANY, (c, NULL, 0, NULL))                                                                \
    X(GetNumberOfVariableDependencies, ANY, ANY, (c, in, &(size_t){0}))                                      \
    X(GetVariableDependencies, ANY, ANY, (c, in, NULL, NULL, NULL, NULL, 0))                                 \
    X(GetFMUState, ANY, ANY, (c, &state))                                                                    \
    X(SetFMUState, ANY, ANY, (c, state))                                                                     \
    X(FreeFMUState, ANY, ANY, (c, &nothing))                                                                 \
    X(SerializedFMUStateSize, ANY, ANY, (c, state, &size))                                                   \
    X(SerializeFMUState, ANY, ANY, (c, state, bytes, size))                                                  \
    X(DeserializeFMUState, ANY, ANY, (c, bytes, size, &state))                                               \
    X(GetDirectionalDerivative, "ietx", "isx", (c, &out, 1, &in, 1, &one, 1, &number, 1))                    \
    X(GetAdjointDerivative, "ietx", "isx", (c, &out, 1, &in, 1, &one, 1, &number, 1))                        \
    X(EnterConfigurationMode, "ne", "ns", (c))                                                               \
    X(ExitConfigurationMode, "cr", "cr", (c))                                                                \
    X(GetIntervalDecimal, ANY, ANY, (c, NULL, 0, NULL, NULL))                                                \
    X(GetIntervalFraction, ANY, ANY, (c, NULL, 0, NULL, NULL, NULL))                                         \
    X(GetShiftDecimal, ANY, ANY, (c, NULL, 0, NULL))                                                         \
    X(GetShiftFraction, ANY, ANY, (c, NULL, 0, NULL, NULL))                                                  \
    X(SetIntervalDecimal, ANY, ANY, (c, NULL, 0, NULL))                                                      \
    X(SetIntervalFraction, ANY, ANY, (c, NULL, 0, NULL, NULL))                                               \
    X(SetShiftDecimal, ANY, ANY, (c, NULL, 0, NULL))                                                         \
    X(SetShiftFraction, ANY, ANY, (c, NULL, 0, NULL, NULL))                                                  \
    X(EvaluateDiscreteStates, "ie", "i", (c))                                                                \
    X(UpdateDiscreteStates, "e", "",                                                                         \
      (c, &(bool){0}, &(bool){0}, &(bool){0}, &(bool){0}, &(bool){0}, &number))                              \
    X(EnterContinuousTimeMode, "e", "", (c))                                                                 \
    X(CompletedIntegratorStep, "t", "", (c, true, &(bool){0}, &(bool){0}))                                   \
    X(SetTime, "et", "", (c, 0.0))                                                                           \
    X(SetContinuousStates, "et", "", (c, NULL, 0))                                                           \
    X(GetContinuousStateDerivatives, "ietx", "", (c, NULL, 0))                                               \
    X(GetEventIndicators, "ietx", "", (c, NULL, 0))                                                          \
    X(GetContinuousStates, "ietx", "", (c, NULL, 0))                                                         \
    X(GetNominalsOfContinuousStates, "ietx", "", (c, NULL, 0))                                               \
    X(GetNumberOfEventIndicators, ANY, "", (c, &(size_t){0}))                                                \
    X(GetNumberOfContinuousStates, ANY, "", (c, &(size_t){0}))                                               \
    X(EnterStepMode, "", "", (c))                                                                            \
    X(GetOutputDerivatives, "", "sx", (c, NULL, 0, NULL, NULL, 0))                                           \
    X(DoStep, "", "s", (c, 0.0, 1.0, true, &(bool){0}, &(bool){0}, &(bool){0}, &number))                     \
    X(ActivateModelPartition, "", "", (c, 0, 0.0))
#define X(name, exchange, co_simulation, arguments)                                                          \
    static int call3_##name(void *c)                                                                         \
    {                                                                                                        \
        return (int)library.three.name arguments;                                                            \
    }
CALLS3(X)
#undef X
#define X(name, exchange, co_simulation, arguments) {"fmi3" #name, exchange, co_simulation, call3_##name},
static const Call calls3[] = {CALLS3(X){NULL, NULL, NULL, NULL}};
#undef X

static void check_calls(const Call calls[], Fmu *fmu, char mode, void *before)
{
    for (const Call *call = calls; call->name; call++) {
        const bool allowed = strchr(fmu->exchange ? call->exchange : call->co_simulation, mode) != NULL;
        memset(&fmu->log, 0, sizeof fmu->log);
        const int status = call->call(fmu->instance);
        const bool named = strncmp(fmu->log.last, call->name, strlen(call->name)) == 0;
        if (allowed ? status != OK || fmu->log.errors != 0
                    : status != ERROR || fmu->log.errors != 1 || !named) {
            fprintf(stderr, "%s in mode %c of %s: status %d, %u errors\n", call->name, mode,
                    fmu->exchange ? "model exchange" : "co-simulation", status, fmu->log.errors);
            fail(__FILE__, __LINE__, allowed ? "expected OK" : "expected one error", fmu->log.last);
        }
        MUST(CALL(SetFMUstate(fmu->instance, before), SetFMUState(fmu->instance, before)), fmu);
    }
}

static void check_mode(const char *token, bool exchange, char mode)
{
    Fmu fmu;
    void *before = NULL;
    CHECK(fmu_instantiate(&fmu, &library, token, exchange, true), &fmu.log);
    fmu_reach(&fmu, mode);
    void *c = fmu.instance;
    MUST(CALL(GetFMUstate(c, &before), GetFMUState(c, &before)), &fmu);
    MUST(CALL(GetFMUstate(c, &state), GetFMUState(c, &state)), &fmu);
    MUST(CALL(SerializedFMUstateSize(c, state, &size), SerializedFMUStateSize(c, state, &size)), &fmu);
    CHECK(size <= sizeof bytes, &fmu.log);
    MUST(CALL(SerializeFMUstate(c, state, (char *)bytes, size), SerializeFMUState(c, state, bytes, size)),
         &fmu);
    check_calls(library.version == 2 ? calls2 : calls3, &fmu, mode, before);
    MUST(CALL(FreeFMUstate(c, &before), FreeFMUState(c, &before)), &fmu);
    MUST(CALL(FreeFMUstate(c, &state), FreeFMUState(c, &state)), &fmu);
    fmu_free(&fmu);
}

int main(int argc, char **argv)
{
    if (argc != 7) {
        fprintf(stderr, "modes LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    const Layout v = layout(argv[4], argv[5], argv[6]);
    in = *input_refs(&v);
    out = *output_refs(&v);
    for (const char *mode = library.version == 2 ? "nietx" : "ncietrx"; *mode; mode++)
        check_mode(argv[3], true, *mode);
    for (const char *mode = library.version == 2 ? "nisx" : "ncisrx"; *mode; mode++)
        check_mode(argv[3], false, *mode);
    for (const Call *call = library.version == 2 ? calls2 : calls3; call->name; call++)
        if (call->call(NULL) != ERROR)
            fail(__FILE__, __LINE__, "expected an error without an instance", call->name);
    printf("every call is answered in every mode\n");
    return 0;
}
