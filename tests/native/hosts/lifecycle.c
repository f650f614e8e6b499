/* lifecycle LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS
 *
 * The whole life of instances, all calls legal; what instantiation refuses; states saved, restored and passed
 * on as bytes; 10 000 instances one after another without growth. */
#include "host.h"

#ifdef __GLIBC__
#include <malloc.h>
#pragma GCC diagnostic ignored "-Wdeprecated-declarations" /* mallinfo, which old glibc has alone */
#endif

static Library library;
static const char *token;
static Layout v;

/* Small numbers, inside of every joint's table. */
static void set_inputs(Fmu *fmu, double scale)
{
    double inputs[MAX_VARIABLES];
    for (size_t i = 0; i < v.inputs; i++)
        inputs[i] = 1e-5 * scale * (double)(i + 1);
    MUST(fmu_set(fmu, input_refs(&v), v.inputs, inputs), fmu);
}

static void get_outputs(Fmu *fmu, double outputs[])
{
    MUST(fmu_get(fmu, output_refs(&v), v.outputs, outputs), fmu);
    for (size_t i = 0; i < v.outputs; i++)
        CHECK(isfinite(outputs[i]), &fmu->log);
}

static void same_outputs(Fmu *fmu, const double expected[])
{
    double outputs[MAX_VARIABLES];
    get_outputs(fmu, outputs);
    CHECK(memcmp(outputs, expected, v.outputs * sizeof *outputs) == 0, &fmu->log);
}

/* A parameter is set to the value it has: allowed wherever it is allowed to set one. */
static int set_parameters(Fmu *fmu)
{
    int status = OK;
    for (size_t i = 0; i < v.parameters && status == OK; i++) {
        const uint32_t *ref = parameter_refs(&v) + i;
        const unsigned errors = fmu->log.errors;
        double value;
        if (fmu_get(fmu, ref, 1, &value) == OK)
            status = fmu_set(fmu, ref, 1, &value);
        else
            fmu->log.errors = errors; /* it is a Boolean */
    }
    return status;
}

/* States: `other` is a second instance of the same kind, anywhere in its life. */

typedef struct {
    void *state;
    void *bytes;
    size_t size;
} Saved;

static Saved save(Fmu *fmu)
{
    Saved s = {NULL, NULL, 0};
    void *c = fmu->instance;
    for (int twice = 0; twice < 2; twice++) /* then into the state that is there */
        MUST(CALL(GetFMUstate(c, &s.state), GetFMUState(c, &s.state)), fmu);
    MUST(CALL(SerializedFMUstateSize(c, s.state, &s.size), SerializedFMUStateSize(c, s.state, &s.size)), fmu);
    s.bytes = malloc(s.size);
    MUST(CALL(SerializeFMUstate(c, s.state, s.bytes, s.size), SerializeFMUState(c, s.state, s.bytes, s.size)),
         fmu);
    return s;
}

static void restore(Fmu *fmu, void *state)
{
    MUST(CALL(SetFMUstate(fmu->instance, state), SetFMUState(fmu->instance, state)), fmu);
}

static void drop(Fmu *fmu, void **state)
{
    for (int twice = 0; twice < 2; twice++) /* a NULL state is ignored */
        MUST(CALL(FreeFMUstate(fmu->instance, state), FreeFMUState(fmu->instance, state)), fmu);
    CHECK(!*state, &fmu->log);
}

static void restore_from_bytes(Fmu *fmu, const Saved *s)
{
    void *state = NULL;
    void *c = fmu->instance;
    MUST(CALL(DeSerializeFMUstate(c, s->bytes, s->size, &state),
              DeserializeFMUState(c, s->bytes, s->size, &state)),
         fmu);
    restore(fmu, state);
    drop(fmu, &state);
}

static void check_states(Fmu *fmu, Fmu *other)
{
    double here[MAX_VARIABLES];
    set_inputs(fmu, 3.0);
    get_outputs(fmu, here);
    Saved s = save(fmu);
    set_inputs(fmu, -2.0);
    MUST(set_parameters(fmu), fmu);
    restore(fmu, s.state);
    same_outputs(fmu, here);
    restore_from_bytes(other, &s);
    same_outputs(other, here);
    MUST(fmu_reset(other), other);
    drop(fmu, &s.state);
    free(s.bytes);
}

/* Derivatives along every input, and their transpose */

static void check_derivatives(Fmu *fmu)
{
    double seed = 1.0, column[MAX_VARIABLES];
    for (size_t j = 0; j < v.inputs; j++) {
        const uint32_t *known = input_refs(&v) + j, *unknowns = output_refs(&v);
        MUST(CALL(GetDirectionalDerivative(fmu->instance, unknowns, v.outputs, known, 1, &seed, column),
                  GetDirectionalDerivative(fmu->instance, unknowns, v.outputs, known, 1, &seed, 1, column,
                                           v.outputs)),
             fmu);
        for (size_t i = 0; library.version == 3 && i < v.outputs; i++) {
            double entry;
            MUST(library.three.GetAdjointDerivative(fmu->instance, unknowns + i, 1, known, 1, &seed, 1,
                                                    &entry, 1),
                 fmu);
            CHECK(entry == column[i], &fmu->log);
        }
    }
}

/* Lives */

static void start(Fmu *fmu)
{
    double outputs[MAX_VARIABLES];
    set_inputs(fmu, 1.0);
    MUST(fmu_enter(fmu), fmu);
    MUST(set_parameters(fmu), fmu);
    get_outputs(fmu, outputs); /* right already here */
    check_derivatives(fmu);
    MUST(fmu_exit(fmu), fmu);
    same_outputs(fmu, outputs);
}

static void live_in_steps(Fmu *fmu, Fmu *other)
{
    double outputs[MAX_VARIABLES];
    start(fmu);
    for (int i = 1; i <= 10; i++) {
        set_inputs(fmu, i);
        get_outputs(fmu, outputs); /* right without a step */
        MUST(fmu_step(fmu, 0.1 * i), fmu);
        same_outputs(fmu, outputs);
        MUST(set_parameters(fmu), fmu);
    }
    check_states(fmu, other);
    check_derivatives(fmu);
}

/* FMI 2: an input with a derivative moves with the step, once. */
static void check_input_derivatives(Fmu *fmu)
{
    double slope = 2e-6, value, after;
    const fmi2Integer first = 1;
    const uint32_t *ref = input_refs(&v);
    MUST(fmu_get(fmu, ref, 1, &value), fmu);
    MUST(library.two.SetRealInputDerivatives(fmu->instance, ref, 1, &first, &slope), fmu);
    for (int i = 0; i < 2; i++) {
        MUST(fmu_step(fmu, 0.5), fmu);
        MUST(fmu_get(fmu, ref, 1, &after), fmu);
        CHECK(after == value + 0.5 * slope, &fmu->log);
    }
}

static void co_simulate(Fmu *fmu, Fmu *other)
{
    live_in_steps(fmu, other);
    if (library.version == 2) {
        fmi2Real last;
        fmi2Status status;
        fmi2Boolean terminated;
        check_input_derivatives(fmu);
        MUST(library.two.GetRealStatus(fmu->instance, fmi2LastSuccessfulTime, &last), fmu);
        CHECK(fabs(last - fmu->time) < 1e-12, &fmu->log);
        MUST(library.two.GetStatus(fmu->instance, fmi2DoStepStatus, &status), fmu);
        MUST(status, fmu);
        MUST(library.two.GetBooleanStatus(fmu->instance, fmi2Terminated, &terminated), fmu);
        CHECK(!terminated, &fmu->log);
        MUST(library.two.Terminate(fmu->instance), fmu);
    } else {
        const uint32_t time = 0;
        double now;
        CHECK(fmu_get(fmu, &time, 1, &now) == OK && fabs(now - fmu->time) < 1e-12, &fmu->log);
        MUST(library.three.EnterConfigurationMode(fmu->instance), fmu);
        MUST(library.three.ExitConfigurationMode(fmu->instance), fmu);
        MUST(library.three.Terminate(fmu->instance), fmu);
    }
}

static void exchange2(void *c, Fmu *fmu, int i)
{
    fmi2EventInfo info;
    fmi2Boolean event, stop;
    MUST(library.two.NewDiscreteStates(c, &info), fmu);
    CHECK(!info.newDiscreteStatesNeeded && !info.nextEventTimeDefined, &fmu->log);
    MUST(library.two.EnterContinuousTimeMode(c), fmu);
    MUST(library.two.SetTime(c, 0.1 * i), fmu);
    MUST(library.two.SetContinuousStates(c, NULL, 0), fmu);
    set_inputs(fmu, i);
    MUST(library.two.GetDerivatives(c, NULL, 0), fmu);
    MUST(library.two.GetEventIndicators(c, NULL, 0), fmu);
    CHECK(library.two.CompletedIntegratorStep(c, fmi2True, &event, &stop) == fmi2OK && !event && !stop,
          &fmu->log);
    check_derivatives(fmu);
    MUST(library.two.EnterEventMode(c), fmu);
}

static void exchange3(void *c, Fmu *fmu, int i)
{
    bool more, stop, nominals, values, defined, event;
    double next;
    MUST(library.three.UpdateDiscreteStates(c, &more, &stop, &nominals, &values, &defined, &next), fmu);
    CHECK(!more && !stop && !nominals && !values && !defined, &fmu->log);
    MUST(library.three.EnterContinuousTimeMode(c), fmu);
    MUST(library.three.SetTime(c, 0.1 * i), fmu);
    MUST(library.three.SetContinuousStates(c, NULL, 0), fmu);
    set_inputs(fmu, i);
    MUST(library.three.GetContinuousStateDerivatives(c, NULL, 0), fmu);
    MUST(library.three.GetEventIndicators(c, NULL, 0), fmu);
    CHECK(library.three.CompletedIntegratorStep(c, true, &event, &stop) == fmi3OK && !event && !stop,
          &fmu->log);
    check_derivatives(fmu);
    MUST(library.three.EnterEventMode(c), fmu);
}

static void exchange(Fmu *fmu, Fmu *other)
{
    start(fmu);
    for (int i = 1; i <= 5; i++) {
        (library.version == 2 ? exchange2 : exchange3)(fmu->instance, fmu, i);
        MUST(set_parameters(fmu), fmu);
    }
    check_states(fmu, other);
    MUST(CALL(Terminate(fmu->instance), Terminate(fmu->instance)), fmu);
}

static void live(bool model_exchange, bool logging)
{
    double first[MAX_VARIABLES];
    Fmu fmu, other;
    CHECK(fmu_instantiate(&fmu, &library, token, model_exchange, logging), &fmu.log);
    CHECK(fmu_instantiate(&other, &library, token, model_exchange, false), &other.log);
    for (int i = 0; i < 2; i++) {
        (model_exchange ? exchange : co_simulate)(&fmu, &other);
        if (i == 0)
            get_outputs(&fmu, first);
        else
            same_outputs(&fmu, first); /* a second life is like the first */
        MUST(fmu_reset(&fmu), &fmu);
    }
    CHECK(fmu.log.errors == 0, &fmu.log);
    CHECK((fmu.log.events > 0) == logging, &fmu.log);
    fmu_free(&fmu);
    fmu_free(&other);
}

/* What instantiation refuses: no instance, one reason. */

static void check_refusals(void)
{
    Fmu fmu;
    CHECK(!fmu_instantiate(&fmu, &library, "{wrong}", false, false), &fmu.log);
    CHECK(fmu.log.errors == 1 && strstr(fmu.log.last, "{wrong}") && strstr(fmu.log.last, token), &fmu.log);
    CHECK(!fmu_instantiate(&fmu, &library, NULL, true, false) && fmu.log.errors == 1, &fmu.log);
    Log log = {0, 0, 0, ""};
    if (library.version == 2) {
        fmi2CallbackFunctions callbacks = {logger2, NULL, NULL, NULL, &log};
        fmi2InstantiateTYPE *make = library.two.Instantiate;
        CHECK(!make("", fmi2CoSimulation, token, "", &callbacks, 0, 0) && log.errors == 1, &log);
        CHECK(!make(NULL, fmi2CoSimulation, token, "", &callbacks, 0, 0) && log.errors == 2, &log);
        CHECK(!make("test", fmi2CoSimulation, token, "", NULL, 0, 0), &log);
        callbacks.logger = NULL; /* silent, but no crash */
        CHECK(!make("test", fmi2CoSimulation, "%s%n", "", &callbacks, 0, 0), &log);
        void *c = make("test", fmi2CoSimulation, token, NULL, &callbacks, 0, 1);
        CHECK(c && library.two.Terminate(c) == fmi2Error, &log);
        library.two.FreeInstance(c);
        library.two.FreeInstance(NULL);
        CHECK(strcmp(library.two.GetVersion(), "2.0") == 0, &log);
        CHECK(strcmp(library.two.GetTypesPlatform(), "default") == 0, &log);
    } else {
        const uint32_t input = 1;
        fmi3InstantiateCoSimulationTYPE *make = library.three.InstantiateCoSimulation;
        CHECK(!make("", token, "", 0, 0, 0, 0, NULL, 0, &log, logger3, NULL) && log.errors == 1, &log);
        CHECK(!make("test", token, "", 0, 0, 1, 0, NULL, 0, &log, logger3, NULL) && log.errors == 2, &log);
        CHECK(!library.three.InstantiateScheduledExecution("test", token, "", 0, 0, &log, logger3, NULL, NULL,
                                                           NULL) &&
                  log.errors == 3,
              &log);
        void *updated = make("test", token, "", 0, 0, 0, 0, &input, 1, &log, logger3, NULL);
        CHECK(updated && log.errors == 3, &log); /* a list of intermediate variables is left out */
        library.three.FreeInstance(updated);
        CHECK(!library.three.InstantiateModelExchange(NULL, token, "", 0, 0, NULL, NULL), &log);
        void *c = library.three.InstantiateModelExchange("test", token, NULL, 0, 1, NULL, NULL);
        CHECK(c && library.three.Terminate(c) == fmi3Error, &log);
        library.three.FreeInstance(c);
        library.three.FreeInstance(NULL);
        CHECK(strcmp(library.three.GetVersion(), "3.0") == 0, &log);
    }
}

/* Growth */

#ifdef LINKED /* sanitizers see at the end what is left behind */
enum { MANY = 100 };
#else
enum { MANY = 10000 };
#endif

static size_t allocated(void)
{
#ifndef __GLIBC__
    return 0;
#elif __GLIBC_PREREQ(2, 33)
    return mallinfo2().uordblks;
#else
    return (size_t)mallinfo().uordblks;
#endif
}

static void make_and_free(int times, bool initialized)
{
    for (int i = 0; i < times; i++) {
        Fmu fmu;
        CHECK(fmu_instantiate(&fmu, &library, token, i % 2, false), &fmu.log);
        if (initialized)
            CHECK(fmu_enter(&fmu) == OK && fmu_exit(&fmu) == OK, &fmu.log);
        fmu_free(&fmu);
    }
}

int main(int argc, char **argv)
{
    if (argc != 7) {
        fprintf(stderr, "lifecycle LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    token = argv[3];
    v = layout(argv[4], argv[5], argv[6]);
    for (int logging = 0; logging < 2; logging++)
        for (int model_exchange = 0; model_exchange < 2; model_exchange++)
            live(model_exchange, logging);
    check_refusals();
    make_and_free(10, true);
    const size_t before = allocated();
    make_and_free(MANY, false);
    make_and_free(20, true);
    const size_t grown = allocated() - before;
    if (grown != 0) {
        fprintf(stderr, "%d instances left %zu bytes behind\n", MANY, grown);
        return 1;
    }
    printf("all lives are well\n");
    return 0;
}
