/* Repeats `BoltSprings` of the package: each bolt pulls at its place; where it would push, its head lifts off. */
#ifndef JOINTFMU_BOLTS_H
#define JOINTFMU_BOLTS_H

#include "bolted_joint.h"
#include "joint.h"
#include "variables.h"

enum { BOLT_X, BOLT_Y, BOLT_LEVER }; /* of `data.bolts` */

/* Elongation of bolt b by motions alone: those of the inputs, or of a seed. */
static inline double seat(int b, const double *v)
{
    return v[INPUT_S_REL_X + 2] + v[INPUT_THETA_X] * data.bolts[b][BOLT_Y] - v[INPUT_THETA_X + 1] * data.bolts[b][BOLT_X];
}

/* Forces of the bolts at tightening, from preload and moment. */
void bolts_tighten(Joint *joint, const double *inputs);
/* Rates of these forces along a seed of preload and moment. */
void bolts_tighten_rates(Joint *joint, const double *inputs, const double *seed);
/* Gap, force and stiffness of bolt b at an elongation from the tightened state. */
void bolt_elongate(JointModel *model, int b, double elongation);
/* Rate of the gap of bolt b, whose elongation has this rate. */
double bolt_gap_rate(const JointModel *model, int b, double rate);
/* Sums of rigid sides: gaps, and the stiffness of bolts that lifted off; and rates of the gaps. */
void bolts_sums(Joint *joint, const double *inputs, double *x);
void bolts_sum_rates(const Joint *joint, const double *seed, double *dx);

#endif
