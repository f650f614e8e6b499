/* states LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS SEED MUTATIONS
 *
 * Serialized states with changed fields and a right checksum: each is refused with one line and changes nothing,
 * or the instance goes on from it with defined behaviour. */
#include "host.h"

enum { MAX_BYTES = 1 << 17, MAGIC = 16, CHECKSUM = 8, N_WORDS = 5 };

typedef struct {
    Fmu fmu;
    unsigned char bytes[MAX_BYTES]; /* of a state after some steps */
    size_t size;
} Actor;

static Library library;
static const char *token;
static Layout v;
static Actor actors[2]; /* co-simulation, model exchange */
static uint64_t bits;

static unsigned below(unsigned n)
{
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    return (unsigned)((bits * 0x2545F4914F6CDD1Du >> 16) % n);
}

static size_t serialize(Fmu *fmu, void *state, unsigned char *bytes)
{
    size_t size = 0;
    void *c = fmu->instance;
    MUST(CALL(SerializedFMUstateSize(c, state, &size), SerializedFMUStateSize(c, state, &size)), fmu);
    CHECK(size <= MAX_BYTES, &fmu->log);
    MUST(CALL(SerializeFMUstate(c, state, (char *)bytes, size), SerializeFMUState(c, state, bytes, size)), fmu);
    return size;
}

static int deserialize(Fmu *fmu, const unsigned char *bytes, size_t size, void **state)
{
    void *c = fmu->instance;
    return CALL(DeSerializeFMUstate(c, (const char *)bytes, size, state), DeserializeFMUState(c, bytes, size, state));
}

static void restore(Fmu *fmu, void *state)
{
    MUST(CALL(SetFMUstate(fmu->instance, state), SetFMUState(fmu->instance, state)), fmu);
}

static void drop(Fmu *fmu, void **state)
{
    MUST(CALL(FreeFMUstate(fmu->instance, state), FreeFMUState(fmu->instance, state)), fmu);
}

static size_t snapshot(Fmu *fmu, unsigned char *bytes)
{
    void *state = NULL;
    MUST(CALL(GetFMUstate(fmu->instance, &state), GetFMUState(fmu->instance, &state)), fmu);
    const size_t size = serialize(fmu, state, bytes);
    drop(fmu, &state);
    return size;
}

static void put(unsigned char *to, uint64_t number, size_t n)
{
    for (size_t i = 0; i < n; i++)
        to[i] = (unsigned char)(number >> 8 * i & 0xFF);
}

static void put_checksum(unsigned char *bytes, size_t size)
{
    uint64_t sum = 0xCBF29CE484222325u;
    for (size_t i = 0; i < size - CHECKSUM; i++)
        sum = (sum ^ bytes[i]) * 0x100000001B3u;
    put(bytes + size - CHECKSUM, sum, CHECKSUM);
}

static uint64_t any_word(void)
{
    static const uint64_t special[] = {0, 1, 2, 3, 4, 7, 8, 16, 32, 64, 128, 256, 512, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
    return below(2) ? special[below(sizeof special / sizeof *special)] : below(0xFFFFFFFFu);
}

static uint64_t any_double(uint64_t from)
{
    static const double special[] = {0.0,    -0.0,  1.0,    2.0,     -1.0,   3.0,    0.5,  1e-9, -1e-9, 1e-3,
                                     -1e-3,  1e3,   2.2e9,  -2.2e9,  1e19,   -1e19,  1e30, 1e150, -1e150, 1e308,
                                     -1e308, 5e-324, 1e-300, HUGE_VAL, -HUGE_VAL};
    double value = 0.0;
    uint64_t number;
    memcpy(&value, &from, sizeof value);
    switch (below(4)) {
    case 0:
        return from ^ (uint64_t)1 << below(64);
    case 1:
        value *= 1.0 + 1e-2 * ((double)below(200) - 100.0);
        break;
    case 2:
        value = below(20) ? special[below(sizeof special / sizeof *special)] : (double)NAN;
        break;
    default:
        value = pow(10.0, (double)below(14) - 10.0) * (below(2) ? 1.0 : -1.0);
    }
    memcpy(&number, &value, sizeof number);
    return number;
}

/* Change a field of a state. Parameters seldom: they cost new tables. */
static void mutate(unsigned char *bytes, size_t size)
{
    const size_t head = MAGIC + 4 + 4 + strlen(token), numbers = head + 4 * N_WORDS;
    const size_t end = size - CHECKSUM;
    const unsigned dice = below(100);
    if (dice < 4)
        bytes[below((unsigned)head)] ^= (unsigned char)(1u << below(8));
    else if (dice < 30)
        put(bytes + head + 4 * below(N_WORDS), any_word(), 4);
    else if (dice < 40) /* the last words are path.last and path.accepted, if there is a memory */
        put(bytes + end - 4 * (1 + below(2)), any_word(), 4);
    else {
        size_t at = numbers + 8 * below((unsigned)((end - numbers) / 8));
        const size_t parameters = numbers + 8 * (2 + v.inputs + 1 + v.inputs);
        if (at >= parameters && at < parameters + 8 * v.parameters && below(20))
            at = numbers + 8 * below((unsigned)(parameters - numbers) / 8);
        uint64_t from = 0;
        for (size_t i = 0; i < 8; i++)
            from |= (uint64_t)bytes[at + i] << 8 * i;
        put(bytes + at, any_double(from), 8);
    }
}

/* Ask an instance for all that it can do in the mode that a state brought; refusals are right. */
static void use(Actor *a)
{
    Fmu *fmu = &a->fmu;
    void *c = fmu->instance;
    double found[MAX_VARIABLES], seed = 1.0, slope;
    bool event, end;
    fmi2Boolean event2, end2;
    if (fmu_get(fmu, output_refs(&v), v.outputs, found) == OK) {
        for (size_t i = 0; i < v.outputs; i++)
            CHECK(isfinite(found[i]), &fmu->log);
        const uint32_t *known = input_refs(&v), *unknown = output_refs(&v) + below((unsigned)v.outputs);
        if (v.inputs)
            (void)CALL(GetDirectionalDerivative(c, unknown, 1, known, 1, &seed, &slope),
                       GetDirectionalDerivative(c, unknown, 1, known, 1, &seed, 1, &slope, 1));
    }
    if (fmu->exchange)
        (void)CALL(CompletedIntegratorStep(c, fmi2True, &event2, &end2), CompletedIntegratorStep(c, true, &event, &end));
    else
        (void)fmu_step(fmu, 1e-4);
    const double zeros[MAX_VARIABLES] = {0.0};
    (void)fmu_set(fmu, input_refs(&v), v.inputs, zeros);
    (void)fmu_get(fmu, output_refs(&v), v.outputs, found);
}

static void begin(Actor *a, bool exchange)
{
    CHECK(fmu_instantiate(&a->fmu, &library, token, exchange, false), &a->fmu.log);
    fmu_reach(&a->fmu, exchange ? 't' : 's');
    for (int i = 0; i < 3; i++)
        use(a);
    a->size = snapshot(&a->fmu, a->bytes);
}

/* A state of an FMU that differs in its token alone is refused by that token. */
static void check_other_token(Actor *a)
{
    static unsigned char bytes[MAX_BYTES];
    char *other = (char *)bytes + MAGIC + 4 + 4;
    memcpy(bytes, a->bytes, a->size);
    other[1] = other[1] == '0' ? '1' : '0';
    put_checksum(bytes, a->size);
    void *state = NULL;
    char expected[128];
    snprintf(expected, sizeof expected, "a state of another FMU, with the token '%.*s'", (int)strlen(token), other);
    CHECK(deserialize(&a->fmu, bytes, a->size, &state) == ERROR && !state, &a->fmu.log);
    CHECK(strstr(a->fmu.log.last, expected), &a->fmu.log);
}

int main(int argc, char **argv)
{
    if (argc != 9) {
        fprintf(stderr, "states LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS N_PARAMETERS SEED MUTATIONS\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    token = argv[3];
    v = layout(argv[4], argv[5], argv[6]);
    bits = strtoull(argv[7], NULL, 10) * 2 + 1;
    const unsigned long mutations = strtoul(argv[8], NULL, 10);
    static unsigned char bytes[MAX_BYTES], now[MAX_BYTES];
    for (int i = 0; i < 2; i++)
        begin(&actors[i], i != 0), check_other_token(&actors[i]);
    unsigned long refused = 0;
    for (unsigned long i = 0; i < mutations; i++) {
        Actor *a = &actors[below(2)];
        memcpy(bytes, a->bytes, a->size);
        for (unsigned n = 1 + below(2); n > 0; n--)
            mutate(bytes, a->size);
        put_checksum(bytes, a->size);
        const size_t size = below(50) ? a->size : below((unsigned)a->size);
        const unsigned before = a->fmu.log.errors;
        void *state = NULL;
        const int status = deserialize(&a->fmu, bytes, size, &state);
        if (status != OK) {
            CHECK(status == ERROR && a->fmu.log.errors == before + 1 && !state, &a->fmu.log);
            refused++;
            if (i % 16 == 0) {
                CHECK(snapshot(&a->fmu, now) == a->size, &a->fmu.log);
                CHECK(memcmp(now, a->bytes, a->size) == 0, &a->fmu.log);
            }
            continue;
        }
        CHECK(a->fmu.log.errors == before && size == a->size, &a->fmu.log);
        restore(&a->fmu, state);
        use(a);
        drop(&a->fmu, &state);
        MUST(deserialize(&a->fmu, a->bytes, a->size, &state), &a->fmu);
        restore(&a->fmu, state);
        drop(&a->fmu, &state);
        a->fmu.time = 3e-4;
    }
    for (int i = 0; i < 2; i++)
        fmu_free(&actors[i].fmu);
    printf("%lu mutations, %lu refused\n", mutations, refused);
    return 0;
}
