/* behaviour LIBRARY 2|3 TOKEN
 *
 * What the runtime promises, seen on the joint of dummy/: messages to the letter, refusals that can be
 * mended, warnings that come once, parameters that can be tuned, states that are complete. */
#include "host.h"

enum { PRELOAD = 1, PHI, TAU, SQUARE, K, D, STIFFNESS, N, RIGID };

static Library library;
static const char *token;

static void set(Fmu *fmu, uint32_t ref, double value)
{
    MUST(fmu_set(fmu, &ref, 1, &value), fmu);
}

static double get(Fmu *fmu, uint32_t ref)
{
    double value;
    MUST(fmu_get(fmu, &ref, 1, &value), fmu);
    return value;
}

static int try_get(Fmu *fmu, uint32_t ref)
{
    double value;
    return fmu_get(fmu, &ref, 1, &value);
}

static void set_rigid(Fmu *fmu, bool rigid)
{
    const uint32_t ref = RIGID;
    const fmi2Boolean two = rigid;
    MUST(CALL(SetBoolean(fmu->instance, &ref, 1, &two), SetBoolean(fmu->instance, &ref, 1, &rigid, 1)), fmu);
}

static void instantiate(Fmu *fmu, bool logging)
{
    CHECK(fmu_instantiate(fmu, &library, token, false, logging), &fmu->log);
}

static void start(Fmu *fmu)
{
    instantiate(fmu, false);
    MUST(fmu_enter(fmu), fmu);
    MUST(fmu_exit(fmu), fmu);
}

/* One error or discarded call, to the letter. */
static void refused_with(int right, Fmu *fmu, int status, const char *expected)
{
    if (status != right || fmu->log.errors != 1 || strcmp(fmu->log.last, expected) != 0) {
        fprintf(stderr, "status %d, %u errors, expected: %s\n", status, fmu->log.errors, expected);
        fail(__FILE__, __LINE__, "refused in another way", fmu->log.last);
    }
    fmu->log.errors = 0;
}

static void refused(Fmu *fmu, int status, const char *expected)
{
    refused_with(ERROR, fmu, status, expected);
}

static void check_inputs(void)
{
    Fmu fmu;
    start(&fmu);
    set(&fmu, PRELOAD, -1.0);
    refused(&fmu, fmu_step(&fmu, 1.0), "preload = -1 N is outside [0, inf): pre-tightening force");
    refused_with(library.version == 3 ? DISCARD : ERROR, &fmu, try_get(&fmu, TAU),
                 "preload = -1 N is outside [0, inf): pre-tightening force");
    CHECK(get(&fmu, PRELOAD) == -1.0, &fmu.log);
    set(&fmu, PRELOAD, 3.0);
    set(&fmu, PHI, (double)-INFINITY);
    refused(&fmu, fmu_step(&fmu, 1.0), /* FMI 2 doubles a '#' that is meant as such */
            library.version == 2 ? "phi = -inf rad is outside (-inf, inf): angle, 100 % of ##it##"
                                 : "phi = -inf rad is outside (-inf, inf): angle, 100 % of #it#");
    set(&fmu, PHI, 1e308);
    refused(&fmu, fmu_step(&fmu, 1.0),
            "preload = 3 N, phi = 1e+308 rad: the inputs are too large, the output tau is not finite");
    set(&fmu, PHI, 42.0);
    refused(&fmu, fmu_step(&fmu, 1.0), "phi = 42 rad is not possible, allowed is any other angle");
    set(&fmu, PHI, 1.0);
    MUST(fmu_step(&fmu, 1.0), &fmu);
    CHECK(get(&fmu, TAU) == 43.0 && get(&fmu, SQUARE) == 9.0 && get(&fmu, K) == 80.0, &fmu.log);
    fmu_free(&fmu);
}

/* What a solver of model exchange tries: round-off below a minimum counts as the minimum, what is refused is
 * discarded, and the run goes on. Only an accepted step is an error. */
static void check_trials(void)
{
    static const char *const negative = "preload = -1 N is outside [0, inf): pre-tightening force";
    const uint32_t out = TAU, in = PRELOAD;
    const double seed = 1.0;
    double derivative;
    fmi2Boolean event2, end2;
    fmi3Boolean event3, end3;
    Fmu fmu;
    CHECK(fmu_instantiate(&fmu, &library, token, true, false), &fmu.log);
    MUST(fmu_enter(&fmu), &fmu);
    set(&fmu, PHI, 1.0);
    MUST(fmu_exit(&fmu), &fmu);
    void *c = fmu.instance;
    MUST(CALL(EnterContinuousTimeMode(c), EnterContinuousTimeMode(c)), &fmu);
    const double tau = get(&fmu, TAU);
    set(&fmu, PRELOAD, -1e-3);
    CHECK(get(&fmu, TAU) == tau && get(&fmu, PRELOAD) == 0.0, &fmu.log);
    set(&fmu, PRELOAD, -1.0);
    refused_with(DISCARD, &fmu, try_get(&fmu, TAU), negative);
    refused_with(library.version == 3 ? DISCARD : ERROR, &fmu,
                 CALL(GetDirectionalDerivative(c, &out, 1, &in, 1, &seed, &derivative),
                      GetDirectionalDerivative(c, &out, 1, &in, 1, &seed, 1, &derivative, 1)),
                 negative);
    set(&fmu, PRELOAD, 2.0);
    CHECK(get(&fmu, TAU) == tau + 2.0, &fmu.log);
    MUST(CALL(CompletedIntegratorStep(c, fmi2True, &event2, &end2),
              CompletedIntegratorStep(c, true, &event3, &end3)),
         &fmu);
    fmu_free(&fmu);
}

static void check_parameters(void)
{
    Fmu fmu;
    instantiate(&fmu, false);
    set(&fmu, D, 2.5);
    set(&fmu, N, 2.5);
    set(&fmu, STIFFNESS, -1.23456789012e-7);
    MUST(fmu_enter(&fmu), &fmu);
    refused(&fmu, fmu_exit(&fmu),
            "D = 2.5 is outside (1, 2): fractal dimension of the profile; "
            "k = -1.23456789e-07 N.m/rad is outside [0, 1e+09]: stiffness; "
            "n = 2.5 is not a whole number, allowed are 1, 2, 3, ...");
    set(&fmu, D, 2.0); /* the open end */
    set(&fmu, STIFFNESS, 0.0);
    set(&fmu, N, 101.0);
    refused(&fmu, try_get(&fmu, TAU), "D = 2 is outside (1, 2): fractal dimension of the profile");
    set(&fmu, D, 1.95);
    refused(&fmu, fmu_exit(&fmu), "D = 1.95 is too rough for n = 101, allowed is D <= 1.9");
    refused(&fmu, fmu_exit(&fmu), "D = 1.95 is too rough for n = 101, allowed is D <= 1.9");
    set(&fmu, N, 5.0);
    set(&fmu, STIFFNESS, 1e9); /* the closed end */
    MUST(fmu_exit(&fmu), &fmu);
    CHECK(get(&fmu, K) == 1e10, &fmu.log);
    fmu_free(&fmu);
}

static void check_tuning(void)
{
    Fmu fmu;
    start(&fmu);
    MUST(CALL(SetDebugLogging(fmu.instance, fmi2True, 0, NULL), SetDebugLogging(fmu.instance, true, 0, NULL)),
         &fmu);
    set(&fmu, STIFFNESS, 20.0);
    CHECK(get(&fmu, K) == 160.0, &fmu.log);
    CHECK(fmu.log.events == 1 && strcmp(fmu.log.last, "tables evaluated again for changed parameters") == 0,
          &fmu.log);
    set(&fmu, STIFFNESS, 20.0); /* no change: the tables stay */
    CHECK(get(&fmu, K) == 160.0 && fmu.log.events == 1, &fmu.log);
    set_rigid(&fmu, false);
    MUST(fmu_step(&fmu, 1.0), &fmu);
    CHECK(get(&fmu, K) == 80.0 && fmu.log.events == 2, &fmu.log);
    set(&fmu, D, 1.95);
    set(&fmu, N, 101.0);
    refused(&fmu, fmu_step(&fmu, 1.0), "D = 1.95 is too rough for n = 101, allowed is D <= 1.9");
    set(&fmu, D, 1.5);
    set(&fmu, N, 4.0); /* as before, but the tables were lost */
    MUST(fmu_step(&fmu, 1.0), &fmu);
    CHECK(get(&fmu, K) == 80.0, &fmu.log);
    fmu_free(&fmu);
}

static void warned(Fmu *fmu, unsigned expected, const char *last)
{
    MUST(try_get(fmu, TAU), fmu);
    CHECK(fmu->log.warnings == expected && strcmp(fmu->log.last, last) == 0, &fmu->log);
    fmu->log.warnings = 0;
    fmu->log.last[0] = '\0';
}

static void check_warnings(void)
{
    Fmu fmu;
    void *state = NULL;
    start(&fmu);
    void *c = fmu.instance;
    MUST(CALL(GetFMUstate(c, &state), GetFMUState(c, &state)), &fmu);
    set(&fmu, PHI, 11.0);
    warned(&fmu, 1, "phi = 11 is beyond the tabulated law");
    set(&fmu, PHI, 12.0);
    warned(&fmu, 0, "");
    set(&fmu, PRELOAD, 2e6);
    warned(&fmu, 1, "preload = 2e+06 is beyond the tabulated law");
    MUST(CALL(SetFMUstate(c, state), SetFMUState(c, state)), &fmu);
    set(&fmu, PHI, 13.0);
    warned(&fmu, 1, "phi = 13 is beyond the tabulated law");
    MUST(fmu_reset(&fmu), &fmu);
    MUST(fmu_enter(&fmu), &fmu);
    set(&fmu, PHI, 14.0);
    set(&fmu, PRELOAD, 3e6);
    warned(&fmu, 2, "preload = 3e+06 is beyond the tabulated law");
    MUST(CALL(FreeFMUstate(c, &state), FreeFMUState(c, &state)), &fmu);
    fmu_free(&fmu);
}

/* A state goes as bytes into an instance with other parameters, and back. */
static void check_states(void)
{
    Fmu fmu, other;
    void *state = NULL, *copy = NULL;
    fmi3Byte bytes[1024];
    size_t size;
    start(&fmu);
    instantiate(&other, false);
    set(&fmu, STIFFNESS, 25.0);
    set(&fmu, PHI, 11.0);
    warned(&fmu, 1, "phi = 11 is beyond the tabulated law");
    MUST(fmu_step(&fmu, 1.0), &fmu);
    const double tau = get(&fmu, TAU);
    if (library.version == 2) {
        const uint32_t refs[] = {PHI};
        const fmi2Integer order = 1;
        const double slope = 0.5;
        MUST(library.two.SetRealInputDerivatives(fmu.instance, refs, 1, &order, &slope), &fmu);
    }
    MUST(CALL(GetFMUstate(fmu.instance, &state), GetFMUState(fmu.instance, &state)), &fmu);
    MUST(CALL(SerializedFMUstateSize(fmu.instance, state, &size),
              SerializedFMUStateSize(fmu.instance, state, &size)),
         &fmu);
    CHECK(size <= sizeof bytes, &fmu.log);
    MUST(CALL(SerializeFMUstate(fmu.instance, state, (char *)bytes, size),
              SerializeFMUState(fmu.instance, state, bytes, size)),
         &fmu);
    MUST(CALL(DeSerializeFMUstate(other.instance, (char *)bytes, size, &copy),
              DeserializeFMUState(other.instance, bytes, size, &copy)),
         &other);
    MUST(CALL(SetFMUstate(other.instance, copy), SetFMUState(other.instance, copy)), &other);
    CHECK(get(&other, TAU) == tau && other.log.warnings == 0, &other.log);
    set(&other, STIFFNESS, 30.0);
    CHECK(get(&other, TAU) != tau, &other.log);
    MUST(CALL(SetFMUstate(other.instance, copy), SetFMUState(other.instance, copy)), &other);
    CHECK(get(&other, TAU) == tau, &other.log);
    other.time = 1.0;
    MUST(fmu_step(&other, 2.0), &other);
    CHECK(get(&other, PHI) == (library.version == 2 ? 12.0 : 11.0), &other.log);
    MUST(CALL(FreeFMUstate(fmu.instance, &state), FreeFMUState(fmu.instance, &state)), &fmu);
    MUST(CALL(FreeFMUstate(fmu.instance, &copy), FreeFMUState(fmu.instance, &copy)), &fmu);
    fmu_free(&fmu);
    fmu_free(&other);
}

static void check_stop_time(void)
{
    Fmu fmu;
    instantiate(&fmu, false);
    if (library.version == 2) {
        MUST(library.two.SetupExperiment(fmu.instance, fmi2False, 0.0, 2.0, fmi2True, 3.0), &fmu);
        MUST(library.two.EnterInitializationMode(fmu.instance), &fmu);
    } else {
        MUST(library.three.EnterInitializationMode(fmu.instance, false, 0.0, 2.0, true, 3.0), &fmu);
    }
    MUST(fmu_exit(&fmu), &fmu);
    refused(&fmu, fmu_step(&fmu, 1.0),
            library.version == 2
                ? "fmi2DoStep: the communication point is at 0 s with step 1 s; expected it at 2 s"
                : "fmi3DoStep: the communication point is at 0 s with step 1 s; expected it at 2 s");
    fmu.time = 2.0;
    for (int i = 0; i < 10; i++)
        MUST(fmu_step(&fmu, 0.1), &fmu); /* to the end, up to rounding */
    fmu.time = 3.0;
    refused(&fmu, fmu_step(&fmu, 0.25),
            library.version == 2 ? "fmi2DoStep: the step ends after the stop time at 3 s with step 0.25 s; "
                                   "expected an end at or before 3 s"
                                 : "fmi3DoStep: the step ends after the stop time at 3 s with step 0.25 s; "
                                   "expected an end at or before 3 s");
    fmu_free(&fmu);
}

/* A refused step changes nothing: neither the input that moved nor its derivative; a reset clears both. */
static void check_input_derivatives(void)
{
    Fmu fmu;
    const uint32_t refs[] = {PHI, PRELOAD};
    const fmi2Integer orders[] = {1, 1};
    const double slopes[] = {0.5, -1.0};
    start(&fmu);
    MUST(library.two.SetRealInputDerivatives(fmu.instance, refs, 2, orders, slopes), &fmu);
    refused(&fmu, fmu_step(&fmu, 1.0), "preload = -1 N is outside [0, inf): pre-tightening force");
    CHECK(get(&fmu, PHI) == 0.0 && get(&fmu, PRELOAD) == 0.0 && get(&fmu, TAU) == 0.0, &fmu.log);
    set(&fmu, PRELOAD, 1.0);
    MUST(fmu_step(&fmu, 1.0), &fmu);
    CHECK(get(&fmu, PHI) == 0.5 && get(&fmu, PRELOAD) == 0.0 && get(&fmu, TAU) == 12.5, &fmu.log);
    MUST(library.two.SetRealInputDerivatives(fmu.instance, refs, 1, orders, slopes), &fmu);
    MUST(fmu_reset(&fmu), &fmu);
    MUST(fmu_enter(&fmu), &fmu);
    MUST(fmu_exit(&fmu), &fmu);
    MUST(fmu_step(&fmu, 1.0), &fmu);
    CHECK(get(&fmu, PHI) == 0.0, &fmu.log);
    fmu_free(&fmu);
}

static void check_derivatives(void)
{
    Fmu fmu;
    const uint32_t unknowns[] = {K, TAU, SQUARE}, knowns[] = {PHI, PRELOAD};
    const double seed[] = {2.0, 3.0}, weights[] = {1.0, 10.0, 100.0};
    double along[3], by[2];
    start(&fmu);
    set(&fmu, PHI, 1.0);
    set(&fmu, PRELOAD, 5.0);
    MUST(CALL(GetDirectionalDerivative(fmu.instance, unknowns, 3, knowns, 2, seed, along),
              GetDirectionalDerivative(fmu.instance, unknowns, 3, knowns, 2, seed, 2, along, 3)),
         &fmu);
    CHECK(along[0] == 0.0 && along[1] == 20.0 * 4.0 * 2.0 + 3.0 && along[2] == 2.0 * 5.0 * 3.0, &fmu.log);
    if (library.version == 3) {
        size_t n, of[2], on[2];
        uint32_t independents[2];
        fmi3DependencyKind kinds[2];
        MUST(library.three.GetAdjointDerivative(fmu.instance, unknowns, 3, knowns, 2, weights, 3, by, 2),
             &fmu);
        CHECK(by[0] == 10.0 * 20.0 * 4.0 && by[1] == 10.0 + 100.0 * 10.0, &fmu.log);
        MUST(library.three.GetNumberOfVariableDependencies(fmu.instance, SQUARE, &n), &fmu);
        CHECK(n == 1, &fmu.log);
        MUST(library.three.GetVariableDependencies(fmu.instance, SQUARE, of, independents, on, kinds, n),
             &fmu);
        CHECK(independents[0] == PRELOAD && kinds[0] == fmi3Dependent && of[0] == 0 && on[0] == 0, &fmu.log);
        MUST(library.three.GetNumberOfVariableDependencies(fmu.instance, K, &n), &fmu);
        CHECK(n == 0, &fmu.log);
        MUST(library.three.EnterConfigurationMode(fmu.instance), &fmu);
        refused(&fmu, try_get(&fmu, TAU),
                "fmi3GetFloat64: called in reconfiguration mode; expected initialization mode, step mode, "
                "terminated state");
    }
    fmu_free(&fmu);
}

/* Categories: errors and warnings from the start, exactly what is selected, and nothing with an unknown one.
 */
static void check_logging(void)
{
    Fmu fmu;
    const char *events[] = {"logEvents"}, *all[] = {"logEvents", "logAll"};
    instantiate(&fmu, true);
    void *c = fmu.instance;
    MUST(fmu_enter(&fmu), &fmu);
    CHECK(fmu.log.events == 2 && strcmp(fmu.log.last, "now in initialization mode") == 0, &fmu.log);
    MUST(CALL(SetDebugLogging(c, fmi2True, 1, events), SetDebugLogging(c, true, 1, events)), &fmu);
    CHECK(fmu_step(&fmu, 1.0) == ERROR && fmu.log.errors == 0, &fmu.log);
    MUST(CALL(SetDebugLogging(c, fmi2False, 1, events), SetDebugLogging(c, false, 1, events)), &fmu);
    refused(&fmu, CALL(SetDebugLogging(c, fmi2True, 2, all), SetDebugLogging(c, true, 2, all)),
            library.version == 2
                ? "fmi2SetDebugLogging: category 'logAll' is unknown; expected logStatusError, "
                  "logStatusWarning, logEvents"
                : "fmi3SetDebugLogging: category 'logAll' is unknown; expected logStatusError, "
                  "logStatusWarning, logEvents");
    MUST(fmu_exit(&fmu), &fmu);
    CHECK(fmu.log.events == 2, &fmu.log);
    MUST(fmu_reset(&fmu), &fmu); /* as after instantiation */
    CHECK(fmu.log.events == 3 && strcmp(fmu.log.last, "now in instantiated state") == 0, &fmu.log);
    fmu_free(&fmu);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "behaviour LIBRARY 2|3 TOKEN\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    token = argv[3];
    check_inputs();
    check_trials();
    check_parameters();
    check_tuning();
    check_warnings();
    check_states();
    check_stop_time();
    check_derivatives();
    check_logging();
    if (library.version == 2)
        check_input_derivatives();
    printf("the dummy behaves\n");
    return 0;
}
