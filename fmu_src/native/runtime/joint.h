/* What a joint gives to the FMI layers. It has no state beside its tables: equal parameters and inputs
 * give equal outputs. Arrays are in the order of the variable list. */
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

/* Outputs at inputs that are finite and inside their intervals. false: refused, with the reason. */
bool joint_evaluate(Joint *joint, const double *inputs, double *outputs, Text *why);

/* Exact derivative of the outputs along `seed` at the inputs of the last joint_evaluate. */
void joint_derivative(Joint *joint, const double *inputs, const double *seed, double *result);

/* Ways in which the last evaluated state lies outside the tables, a bit each; 0 inside. */
unsigned joint_outside(Joint *joint, const double *inputs, const double *outputs);

/* The warning of one such bit (1, 2, 4, ...). */
void joint_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text);

#endif
