/* refusals LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS
 *
 * Wrong arguments in the right mode: ERROR, one message that names the function and what was expected, and an
 * instance that goes on as before. */
#include "host.h"

static Library library;
static uint32_t in, out, parameter, unknown = 1000;
static double number, zero, one = 1.0, nan_;
static const char *bogus[] = {"logBogus"};
static void *state, *nothing;
static char bytes[1 << 17];
static size_t size;

typedef struct {
    char kind, mode; /* kind: m model exchange, c co-simulation; mode as in fmu_reach */
    const char *name, *expected;
    int (*call)(void *c);
} Refusal;

#define REFUSALS2(X)                                                                                         \
    X('c', 'n', SetupExperiment, "finite start", (c, 0, 0.0, nan_, 0, 0.0), 1)                               \
    X('c', 'n', SetupExperiment, "not before it", (c, 0, 0.0, 1.0, 1, 0.5), 2)                               \
    X('c', 's', EnterInitializationMode, "expected instantiated state", (c), 3)                              \
    X('c', 's', SetDebugLogging, "'logBogus' is unknown", (c, 1, 1, bogus), 4)                               \
    X('c', 's', SetDebugLogging, "NULL", (c, 1, 1, NULL), 5)                                                 \
    X('c', 's', SetReal, "NULL", (c, NULL, 1, &zero), 6)                                                     \
    X('c', 's', SetReal, "NULL", (c, &in, 1, NULL), 7)                                                       \
    X('c', 's', SetReal, "reference 1000 is unknown", (c, &unknown, 1, &zero), 8)                            \
    X('c', 's', SetReal, "expected an input or a parameter", (c, &out, 1, &zero), 9)                         \
    X('c', 's', SetBoolean, "is a number; expected a Boolean", (c, &in, 1, &(fmi2Boolean){1}), 10)           \
    X('c', 's', SetString, "expected 0", (c, &in, 1, &(fmi2String){""}), 11)                                 \
    X('c', 's', GetReal, "NULL", (c, &out, 1, NULL), 12)                                                     \
    X('c', 's', GetReal, "reference 0 is unknown", (c, &(uint32_t){0}, 1, &number), 13)                      \
    X('c', 's', GetInteger, "expected 0", (c, &out, 1, &(fmi2Integer){0}), 14)                               \
    X('c', 's', DoStep, "a step above 0", (c, 0.0, 0.0, 1), 15)                                              \
    X('c', 's', DoStep, "a step above 0", (c, 0.0, -1.0, 1), 16)                                             \
    X('c', 's', DoStep, "finite", (c, 0.0, nan_, 1), 17)                                                     \
    X('c', 's', DoStep, "finite", (c, 0.0, HUGE_VAL, 1), 18)                                                 \
    X('c', 's', DoStep, "expected it at 0 s", (c, 0.5, 1.0, 1), 19)                                          \
    X('c', 's', SetFMUstate, "NULL", (c, NULL), 20)                                                          \
    X('c', 's', GetFMUstate, "NULL", (c, NULL), 21)                                                          \
    X('c', 's', SerializedFMUstateSize, "NULL", (c, state, NULL), 22)                                        \
    X('c', 's', SerializeFMUstate, "bytes of room", (c, state, bytes, size - 1), 23)                         \
    X('c', 's', SerializeFMUstate, "NULL", (c, state, NULL, size), 24)                                       \
    X('c', 's', DeSerializeFMUstate, "bytes; expected", (c, bytes, size - 1, &nothing), 25)                  \
    X('c', 's', DeSerializeFMUstate, "no FMU state", (c, bytes + 1, size, &nothing), 26)                  \
    X('c', 's', GetDirectionalDerivative, "expected inputs", (c, &out, 1, &parameter, 1, &one, &number), 27) \
    X('c', 's', GetDirectionalDerivative, "expected outputs", (c, &in, 1, &in, 1, &one, &number), 28)        \
    X('c', 's', GetDirectionalDerivative, "not finite", (c, &out, 1, &in, 1, &nan_, &number), 29)            \
    X('c', 's', GetDirectionalDerivative, "NULL", (c, &out, 1, &in, 1, NULL, &number), 30)                   \
    X('c', 's', GetDirectionalDerivative, "NULL", (c, &out, 1, &in, 1, &one, NULL), 31)                      \
    X('c', 's', SetRealInputDerivatives, "order 1", (c, &in, 1, &(fmi2Integer){2}, &one), 32)                \
    X('c', 's', SetRealInputDerivatives, "is not an input", (c, &out, 1, &(fmi2Integer){1}, &one), 33)              \
    X('c', 's', SetRealInputDerivatives, "finite", (c, &in, 1, &(fmi2Integer){1}, &nan_), 34)                \
    X('c', 's', SetRealInputDerivatives, "NULL", (c, &in, 1, NULL, &one), 35)                                \
    X('c', 's', GetRealOutputDerivatives, "expected 0", (c, &out, 1, &(fmi2Integer){1}, &number), 36)        \
    X('c', 's', GetRealStatus, "NULL", (c, fmi2LastSuccessfulTime, NULL), 37)                                \
    X('m', 'e', DoStep, "expected co-simulation", (c, 0.0, 1.0, 1), 38)                                      \
    X('c', 's', SetTime, "expected model exchange", (c, 0.0), 39)                                            \
    X('m', 'e', NewDiscreteStates, "NULL", (c, NULL), 40)                                                    \
    X('m', 'e', GetDerivatives, "expected 0", (c, &number, 1), 41)                                           \
    X('m', 'e', GetEventIndicators, "expected 0", (c, &number, 1), 42)                                       \
    X('m', 'e', SetTime, "finite", (c, nan_), 43)                                                            \
    X('m', 't', SetReal, "expected event mode", (c, &parameter, 1, &one), 44)                                \
    X('m', 't', CompletedIntegratorStep, "NULL", (c, 1, NULL, NULL), 45)

#define REFUSALS3(X)                                                                                         \
    X('c', 'n', EnterInitializationMode, "finite start", (c, false, 0.0, nan_, false, 0.0), 1)               \
    X('c', 's', EnterInitializationMode, "expected instantiated state", (c, false, 0.0, 0.0, false, 0.0), 2) \
    X('c', 's', SetDebugLogging, "'logBogus' is unknown", (c, true, 1, bogus), 3)                            \
    X('c', 's', SetFloat64, "expected 1", (c, &in, 1, &zero, 2), 4)                                          \
    X('c', 's', SetFloat64, "NULL", (c, NULL, 1, &zero, 1), 5)                                               \
    X('c', 's', SetFloat64, "reference 1000 is unknown", (c, &unknown, 1, &zero, 1), 6)                      \
    X('c', 's', SetFloat64, "independent variable", (c, &(uint32_t){0}, 1, &zero, 1), 7)                     \
    X('c', 's', SetFloat64, "expected an input or a parameter", (c, &out, 1, &zero, 1), 8)                   \
    X('c', 's', SetBoolean, "is a number; expected a Boolean", (c, &in, 1, &(bool){true}, 1), 9)             \
    X('c', 's', SetFloat32, "expected 0", (c, &in, 1, &(float){0}, 1), 10)                                   \
    X('c', 's', GetFloat64, "expected 1", (c, &out, 1, &number, 0), 11)                                      \
    X('c', 's', GetInt32, "expected 0", (c, &out, 1, &(int32_t){0}, 1), 12)                                  \
    X('c', 's', GetClock, "expected 0", (c, &out, 1, &(bool){false}), 13)                                    \
    X('c', 's', SetShiftDecimal, "expected 0", (c, &out, 1, &zero), 14)                                      \
    X('c', 's', GetBinary, "expected 0", (c, &out, 1, &(size_t){0}, &(fmi3Binary){NULL}, 1), 15)             \
    X('c', 's', DoStep, "a step above 0", (c, 0.0, -0.0, true, &(bool){0}, &(bool){0}, &(bool){0}, &number), \
      16)                                                                                                    \
    X('c', 's', DoStep, "expected it at 0 s",                                                                \
      (c, -1.0, 1.0, true, &(bool){0}, &(bool){0}, &(bool){0}, &number), 17)                                 \
    X('c', 's', DoStep, "lastSuccessfulTime is NULL",                                                        \
      (c, 0.0, 1.0, true, &(bool){0}, &(bool){0}, &(bool){0}, NULL), 18)                                     \
    X('c', 's', GetVariableDependencies, "dependencies; expected", (c, out, NULL, NULL, NULL, NULL, 99), 19) \
    X('c', 's', GetNumberOfVariableDependencies, "unknown", (c, unknown, &(size_t){0}), 20)                  \
    X('c', 's', GetNumberOfVariableDependencies, "NULL", (c, out, NULL), 21)                                 \
    X('c', 's', SetFMUState, "NULL", (c, NULL), 22)                                                          \
    X('c', 's', SerializeFMUState, "bytes of room", (c, state, (fmi3Byte *)bytes, size + 1), 23)             \
    X('c', 's', DeserializeFMUState, "bytes; expected", (c, (fmi3Byte *)bytes, 0, &nothing), 24)             \
    X('c', 's', DeserializeFMUState, "no FMU state", (c, (fmi3Byte *)bytes + 1, size, &nothing), 25)      \
    X('c', 's', GetDirectionalDerivative, "expected inputs",                                                 \
      (c, &out, 1, &parameter, 1, &one, 1, &number, 1), 26)                                                  \
    X('c', 's', GetDirectionalDerivative, "elements of the seed", (c, &out, 1, &in, 1, &one, 2, &number, 1), \
      27)                                                                                                    \
    X('c', 's', GetAdjointDerivative, "elements of the sensitivity",                                         \
      (c, &out, 1, &in, 1, &one, 1, &number, 2), 28)                                                         \
    X('c', 's', GetAdjointDerivative, "NULL", (c, &out, 1, &in, 1, NULL, 1, &number, 1), 29)                 \
    X('c', 's', GetOutputDerivatives, "expected 0", (c, &out, 1, &(int32_t){1}, &number, 1), 30)             \
    X('c', 's', EnterEventMode, "expected model exchange", (c), 31)                                          \
    X('c', 's', EnterStepMode, "no event mode in co-simulation", (c), 32)                                    \
    X('c', 's', ActivateModelPartition, "no model partitions", (c, 1, 0.0), 33)                              \
    X('m', 'e', UpdateDiscreteStates, "NULL", (c, NULL, NULL, NULL, NULL, NULL, NULL), 34)                   \
    X('m', 'e', GetContinuousStates, "expected 0", (c, &number, 1), 35)                                      \
    X('m', 'e', GetNumberOfEventIndicators, "NULL", (c, NULL), 36)                                           \
    X('m', 't', SetTime, "finite", (c, HUGE_VAL), 37)                                                        \
    X('m', 't', SetFloat64, "expected event mode", (c, &parameter, 1, &one, 1), 38)                          \
    X('m', 't', CompletedIntegratorStep, "NULL", (c, true, &(bool){0}, NULL), 39)

#define X(kind, mode, name, expected, arguments, id)                                                         \
    static int refusal2_##id(void *c)                                                                        \
    {                                                                                                        \
        return (int)library.two.name arguments;                                                              \
    }
REFUSALS2(X)
#undef X
#define X(kind, mode, name, expected, arguments, id)                                                         \
    static int refusal3_##id(void *c)                                                                        \
    {                                                                                                        \
        return (int)library.three.name arguments;                                                            \
    }
REFUSALS3(X)
#undef X
#define X(kind, mode, name, expected, arguments, id) {kind, mode, "fmi2" #name ": ", expected, refusal2_##id},
static const Refusal refusals2[] = {REFUSALS2(X){0, 0, NULL, NULL, NULL}};
#undef X
#define X(kind, mode, name, expected, arguments, id) {kind, mode, "fmi3" #name ": ", expected, refusal3_##id},
static const Refusal refusals3[] = {REFUSALS3(X){0, 0, NULL, NULL, NULL}};
#undef X

static void make_state(Fmu *fmu)
{
    void *c = fmu->instance;
    MUST(CALL(GetFMUstate(c, &state), GetFMUState(c, &state)), fmu);
    MUST(CALL(SerializedFMUstateSize(c, state, &size), SerializedFMUStateSize(c, state, &size)), fmu);
    CHECK(size < sizeof bytes, &fmu->log);
    MUST(CALL(SerializeFMUstate(c, state, bytes, size), SerializeFMUState(c, state, (fmi3Byte *)bytes, size)),
         fmu);
}

static void must_refuse(Fmu *fmu, int status, const char *name, const char *expected)
{
    if (status < DISCARD || fmu->log.errors != 1 || strncmp(fmu->log.last, name, strlen(name)) != 0 ||
        !strstr(fmu->log.last, expected)) {
        fprintf(stderr, "%s status %d, %u errors; expected one error with: %s\n", name, status,
                fmu->log.errors, expected);
        fail(__FILE__, __LINE__, "not refused as expected", fmu->log.last);
    }
    fmu->log.errors = 0;
}

/* All refusals of one kind and mode, in one instance that ends as it began. */
static void check(const char *token, char kind, char mode)
{
    Fmu fmu;
    CHECK(fmu_instantiate(&fmu, &library, token, kind == 'm', false), &fmu.log);
    fmu_reach(&fmu, mode);
    make_state(&fmu);
    for (const Refusal *r = library.version == 2 ? refusals2 : refusals3; r->name; r++)
        if (r->kind == kind && r->mode == mode)
            must_refuse(&fmu, r->call(fmu.instance), r->name, r->expected);
    CHECK(nothing == NULL, &fmu.log);
    if (mode == 's') {
        for (size_t i = 0; i < size; i += 1 + size / 4096) { /* a wrong byte is noticed, wherever it is */
            bytes[i] ^= 0x10;
            const int status = CALL(DeSerializeFMUstate(fmu.instance, bytes, size, &nothing),
                                    DeserializeFMUState(fmu.instance, (fmi3Byte *)bytes, size, &nothing));
            must_refuse(&fmu, status, library.version == 2 ? "fmi2DeSer" : "fmi3Deser", "the bytes are");
            bytes[i] ^= 0x10;
        }
        MUST(fmu_set(&fmu, &in, 1, &nan_), &fmu); /* refused where it is used, and only there */
        must_refuse(&fmu, fmu_step(&fmu, 1.0), "", " = nan");
        must_refuse(&fmu, fmu_get(&fmu, &out, 1, &number), "", " is outside ");
        MUST(fmu_set(&fmu, &in, 1, &zero), &fmu);
        MUST(fmu_step(&fmu, 1.0), &fmu);
        MUST(fmu_get(&fmu, &out, 1, &number), &fmu);
        CHECK(isfinite(number), &fmu.log);
    }
    MUST(CALL(FreeFMUstate(fmu.instance, &state), FreeFMUState(fmu.instance, &state)), &fmu);
    fmu_free(&fmu);
}

/* A parameter that is not finite is refused when initialization ends; then the instance can be used. */
static void check_parameter(const char *token)
{
    Fmu fmu;
    double before;
    CHECK(fmu_instantiate(&fmu, &library, token, false, false), &fmu.log);
    MUST(fmu_enter(&fmu), &fmu);
    MUST(fmu_get(&fmu, &parameter, 1, &before), &fmu);
    MUST(fmu_set(&fmu, &parameter, 1, &nan_), &fmu);
    must_refuse(&fmu, fmu_exit(&fmu), "", " = nan");
    must_refuse(&fmu, fmu_exit(&fmu), "", " is outside ");
    MUST(fmu_set(&fmu, &parameter, 1, &before), &fmu);
    MUST(fmu_exit(&fmu), &fmu);
    MUST(fmu_set(&fmu, &parameter, 1, &nan_), &fmu); /* and tunable afterwards */
    must_refuse(&fmu, fmu_step(&fmu, 1.0), "", " = nan");
    MUST(fmu_reset(&fmu), &fmu);
    MUST(fmu_enter(&fmu), &fmu);
    MUST(fmu_exit(&fmu), &fmu);
    fmu_free(&fmu);
}

int main(int argc, char **argv)
{
    if (argc != 7) {
        fprintf(stderr, "refusals LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    const Layout v = layout(argv[4], argv[5], argv[6]);
    in = *input_refs(&v);
    out = *output_refs(&v);
    parameter = *parameter_refs(&v);
    nan_ = (double)NAN;
    check(argv[3], 'c', 'n');
    check(argv[3], 'c', 's');
    check(argv[3], 'm', 'e');
    check(argv[3], 'm', 't');
    check_parameter(argv[3]);
    printf("every wrong call is refused with its reason\n");
    return 0;
}
