#include "bolts.h"

#include <math.h>

#include "optimize_for_size.h"

void elongate_bolt(Bolts *bolts, int b, double elongation)
{
    const double force = bolts->preload_force[b] + bolts->stiffness * elongation;
    bolts->gap[b] = bolts->stiffness == 0.0 ? 0.0 : fmax(-force, 0.0) / bolts->stiffness;
    bolts->force[b] = fmax(force, 0.0);
    bolts->active_fraction[b] =
        force > bolts->lift_off_force ? 1.0 : (force < -bolts->lift_off_force ? 0.0 : LIFT_OFF_OVER_FULL_STIFFNESS);
}

double bolt_gap_rate(const Bolts *bolts, int b, double elongation_rate)
{
    const double active = bolts->active_fraction[b];
    if (bolts->stiffness == 0.0 || active == 1.0)
        return 0.0;
    /* a bolt at lift-off in the preloaded state: its preload can only increase, which leaves no gap */
    return -(1.0 - active) * elongation_rate - (active == 0.0 ? bolts->preload_rate[b] / bolts->stiffness : 0.0);
}

OPTIMIZE_FOR_SIZE

void set_preload_force(Bolts *bolts, const double *c, double preload, double moment)
{
    double working;
    working_preload(&preload, c, &working);
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double force = working + moment * (data.bolts[b][BOLT_LEVER] / bolts->bolts_per_position);
        bolts->preload_force[b] = fmax(force, 0.0);
        bolts->is_unloaded[b] = force < 0.0;
    }
}

void set_preload_rate(Bolts *bolts, const double *c, double preload, double preload_rate, double moment_rate)
{
    double working;
    working_preload_seed((const double[]){preload, preload_rate}, c, &working);
    for (int b = 0; b < (int)data.n_bolts; b++)
        bolts->preload_rate[b] =
            bolts->is_unloaded[b] ? 0.0
                                  : working + moment_rate * (data.bolts[b][BOLT_LEVER] / bolts->bolts_per_position);
}

END_OPTIMIZE_FOR_SIZE
