/* Initialization and steps of co-simulation. */
#ifndef JOINTFMU_STEP_H
#define JOINTFMU_STEP_H

#include "continuous.h"

/* Check parameters and inputs and leave initialization mode. */
Status instance_initialize(Instance *m, const char *function);
/* Evaluate, and accept the inputs: the path of a joint with memory goes on from them. */
Status instance_accept(Instance *m);
/* The same in an event, with parameters that were changed in it; and the time of the next one, if there is any. */
Status instance_update_event(Instance *m, bool *defined, double *next);
Status instance_step(Instance *m, const char *function, double time, double size);

#endif
