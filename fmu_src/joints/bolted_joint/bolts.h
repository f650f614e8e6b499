/* Repeats `BoltSprings` in bolts.py of the package: each bolt pulls at its position; where it would push, its head
 * lifts off. */
#ifndef JOINTFMU_BOLTS_H
#define JOINTFMU_BOLTS_H

#include <stdbool.h>

#include "data.h"
#include "kinematics.h"

typedef struct {
    double stiffness; /* of each bolt [N/m] */
    double bolts_per_position; /* bolts at each position [1] */
    double lift_off_force; /* magnitude of the force [N] up to which a bolt is at lift-off */
    double preload_force[MAX_BOLTS]; /* of each bolt [N] */
    bool is_unloaded[MAX_BOLTS];     /* the moment would make the preload force negative */
    double preload_rate[MAX_BOLTS];  /* rate of the preload force along the last seed */
    /* At the last trial: gap under the head [m], force [N], fraction of the bolt stiffness that acts [1]: times the
     * stiffness it is the active bolt stiffness of Python. */
    double gap[MAX_BOLTS], force[MAX_BOLTS], active_fraction[MAX_BOLTS];
} Bolts;

/* Preload forces from preload per bolt [N] and moment [N.m]; c are the constants. */
void set_preload_force(Bolts *bolts, const double *c, double preload, double moment);
/* Rates of the preload forces, from rates of preload and moment. */
void set_preload_rate(Bolts *bolts, const double *c, double preload, double preload_rate, double moment_rate);
/* Gap, force and active fraction of bolt b at an elongation [m] from the preloaded state. */
void elongate_bolt(Bolts *bolts, int b, double elongation);
/* Rate of the gap of bolt b, from the rate of its elongation. */
double bolt_gap_rate(const Bolts *bolts, int b, double elongation_rate);

/* Elongation [m] of bolt b between rigid bodies, or its rate. */
static inline double rigid_elongation(int b, const double q[N_DISPLACEMENTS])
{
    return rigid_opening(data.bolts[b][BOLT_X], data.bolts[b][BOLT_Y], q);
}

#endif
