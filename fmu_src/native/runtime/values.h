/* The variables of an instance, as hosts set and read them. */
#ifndef JOINTFMU_VALUES_H
#define JOINTFMU_VALUES_H

#include "evaluate.h"

Status instance_set(Instance *m, const char *function, const uint32_t refs[], size_t n,
                    const double values[]);
Status instance_get(Instance *m, const char *function, const uint32_t refs[], size_t n, double values[]);
/* Give a parameter a value. */
void instance_put(Instance *m, uint32_t ref, double value);
/* Booleans: FMI 2 and 3 hold them in different types; the caller takes them from now.values or puts them. */
bool instance_can_set_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n,
                               const void *values);
bool instance_can_get_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n,
                               const void *values);
/* Types of which there is no variable: right with n = 0 only. */
Status instance_no_variables(const Instance *m, const char *function, unsigned where, size_t n);
Status instance_set_slopes(Instance *m, const char *function, const uint32_t refs[], size_t n,
                           const int32_t orders[], const double values[]);
/* true if the unknowns are outputs and the knowns inputs, and the outputs are right. */
bool instance_can_differentiate(Instance *m, const char *function, const uint32_t unknowns[],
                                size_t n_unknowns, const uint32_t knowns[], size_t n_knowns);

#endif
