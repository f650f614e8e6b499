/* Derivatives of the outputs. */
#ifndef JOINTFMU_DERIVATIVE_H
#define JOINTFMU_DERIVATIVE_H

#include "values.h"

/* Derivative of outputs `unknowns` along `seed` in inputs `knowns`. */
Status instance_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                           const uint32_t knowns[], size_t n_knowns, const double seed[], double result[]);
/* Its transpose: derivative of the sum of seed[i] * unknowns[i] by each of `knowns`. */
Status instance_adjoint(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                        const uint32_t knowns[], size_t n_knowns, const double seed[], double result[]);

#endif
