/* fuzz LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS SEED CALLS
 *
 * Random calls on several instances at once: any order, any value reference, any number. After every call an
 * error has exactly one message and nothing else has any, and what came with OK is finite. */
#include "fuzz.h"

/* Values */

static int set_inputs(Actor *a)
{
    uint32_t refs[MAX_COUNT];
    double values[MAX_COUNT];
    const size_t n = any_refs(refs, input_refs(&v), v.inputs), n_values = or_wrong(n);
    for (size_t i = 0; i < MAX_COUNT; i++)
        values[i] = any_number();
    for (size_t i = 0; i < n; i++)
        a->changed |= refs[i] > v.inputs + v.outputs;
    void *c = a->fmu.instance, *where = or_null(refs), *from = or_null(values);
    return CALL(SetReal(c, where, n, from), SetFloat64(c, where, n, from, n_values));
}

static int get_outputs(Actor *a)
{
    uint32_t refs[MAX_COUNT];
    double values[MAX_COUNT];
    const size_t n = any_refs(refs, output_refs(&v), v.outputs), n_values = or_wrong(n);
    void *c = a->fmu.instance, *where = or_null(refs), *to = or_null(values);
    const int status = CALL(GetReal(c, where, n, to), GetFloat64(c, where, n, to, n_values));
    for (size_t i = 0; status == OK && i < n; i++)
        if (refs[i] > v.inputs && refs[i] <= v.inputs + v.outputs)
            CHECK(isfinite(values[i]), &a->fmu.log);
    return status;
}

/* Rare, for it costs new tables: a parameter near its start value, or any number. */
static int set_parameter(Actor *a)
{
    const size_t i = below((unsigned)v.parameters);
    const uint32_t *ref = parameter_refs(&v) + i;
    const double value = chance(2) ? any_number() : starts[i] * (1.0 + 1e-3 * (uniform() - 0.5));
    const fmi2Boolean two = (fmi2Boolean)below(3);
    const bool three = two != 0;
    void *c = a->fmu.instance;
    a->changed = true;
    return is_number[i] != chance(20) ? CALL(SetReal(c, ref, 1, &value), SetFloat64(c, ref, 1, &value, 1))
                                      : CALL(SetBoolean(c, ref, 1, &two), SetBoolean(c, ref, 1, &three, 1));
}

/* The other types have no variables. */

#define TYPES3(X)                                                                                            \
    X(Float32) X(Int8) X(UInt8) X(Int16) X(UInt16) X(Int32) X(UInt32) X(Int64) X(UInt64) X(String) X(Boolean)

static int get_others(Actor *a)
{
    uint32_t refs[MAX_COUNT];
    double room[MAX_COUNT], more[MAX_COUNT]; /* aligned for every type, and as large */
    const size_t n = chance(2) ? 0 : any_refs(refs, parameter_refs(&v), v.parameters);
    void *c = a->fmu.instance, *where = or_null(refs), *to = or_null(room), *also = or_null(more);
    unsigned i = below(library.version == 2 ? 3 : 17);
    if (library.version == 2)
        return (int)(i == 0   ? library.two.GetInteger(c, where, n, to)
                     : i == 1 ? library.two.GetString(c, where, n, to)
                              : library.two.GetBoolean(c, where, n, to));
#define X(Type)                                                                                              \
    if (i-- == 0)                                                                                            \
        return (int)library.three.Get##Type(c, where, n, to, or_wrong(n));
    TYPES3(X)
#undef X
    return (int)(i == 0   ? library.three.GetBinary(c, where, n, to, also, n)
                 : i == 1 ? library.three.GetClock(c, where, n, to)
                 : i == 2 ? library.three.GetIntervalDecimal(c, where, n, to, also)
                 : i == 3 ? library.three.GetIntervalFraction(c, where, n, to, also, NULL)
                 : i == 4 ? library.three.GetShiftDecimal(c, where, n, to)
                          : library.three.GetShiftFraction(c, where, n, to, also));
}

static int set_others(Actor *a)
{
    uint32_t refs[MAX_COUNT];
    double room[MAX_COUNT] = {0.0}, more[MAX_COUNT] = {0.0};
    const size_t n = chance(2) ? 0 : any_refs(refs, input_refs(&v), v.inputs);
    void *c = a->fmu.instance, *where = or_null(refs), *from = or_null(room), *also = or_null(more);
    unsigned i = below(library.version == 2 ? 3 : 17);
    if (library.version == 2)
        return (int)(i == 0   ? library.two.SetInteger(c, where, n, from)
                     : i == 1 ? library.two.SetString(c, where, n, from)
                              : library.two.SetBoolean(c, where, n, from));
#define X(Type)                                                                                              \
    if (i-- == 0)                                                                                            \
        return (int)library.three.Set##Type(c, where, n, from, or_wrong(n));
    TYPES3(X)
#undef X
    return (int)(i == 0   ? library.three.SetBinary(c, where, n, from, also, n)
                 : i == 1 ? library.three.SetClock(c, where, n, from)
                 : i == 2 ? library.three.SetIntervalDecimal(c, where, n, from)
                 : i == 3 ? library.three.SetIntervalFraction(c, where, n, from, also)
                 : i == 4 ? library.three.SetShiftDecimal(c, where, n, from)
                          : library.three.SetShiftFraction(c, where, n, from, also));
}

/* Steps and derivatives */

static int step(Actor *a)
{
    const double time = chance(30) ? any_number() : a->fmu.time,
                 size = chance(15) ? any_number() : uniform() + 1e-3;
    bool event = false, terminate = false, early = false;
    double last = 0.0;
    void *c = a->fmu.instance, *to = or_null(&last);
    const int status =
        CALL(DoStep(c, time, size, fmi2True), DoStep(c, time, size, true, &event, &terminate, &early, to));
    CHECK(!event && !terminate && !early, &a->fmu.log);
    if (status == OK)
        a->fmu.time = time + size;
    return status;
}

static int differentiate(Actor *a)
{
    uint32_t unknowns[MAX_COUNT], knowns[MAX_COUNT];
    double seeds[MAX_COUNT], result[MAX_COUNT];
    const size_t n = any_refs(unknowns, output_refs(&v), v.outputs),
                 k = any_refs(knowns, input_refs(&v), v.inputs);
    const bool adjoint = library.version == 3 && chance(2);
    const size_t n_seeds = adjoint ? n : k, n_result = adjoint ? k : n;
    for (size_t i = 0; i < MAX_COUNT; i++)
        seeds[i] = any_number();
    void *c = a->fmu.instance, *from = or_null(seeds), *to = or_null(result), *of = or_null(unknowns);
    const int status =
        adjoint ? (int)library.three.GetAdjointDerivative(c, of, n, knowns, k, from, or_wrong(n_seeds), to,
                                                          n_result)
                : CALL(GetDirectionalDerivative(c, of, n, knowns, k, from, to),
                       GetDirectionalDerivative(c, of, n, knowns, k, from, or_wrong(n_seeds), to, n_result));
    for (size_t i = 0; status == OK && i < n_result; i++)
        CHECK(isfinite(result[i]), &a->fmu.log);
    return status;
}

/* FMI 2: derivatives of inputs; FMI 3: dependencies of variables. */
static int relate(Actor *a)
{
    uint32_t refs[MAX_COUNT], independents[MAX_VARIABLES];
    fmi2Integer orders[MAX_COUNT];
    double values[MAX_COUNT];
    size_t n = any_refs(refs, input_refs(&v), v.inputs), of[MAX_VARIABLES], on[MAX_VARIABLES];
    fmi3DependencyKind kinds[MAX_VARIABLES];
    void *c = a->fmu.instance;
    for (size_t i = 0; i < n; i++) {
        orders[i] = chance(20) ? (fmi2Integer)below(4) : 1;
        values[i] = any_number();
    }
    if (library.version == 2)
        return (int)library.two.SetRealInputDerivatives(c, or_null(refs), n, or_null(orders),
                                                        or_null(values));
    const uint32_t ref = any_ref(output_refs(&v), v.outputs);
    if (chance(2))
        return (int)library.three.GetNumberOfVariableDependencies(c, ref, or_null(&n));
    return (int)library.three.GetVariableDependencies(c, ref, of, independents, or_null(on), kinds,
                                                      below((unsigned)v.inputs + 2));
}

/* Modes */

static int change_mode(Actor *a)
{
    void *c = a->fmu.instance;
    fmi2EventInfo info;
    fmi2Boolean event, terminate;
    bool flags[5];
    double next, from = chance(10) ? any_number() : 0.0, until = chance(4) ? any_number() : 1e3;
    switch (below(12)) {
    case 0:
    case 1:
        if (library.version == 2)
            return (int)library.two.EnterInitializationMode(c);
        a->fmu.time = from;
        return (int)library.three.EnterInitializationMode(c, chance(2), 1e-6, from, chance(2), until);
    case 2:
    case 3:
        return CALL(ExitInitializationMode(c), ExitInitializationMode(c));
    case 4:
        return CALL(EnterEventMode(c), EnterEventMode(c));
    case 5:
        return CALL(EnterContinuousTimeMode(c), EnterContinuousTimeMode(c));
    case 6:
        return CALL(
            NewDiscreteStates(c, or_null(&info)),
            UpdateDiscreteStates(c, flags, flags + 1, flags + 2, flags + 3, flags + 4, or_null(&next)));
    case 7:
        return CALL(CompletedIntegratorStep(c, fmi2True, &event, or_null(&terminate)),
                    CompletedIntegratorStep(c, true, flags, or_null(flags + 1)));
    case 8:
        return CALL(SetTime(c, any_number()), SetTime(c, any_number()));
    case 9:
        return chance(5) ? CALL(Terminate(c), Terminate(c)) : CALL(CancelStep(c), EnterStepMode(c));
    case 10:
        if (library.version == 2 && chance(2)) {
            const int status = (int)library.two.SetupExperiment(c, fmi2False, 0.0, from, chance(2), until);
            if (status == OK)
                a->fmu.time = from;
            return status;
        }
        return CALL(SetupExperiment(c, fmi2False, any_number(), 0.0, fmi2False, any_number()),
                    EnterConfigurationMode(c));
    default:
        return CALL(GetEventIndicators(c, &next, below(2)), ExitConfigurationMode(c));
    }
}

static int reset(Actor *a)
{
    const int status = CALL(Reset(a->fmu.instance), Reset(a->fmu.instance));
    a->fmu.time = 0.0;
    a->mute = a->changed = false;
    return status;
}

static int ask(Actor *a)
{
    void *c = a->fmu.instance;
    double number = 0.0;
    size_t count;
    fmi2Status status;
    fmi2Boolean boolean;
    fmi2Integer integer;
    fmi2String string;
    const fmi2StatusKind kind = (fmi2StatusKind)below(4);
    const size_t n = below(2);
    switch (below(9)) {
    case 0:
        return CALL(GetStatus(c, kind, &status), GetNumberOfContinuousStates(c, or_null(&count)));
    case 1:
        return CALL(GetRealStatus(c, kind, or_null(&number)), GetNumberOfEventIndicators(c, or_null(&count)));
    case 2:
        return CALL(GetBooleanStatus(c, kind, or_null(&boolean)), EvaluateDiscreteStates(c));
    case 3:
        return CALL(GetStringStatus(c, kind, or_null(&string)), GetEventIndicators(c, &number, n));
    case 4:
        return CALL(GetIntegerStatus(c, kind, or_null(&integer)), ActivateModelPartition(c, 1, 0.0));
    case 5:
        return CALL(SetContinuousStates(c, &number, n), SetContinuousStates(c, &number, n));
    case 6:
        return CALL(GetContinuousStates(c, &number, n), GetContinuousStates(c, &number, n));
    case 7:
        return CALL(GetNominalsOfContinuousStates(c, &number, n),
                    GetNominalsOfContinuousStates(c, &number, n));
    default:
        return CALL(GetRealOutputDerivatives(c, NULL, n, NULL, NULL),
                    GetOutputDerivatives(c, NULL, n, NULL, NULL, below(2)));
    }
}

static int select_logs(Actor *a)
{
    static const char *const known[] = {
        "logStatusError", "logStatusWarning", "logEvents", "logAll", "", NULL};
    const char *categories[3];
    bool errors = false;
    const size_t n = below(4);
    const bool on = chance(2), null = n && chance(50);
    for (size_t i = 0; i < n; i++) {
        const unsigned category = below(chance(10) ? 6 : 3);
        errors |= category == 0;
        categories[i] = known[category];
    }
    void *c = a->fmu.instance;
    const char *const *from = null ? NULL : categories;
    const int status = CALL(SetDebugLogging(c, on, n, from), SetDebugLogging(c, on, n, from));
    if (status == OK)
        a->mute = on && n > 0 && !errors;
    return status;
}

/* States */

static int save(Actor *a)
{
    Saved *s = &saved[below(N_SAVED)];
    void *c = a->fmu.instance, *to = chance(100) ? NULL : &s->state;
    const int status = CALL(GetFMUstate(c, to), GetFMUState(c, to));
    if (status == OK)
        s->exchange = a->fmu.exchange, s->mute = a->mute, s->changed = a->changed, s->time = a->fmu.time;
    return status;
}

static int restore(Actor *a)
{
    const Saved *s = &saved[below(N_SAVED)];
    void *c = a->fmu.instance;
    const int status = CALL(SetFMUstate(c, s->state), SetFMUState(c, s->state));
    CHECK((status == OK) == (s->state && s->exchange == a->fmu.exchange), &a->fmu.log);
    if (status == OK)
        a->mute = s->mute, a->changed = s->changed, a->fmu.time = s->time;
    return status;
}

static int drop(Actor *a)
{
    Saved *s = &saved[below(N_SAVED)];
    void *c = a->fmu.instance;
    const int status = CALL(FreeFMUstate(c, &s->state), FreeFMUState(c, &s->state));
    CHECK(!s->state, &a->fmu.log);
    return status;
}

/* A state as bytes and back into its place, damaged or not. */
static int pass_on(Actor *a)
{
    char bytes[MAX_BYTES];
    Saved *s = &saved[below(N_SAVED)];
    void *c = a->fmu.instance;
    size_t size = 0;
    int status = CALL(SerializedFMUstateSize(c, s->state, &size), SerializedFMUStateSize(c, s->state, &size));
    if (status != OK)
        return status;
    CHECK(size <= sizeof bytes, &a->fmu.log);
    if (chance(10)) {
        size = below((unsigned)size); /* too little room */
        return CALL(SerializeFMUstate(c, s->state, bytes, size),
                    SerializeFMUState(c, s->state, (fmi3Byte *)bytes, size));
    }
    MUST(CALL(SerializeFMUstate(c, s->state, bytes, size),
              SerializeFMUState(c, s->state, (fmi3Byte *)bytes, size)),
         &a->fmu);
    const bool flipped = chance(3), cut = chance(3);
    if (flipped)
        bytes[below((unsigned)size)] ^= (char)(1u << below(7));
    if (cut)
        size = below((unsigned)size);
    status = CALL(DeSerializeFMUstate(c, bytes, size, &s->state),
                  DeserializeFMUState(c, (fmi3Byte *)bytes, size, &s->state));
    CHECK((status == OK) == (!flipped && !cut && s->exchange == a->fmu.exchange), &a->fmu.log);
    return status;
}

/* Help: without it most instances would end refused or terminated. */

static void heal(Actor *a)
{
    for (size_t i = 0; i < v.parameters; i++)
        if (is_number[i])
            fmu_set(&a->fmu, parameter_refs(&v) + i, 1, starts + i);
    double zeros[MAX_VARIABLES] = {0.0};
    fmu_set(&a->fmu, input_refs(&v), v.inputs, zeros);
    a->changed = false;
}

static void renew(Actor *a)
{
    if (a->fmu.instance)
        fmu_free(&a->fmu);
    a->mute = a->changed = false;
    CHECK(fmu_instantiate(&a->fmu, &library, token, chance(2), chance(2)), &a->fmu.log);
}

static int act(Actor *a)
{
    const unsigned dice = below(1000);
    return dice < 300   ? set_inputs(a)
           : dice < 550 ? get_outputs(a)
           : dice < 750 ? step(a)
           : dice < 820 ? differentiate(a)
           : dice < 860 ? relate(a)
           : dice < 890 ? get_others(a)
           : dice < 920 ? set_others(a)
           : dice < 950 ? change_mode(a)
           : dice < 970 ? ask(a)
           : dice < 974 ? select_logs(a)
           : dice < 982 ? save(a)
           : dice < 986 ? restore(a)
           : dice < 988 ? drop(a)
           : dice < 996 ? pass_on(a)
           : dice < 998 ? reset(a)
                        : set_parameter(a);
}

static void learn_starts(void)
{
    Fmu fmu;
    CHECK(fmu_instantiate(&fmu, &library, token, false, false), &fmu.log);
    MUST(fmu_enter(&fmu), &fmu);
    for (size_t i = 0; i < v.parameters; i++)
        is_number[i] = fmu_get(&fmu, parameter_refs(&v) + i, 1, starts + i) == OK;
    fmu_free(&fmu);
}

int main(int argc, char **argv)
{
    if (argc != 9) {
        fprintf(stderr, "fuzz LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS SEED CALLS\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    token = argv[3];
    v = layout(argv[4], argv[5], argv[6]);
    bits = strtoull(argv[7], NULL, 10) * 2 + 1;
    const unsigned long calls = strtoul(argv[8], NULL, 10);
    learn_starts();
    for (int i = 0; i < N_INSTANCES; i++)
        renew(&actors[i]);
    unsigned long counts[4] = {0};
    for (unsigned long i = 0; i < calls; i++) {
        Actor *a = &actors[below(N_INSTANCES)];
        if (chance(2000))
            renew(a);
        if (chance(a->changed ? 100 : 400))
            heal(a);
        const bool mute = a->mute;
        const unsigned before = a->fmu.log.errors;
        const int status = act(a);
        const unsigned errors = a->fmu.log.errors - before;
        CHECK(status >= OK && status <= ERROR, &a->fmu.log);
        CHECK(errors == (status >= DISCARD && !mute ? 1u : 0u), &a->fmu.log);
        counts[status]++;
    }
    for (int i = 0; i < N_SAVED; i++)
        MUST(CALL(FreeFMUstate(actors[0].fmu.instance, &saved[i].state),
                  FreeFMUState(actors[0].fmu.instance, &saved[i].state)),
             &actors[0].fmu);
    for (int i = 0; i < N_INSTANCES; i++)
        fmu_free(&actors[i].fmu);
    printf("%lu OK, %lu warnings, %lu discarded, %lu errors\n", counts[0], counts[1], counts[2], counts[3]);
    return 0;
}
