/* Loops compiled twice for x86-64: for any processor, and with AVX, whose vectors have four doubles. The program
 * selects one at run time (`has_avx`). Both do the same operations in the same order, so their results are equal to the
 * bit. */
#ifndef JOINTFMU_SIMD_H
#define JOINTFMU_SIMD_H

#include <stdbool.h>

#ifdef __GNUC__
#define ALWAYS_INLINE __attribute__((always_inline, flatten)) static inline /* with all functions that it calls */
#else
#define ALWAYS_INLINE static inline
#endif

#if defined __x86_64__ && defined __GNUC__
#include <cpuid.h>

#ifdef __clang__
#define COLD_FUNCTION __attribute__((cold, minsize))
#else
#define COLD_FUNCTION __attribute__((cold))
#endif

/* Define two functions from an ALWAYS_INLINE function `loop`: its name with the ending `_baseline`, for any processor
 * and optimised for size, and with the ending `_avx`. */
#define DEFINE_BASELINE_AND_AVX(loop, parameters, arguments)         \
    COLD_FUNCTION static void loop##_baseline parameters             \
    {                                                                \
        loop arguments;                                              \
    }                                                                \
    __attribute__((target("avx"))) static void loop##_avx parameters \
    {                                                                \
        loop arguments;                                              \
    }

/* Whether processor and operating system support AVX (Intel, Software Developer's Manual, 1-14.3). */
static inline bool has_avx(void)
{
    enum { XSAVE_AND_AVX = 3 << 27, XMM_AND_YMM = 6 };
    unsigned a, b, c, d, low, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & XSAVE_AND_AVX) != XSAVE_AND_AVX)
        return false;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (low & XMM_AND_YMM) == XMM_AND_YMM;
}
#else
#define DEFINE_BASELINE_AND_AVX(loop, parameters, arguments) \
    static void loop##_baseline parameters                   \
    {                                                        \
        loop arguments;                                      \
    }                                                        \
    static inline void loop##_avx parameters                 \
    {                                                        \
        loop##_baseline arguments;                           \
    }

static inline bool has_avx(void)
{
    return false;
}
#endif

#endif
