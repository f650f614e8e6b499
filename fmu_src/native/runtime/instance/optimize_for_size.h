/* Optimisation for size instead of speed, for functions between OPTIMIZE_FOR_SIZE and END_OPTIMIZE_FOR_SIZE: those that
 * are called rarely, or once a step. */
#ifndef JOINTFMU_OPTIMIZE_FOR_SIZE_H
#define JOINTFMU_OPTIMIZE_FOR_SIZE_H

#ifdef __clang__ /* one pragma for each attribute: older versions accept no list */
#define OPTIMIZE_FOR_SIZE                                                       \
    _Pragma("clang attribute push(__attribute__((cold)), apply_to = function)") \
        _Pragma("clang attribute push(__attribute__((minsize)), apply_to = function)")
#define END_OPTIMIZE_FOR_SIZE _Pragma("clang attribute pop") _Pragma("clang attribute pop")
#else
#define OPTIMIZE_FOR_SIZE
#define END_OPTIMIZE_FOR_SIZE
#endif

#endif
