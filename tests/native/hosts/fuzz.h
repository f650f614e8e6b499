/* What the fuzzer draws from: random numbers, references and counts, mostly right and sometimes wrong. */
#ifndef FUZZ_H
#define FUZZ_H

#include "host.h"

enum { N_INSTANCES = 4, N_SAVED = 6, MAX_COUNT = 12, MAX_BYTES = 1 << 17 };

typedef struct {
    Fmu fmu;
    bool mute;    /* the host switched errors off */
    bool changed; /* a parameter is not at its start value */
} Actor;

/* A state in the hands of the host, and what it knows of it. */
typedef struct {
    void *state;
    bool exchange, mute, changed;
    double time;
} Saved;

static Library library;
static const char *token;
static Layout v;
static double starts[MAX_VARIABLES]; /* of the parameters */
static bool is_number[MAX_VARIABLES];
static Actor actors[N_INSTANCES];
static Saved saved[N_SAVED];
static uint64_t bits;

static uint64_t random_bits(void)
{
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    return bits * 0x2545F4914F6CDD1Du >> 16;
}

static unsigned below(unsigned n)
{
    return (unsigned)(random_bits() % n);
}

static bool chance(unsigned one_in)
{
    return below(one_in) == 0;
}

static double uniform(void)
{
    return (double)(random_bits() & 0xFFFFFFFFu) / 4294967295.0;
}

/* Mostly ordinary numbers of any size, sometimes special ones. */
static double any_number(void)
{
    static const double special[] = {0.0,    -0.0,   1.0,     -1.0,   1e6,   -1e6,  1e150, -1e150, 1e308,
                                     -1e308, 5e-324, -5e-324, 1e-300, 1e300, 1e-12, 1e-3,  2.0,    -1e-3};
    switch (below(40)) {
    case 0:
        return (double)NAN;
    case 1:
        return chance(2) ? HUGE_VAL : -HUGE_VAL;
    case 2:
    case 3:
        return special[below(sizeof special / sizeof *special)];
    default:
        return (chance(3) ? -1.0 : 1.0) * uniform() * pow(10.0, (double)below(12) - 8.0);
    }
}

static uint32_t any_ref(const uint32_t refs[], size_t n)
{
    if (!chance(60))
        return refs[below((unsigned)n)];
    if (chance(2))
        return (uint32_t)random_bits();
    return chance(2) ? below((unsigned)v.inputs + (unsigned)v.outputs + 1)
                     : (uint32_t)(v.inputs + v.outputs + v.parameters) + below(3);
}

static size_t any_refs(uint32_t filled[], const uint32_t refs[], size_t n)
{
    const size_t count = below(MAX_COUNT + 1);
    for (size_t i = 0; i < count; i++)
        filled[i] = any_ref(refs, n);
    return count;
}

static void *or_null(void *pointer)
{
    return chance(200) ? NULL : pointer;
}

static size_t or_wrong(size_t count)
{
    return chance(100) ? below(MAX_COUNT + 1) : count;
}

#endif
