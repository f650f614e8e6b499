/* Repeats `Whole` of the package: bodies that give way, in equilibrium with the interface and the bolts. */
#ifndef JOINTFMU_WHOLE_H
#define JOINTFMU_WHOLE_H

#include <string.h>

#include "bolted_joint.h"
#include "joint.h"
#include "variables.h"

enum { PAIR_PATCH, PAIR_POINT, PAIR_PART }; /* of `data.pressing` */

/* How far a point comes apart by motions alone: those of the inputs, or of a seed. */
static inline double apart_at(const double *point, const double *v)
{
    return v[INPUT_S_REL_X + 2] + v[INPUT_THETA_X] * point[PLACE_Y] - v[INPUT_THETA_X + 1] * point[PLACE_X];
}

/* The modes as numbers, once for a parameter set. */
void whole_begin(JointModel *model);
/* What amplitudes (n_modes) move: openings of points, shifts of patches. */
void whole_deform(const double *amplitude, const JointModel *model, double *opened, double (*bent)[3]);
/* Sums over what presses on the patches of values at the points. */
void whole_pressed(const JointModel *model, const double *points, double *patches);
/* Approaches of the patches under pressures of the points, at inputs and what the modes open or, NULL, tightened. */
void whole_approach(const Joint *joint, const double *pressure, const double *inputs, double *approach);
/* Amplitudes in equilibrium at the inputs, with the sums and the memory there; false: refused, with the reason. */
bool whole_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *x, Text *reason);
/* Sums that elastic sides change. */
void whole_sums(Joint *joint, const double *inputs, double *x);
/* Rates of the amplitudes along a seed, given those of pressures and tractions while they stay. */
void whole_rates(Joint *joint, const double *inputs, const double *memory, const double *after, const double *seed);
/* Rates of what `whole_sums` gives, and of the forces of the bolts. */
void whole_sum_rates(const Joint *joint, const double *inputs, const double *seed, double *dx);
void whole_bolt_rates(const Joint *joint, const double *seed, double *result);

/* In bolted_joint.c: the joint at given amplitudes, its pressures and tractions alone, or pressures, and derivatives
 * of a patch's traction. */
bool joint_forces(Joint *joint, const double *inputs, const double *memory, Text *reason);
bool joint_try(Joint *joint, const double *inputs, const double *memory, double *after, double *x, Text *reason);
bool joint_press(Joint *joint, const double *inputs, Text *reason);
Shear patch_rate(Joint *joint, int j, const double *inputs, const double *memory, const double *after, double rate,
                 const double shift[3]);
/* The slopes of a patch from its tangents xx, xy, yy, xt, yt, tt. */
static inline void slopes_of(const double t[6], Slopes slope)
{
    const Slopes rows = {{t[0], t[1], t[3]}, {t[1], t[2], t[4]}, {t[3], t[4], t[5]}};
    memcpy(slope, rows, sizeof rows);
}
/* Those of the last trial at its end: `Trials.slopes` of the package, which takes differences. */
void patch_slopes(Joint *joint, const double *inputs, const double *memory, double step, Slopes *slope);

#endif
