/* Code that is small rather than fast, between COLD and END_OF_COLD: what runs seldom, or once a step. */
#ifndef JOINTFMU_COLD_H
#define JOINTFMU_COLD_H

#ifdef __clang__ /* one attribute each, as older ones know no lists of them */
#define COLD                                                                    \
    _Pragma("clang attribute push(__attribute__((cold)), apply_to = function)") \
    _Pragma("clang attribute push(__attribute__((minsize)), apply_to = function)")
#define END_OF_COLD _Pragma("clang attribute pop") _Pragma("clang attribute pop")
#else
#define COLD
#define END_OF_COLD
#endif

#endif
