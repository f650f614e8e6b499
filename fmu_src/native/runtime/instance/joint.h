/* What a joint gives to the FMI layers. It has no state beside its tables, and what it keeps to be found sooner:
 * equal parameters, inputs and memory give equal outputs. Arrays are in the order of the variable list.
 *
 * The memory of a joint are N_MEMORY numbers, all zero where nothing moved yet; it lies in the instance
 * (memory.h), which says when a path is gone. A joint without memory looks at none, one
 * without events defines no joint_events. */
#ifndef JOINTFMU_JOINT_H
#define JOINTFMU_JOINT_H

#include <stdbool.h>
#include <stddef.h>

#include "text.h"

typedef struct Joint Joint;

/* Size of a Joint [bytes]; it is zeroed memory before the first call of joint_tabulate. */
size_t joint_size(void);

/* Evaluate the law for these parameters (each inside its own interval) into the tables.
 * false: refused, `why` names the thing, the value and what is allowed. */
bool joint_tabulate(Joint *joint, const double *parameters, Text *why);

/* Outputs at the end of the straight path from a memory to inputs that are finite and inside their intervals, and
 * the memory there. false: refused, with the reason. */
bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *outputs,
                    Text *why);

/* Exact derivative of the outputs along `seed`, at the inputs and with the memory of the last joint_evaluate; at a
 * corner the mean of both sides. Where the inputs are accepted `after` is the memory that it gave, else NULL. */
void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result);

/* Ways in which the last evaluated state lies outside the tables, a bit each; 0 inside. */
unsigned joint_outside(Joint *joint, const double *inputs, const double *outputs);

/* The warning of one such bit (1, 2, 4, ...). */
void joint_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text);

/* The N_EVENTS times [s] at which the outputs' course over time has a corner, in any order. */
void joint_events(Joint *joint, double *times);

#endif
