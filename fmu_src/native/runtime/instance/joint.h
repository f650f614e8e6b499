/* Functions of a joint that the FMI layers call. A joint has no state except its tables, and results kept for speed:
 * equal parameters, inputs and history variables give equal outputs. Arrays are in the order of the variables.
 *
 * The N_HISTORY history variables are in the instance (instance.h), which also decides which inputs are accepted. They
 * are zero in the virgin state. A joint without history ignores these arguments; one without time events does not
 * define `joint_event_times`. */
#ifndef JOINTFMU_JOINT_H
#define JOINTFMU_JOINT_H

#include <stdbool.h>
#include <stddef.h>

#include "data.h"
#include "text.h"

typedef struct Joint Joint;

/* Size of a Joint [bytes]; its memory is zero before the first call of `joint_tabulate`. */
size_t joint_size(void);

/* Free the memory that `joint_tabulate` allocated for tables, if any. */
void joint_free_tables(Joint *joint);

/* Compute the tables for parameters, each of which is inside its own interval. `joint_data`: data block of this joint,
 * which lives as long as the joint. Only this function allocates memory. false: refused; `reason` has name, value and
 * allowed values. */
bool joint_tabulate(Joint *joint, const Data *joint_data, const double *parameters, Text *reason);

/* The first `n_outputs` outputs, and history variables `history_end`, at the end of a straight load step from the
 * history variables `history` to inputs that are finite and inside their intervals. The values of the other outputs are
 * then arbitrary. false: refused, with the reason. */
bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *outputs, Text *reason);

/* Exact derivative of the first `n_outputs` outputs along `seed`, at the inputs and history of the last
 * `joint_evaluate`; at a corner the mean of both sides. The results of the other outputs are then arbitrary.
 * `history_end`: that of the last evaluation if its inputs are accepted, so that a further motion may start from it;
 * else NULL. */
void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result);

/* Bit of a warning that is no validity limit: inputs at 0 in place of their start values. */
#define LOST_START_VALUE (1u << 31)

/* Validity limits that the last evaluation exceeds, one bit each; 0: none. */
unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *outputs);

/* Text of the warning of one such bit (1, 2, 4, ...). */
void joint_describe_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text);

/* The N_TIME_EVENTS times [s] at which the outputs over time have a corner, in any order. */
void joint_event_times(Joint *joint, double *times);

#endif
