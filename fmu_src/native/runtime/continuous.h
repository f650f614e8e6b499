/* Continuous states of an instance. */
#ifndef JOINTFMU_CONTINUOUS_H
#define JOINTFMU_CONTINUOUS_H

#include "evaluate.h"

/* Move the states over a step of co-simulation, from a state that is accepted; outputs are to be evaluated after
 * it. A refusal is reported and may leave anything: the caller goes back. */
Status instance_advance(Instance *m, double size);
Status instance_set_states(Instance *m, const char *function, const double x[], size_t n);
Status instance_get_states(Instance *m, const char *function, double x[], size_t n);
Status instance_get_rates(Instance *m, const char *function, double x[], size_t n);
Status instance_get_nominals(Instance *m, const char *function, unsigned where, double x[], size_t n);

#endif
