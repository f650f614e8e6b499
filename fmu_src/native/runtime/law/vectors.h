/* Loops that are compiled twice: for every processor, and for those of x86-64 with vectors of four doubles, of
 * which the host's is asked once. Operations and their order are the same, and so are the bits. */
#ifndef JOINTFMU_VECTORS_H
#define JOINTFMU_VECTORS_H

#include <stdbool.h>

#ifdef __GNUC__
#define WITHIN __attribute__((always_inline, flatten)) static inline /* with all that it calls */
#else
#define WITHIN static inline
#endif

#if defined __x86_64__ && defined __GNUC__
#include <cpuid.h>

#ifdef __clang__
#define SELDOM __attribute__((cold, minsize))
#else
#define SELDOM __attribute__((cold))
#endif

/* `loop`, which is WITHIN, as `loop_any`, small rather than fast, and `loop_fours`. */
#define COMPILED_TWICE(loop, parameters, arguments)                    \
    SELDOM static void loop##_any parameters                           \
    {                                                                  \
        loop arguments;                                                \
    }                                                                  \
    __attribute__((target("avx"))) static void loop##_fours parameters \
    {                                                                  \
        loop arguments;                                                \
    }

/* Whether processor and operating system have them (Intel, Software Developer's Manual, 1-14.3). */
static inline bool vectors_of_four(void)
{
    enum { XSAVE_AND_AVX = 3 << 27, XMM_AND_YMM = 6 };
    unsigned a, b, c, d, low, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & XSAVE_AND_AVX) != XSAVE_AND_AVX)
        return false;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (low & XMM_AND_YMM) == XMM_AND_YMM;
}
#else
#define COMPILED_TWICE(loop, parameters, arguments)                    \
    static void loop##_any parameters                                  \
    {                                                                  \
        loop arguments;                                                \
    }                                                                  \
    static inline void loop##_fours parameters                         \
    {                                                                  \
        loop##_any arguments;                                          \
    }

static inline bool vectors_of_four(void)
{
    return false;
}
#endif

#endif
