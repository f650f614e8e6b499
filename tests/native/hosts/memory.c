/* memory LIBRARY 2|3 TOKEN
 *
 * What the runtime does with the memory of a joint, seen on the joint of slider/: k = 64 N/m, and it slips at
 * 1 N, 1/64 m from where it was. All numbers are exact. */
#include "host.h"

enum { U = 1, PRELOAD, F, K, E_LOSS, STIFFNESS, LIMIT };
#define AT(n) ((n) / 64.0)

static Library library;
static const char *token;

static void set(Fmu *fmu, uint32_t ref, double value)
{
    MUST(fmu_set(fmu, &ref, 1, &value), fmu);
}

/* Go to u, and find force, stiffness and loss; the derivative by u is the stiffness. */
static void finds(Fmu *fmu, double u, double f, double stiffness, double loss)
{
    const uint32_t refs[] = {F, K, E_LOSS}, known = U, unknown = F;
    const double one = 1.0;
    double found[3], slope;
    set(fmu, U, u);
    MUST(fmu_get(fmu, refs, 3, found), fmu);
    MUST(CALL(GetDirectionalDerivative(fmu->instance, &unknown, 1, &known, 1, &one, &slope),
              GetDirectionalDerivative(fmu->instance, &unknown, 1, &known, 1, &one, 1, &slope, 1)),
         fmu);
    CHECK(found[0] == f && found[1] == stiffness && found[2] == loss && slope == stiffness, &fmu->log);
}

static int try_accept(Fmu *fmu)
{
    void *c = fmu->instance;
    fmi2Boolean event2, end2;
    bool event, end;
    return fmu->exchange ? CALL(CompletedIntegratorStep(c, fmi2True, &event2, &end2),
                                CompletedIntegratorStep(c, true, &event, &end))
                         : fmu_step(fmu, 1.0);
}

static void start(Fmu *fmu, bool exchange)
{
    CHECK(fmu_instantiate(fmu, &library, token, exchange, false), &fmu->log);
    fmu_reach(fmu, exchange ? 't' : 's');
}

/* Tried inputs leave the past alone; accepted ones become it, and what they gave stays. */
static void check_acceptance(bool exchange)
{
    Fmu fmu;
    start(&fmu, exchange);
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    finds(&fmu, -AT(2), -1.0, 0.0, AT(1));
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    for (int i = 0; i < 2; i++) {
        MUST(try_accept(&fmu), &fmu);
        finds(&fmu, AT(4), 1.0, 0.0, AT(3));
        finds(&fmu, AT(3), 0.0, 64.0, AT(3));
        finds(&fmu, AT(1), -1.0, 0.0, AT(4));
        finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    }
    finds(&fmu, AT(3), 0.0, 64.0, AT(3));
    MUST(try_accept(&fmu), &fmu);
    finds(&fmu, AT(3), 0.0, 64.0, AT(3));
    set(&fmu, PRELOAD, -1.0);
    CHECK(try_accept(&fmu) == ERROR, &fmu.log);
    set(&fmu, PRELOAD, 0.0);
    finds(&fmu, AT(4), 1.0, 64.0, AT(3));
    finds(&fmu, AT(2.5), -0.5, 64.0, AT(3));
    MUST(fmu_reset(&fmu), &fmu);
    fmu_reach(&fmu, exchange ? 't' : 's');
    finds(&fmu, -AT(4), -1.0, 0.0, AT(3));
    fmu_free(&fmu);
}

/* The end of initialization and an event accept too. */
static void check_events(void)
{
    Fmu fmu;
    CHECK(fmu_instantiate(&fmu, &library, token, true, false), &fmu.log);
    MUST(fmu_enter(&fmu), &fmu);
    finds(&fmu, -AT(9), -1.0, 0.0, AT(8));
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    MUST(fmu_exit(&fmu), &fmu);
    finds(&fmu, AT(2), -1.0, 64.0, AT(3));
    bool flags[5];
    double next;
    fmi2EventInfo info;
    MUST(CALL(NewDiscreteStates(fmu.instance, &info),
              UpdateDiscreteStates(fmu.instance, flags, flags + 1, flags + 2, flags + 3, flags + 4, &next)),
         &fmu);
    finds(&fmu, AT(3), 0.0, 64.0, AT(3));
    fmu_free(&fmu);
}

/* A parameter acts from the accepted point on; to set it to what it is changes nothing. */
static void check_tuning(void)
{
    Fmu fmu;
    start(&fmu, false);
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    MUST(try_accept(&fmu), &fmu);
    set(&fmu, LIMIT, 1.0);
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    set(&fmu, LIMIT, 2.0);
    finds(&fmu, AT(4), 1.0, 64.0, AT(3));
    finds(&fmu, AT(6), 2.0, 0.0, AT(5));
    set(&fmu, LIMIT, 0.5);
    finds(&fmu, AT(4), 0.5, 0.0, AT(3.25));
    MUST(try_accept(&fmu), &fmu);
    finds(&fmu, AT(4), 0.5, 0.0, AT(3.25));
    finds(&fmu, AT(3.5), 0.0, 64.0, AT(3.25));
    fmu_free(&fmu);
}

/* A state, also as bytes in another instance, goes on where it was saved. */
static void check_states(bool exchange)
{
    Fmu fmu, other;
    void *state = NULL, *copy = NULL;
    fmi3Byte bytes[1024];
    size_t size;
    start(&fmu, exchange);
    CHECK(fmu_instantiate(&other, &library, token, exchange, false), &other.log);
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    MUST(try_accept(&fmu), &fmu);
    finds(&fmu, AT(1), -1.0, 0.0, AT(4));
    void *c = fmu.instance, *d = other.instance;
    MUST(CALL(GetFMUstate(c, &state), GetFMUState(c, &state)), &fmu);
    MUST(CALL(SerializedFMUstateSize(c, state, &size), SerializedFMUStateSize(c, state, &size)), &fmu);
    CHECK(size <= sizeof bytes, &fmu.log);
    MUST(CALL(SerializeFMUstate(c, state, (char *)bytes, size), SerializeFMUState(c, state, bytes, size)), &fmu);
    MUST(CALL(DeSerializeFMUstate(d, (char *)bytes, size, &copy), DeserializeFMUState(d, bytes, size, &copy)),
         &other);
    MUST(try_accept(&fmu), &fmu);
    finds(&fmu, AT(3), 1.0, 64.0, AT(4));
    for (int i = 0; i < 2; i++) {
        Fmu *one = i ? &other : &fmu;
        void *from = i ? copy : state;
        MUST(CALL(SetFMUstate(one->instance, from), SetFMUState(one->instance, from)), one);
        one->time = exchange ? 0.0 : 1.0;
        finds(one, AT(4), 1.0, 0.0, AT(3));
        finds(one, AT(3), 0.0, 64.0, AT(3));
        finds(one, AT(1), -1.0, 0.0, AT(4));
        MUST(try_accept(one), one);
        finds(one, AT(2), 0.0, 64.0, AT(4));
    }
    MUST(CALL(FreeFMUstate(c, &state), FreeFMUState(c, &state)), &fmu);
    MUST(CALL(FreeFMUstate(d, &copy), FreeFMUState(d, &copy)), &other);
    fmu_free(&fmu);
    fmu_free(&other);
}

/* Inputs that move in a step come from where they are; a refused step changes nothing. */
static void check_input_derivatives(void)
{
    Fmu fmu;
    const uint32_t refs[] = {U, PRELOAD};
    const fmi2Integer orders[] = {1, 1};
    const double down[] = {-AT(1), -1.0}, back[] = {-AT(1), 0.0};
    start(&fmu, false);
    set(&fmu, U, AT(4));
    MUST(library.two.SetRealInputDerivatives(fmu.instance, refs, 2, orders, down), &fmu);
    CHECK(fmu_step(&fmu, 1.0) == ERROR, &fmu.log);
    finds(&fmu, -AT(4), -1.0, 0.0, AT(3));
    finds(&fmu, AT(4), 1.0, 0.0, AT(3));
    MUST(library.two.SetRealInputDerivatives(fmu.instance, refs, 2, orders, back), &fmu);
    MUST(fmu_step(&fmu, 1.0), &fmu);
    finds(&fmu, AT(3), 0.0, 64.0, AT(3));
    finds(&fmu, AT(2.5), -0.5, 64.0, AT(3));
    fmu_free(&fmu);
}

int main(int argc, char **argv)
{
    if (argc != 4) {
        fprintf(stderr, "memory LIBRARY 2|3 TOKEN\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    token = argv[3];
    for (int exchange = 0; exchange < 2; exchange++) {
        check_acceptance(exchange != 0);
        check_states(exchange != 0);
    }
    check_events();
    check_tuning();
    if (library.version == 2)
        check_input_derivatives();
    printf("the slider remembers\n");
    return 0;
}
