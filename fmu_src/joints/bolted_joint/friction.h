/* Repeats friction.py of the package: friction of all patches with its history variables.
 *
 * Histories are arrays of N_HISTORY numbers, whose parts begin at HISTORY_STATE, ... While all patches are in full
 * stick, the history has their tractions in place of slider forces: the tractions along x and along y are stored as
 * forces of the first slider, the traction around the centre as the force along y of the second slider. */
#ifndef JOINTFMU_FRICTION_H
#define JOINTFMU_FRICTION_H

#include <stdbool.h>
#include <string.h>

#include "bodies.h"
#include "contact.h"
#include "data.h"
#include "foundation.h"
#include "kinematics.h"

/* Derivatives of the traction of a patch by displacements along x, along y and around its centre, and by opening. */
typedef double TractionDerivatives[4][3];

typedef struct {
    Foundation foundation[MAX_PATCHES];
    bool has_history;
    double mu, stiffness_ratio;
    SliderWork work;
    double trial_force[2][FOUNDATION_SLIDER_COUNT];                /* temporary slider forces */
    double stick_force[MAX_PATCHES][2][FOUNDATION_SLIDER_COUNT];  /* slider forces at the end of full stick */
    /* The last update: FULL_STICK, SLIP_1D or SLIP_2D; states at both ends, increments [m], results. */
    int state;
    PatchState start[MAX_PATCHES], end[MAX_PATCHES];
    double increment[MAX_PATCHES][3];
    SliderUpdate update[MAX_PATCHES];
    /* Sum of `continued_motion_stiffness`: its signs are the directions in which more patches slip. */
    double traction_sum[3];
    /* Rates along the last seed on a side: 1 along the seed, -1 against it; rates of the increments that point to this
     * side. */
    double side;
    IncrementRate direction[MAX_PATCHES];
    bool is_corner; /* the other side has other rates */
    SliderUpdate rate[MAX_PATCHES];
} Friction;

/* Sliders of all patches, once for a parameter set; `use_avx`: the processor has AVX. */
void friction_tabulate(Friction *friction, const Contact *contact, bool use_avx);
/* Increments of the patches [m] from the history to q and the deformation of the members. */
void set_increments(Friction *friction, const Bodies *bodies, const double *history, const double *q);
/* Tractions and tangents of the patches after their increments to the patch approaches, without losses. */
void update_traction(Friction *friction, const Contact *contact, const double *history, const double *q);
/* Tractions, tangents and losses of the patches after their increments, and the history at the end. */
void update_friction(Friction *friction, const Contact *contact, const double *history, const double *q, double *after);
/* Update for a joint without history: normal states of the patches at their approaches; the history is unchanged. */
void update_without_history(Friction *friction, const Contact *contact, const double *history, double *after);

/* Derivatives of the tractions after the last increments. Ranges whose contact changes are differentiated by
 * differences over an opening `step` [m]. */
void traction_derivatives(Friction *friction, double step, const double *history, TractionDerivatives *derivatives);
/* Traction derivatives from a tangent xx, xy, yy, xr, yr, rr; without derivatives by the opening. */
void derivatives_of_tangent(const double tangent[6], TractionDerivatives derivatives);
/* Tangent while all sliders of a patch stick, from their stiffness. */
static inline void stick_tangent(double stiffness, double tangent[6])
{
    const double all[6] = {stiffness, 0.0, stiffness, 0.0, 0.0, stiffness};
    memcpy(tangent, all, sizeof all);
}
/* Stiffness of all patches against a further S_X, S_Y, THETA_Z, each in the direction in which more sliders slip. */
void continued_motion_stiffness(Friction *friction, double stiffness[3]);
/* Stiffness of a point against S_X, S_Y, THETA_Z, times its share, from its tangent xx, xy, yy. */
static inline void point_stiffness(const double *point, const double *tangent, double *stiffness)
{
    const double share = point[SHARE], x = point[POSITION_X], y = point[POSITION_Y];
    stiffness[0] = share * tangent[0];
    stiffness[1] = share * tangent[2];
    stiffness[2] = share * (y * y * tangent[0] - 2.0 * x * y * tangent[1] + x * x * tangent[2]);
}

/* Set the slider heights to those that the next update from a history uses. */
void set_heights_from(Friction *friction, const double *history);
/* Rates of the increments along a seed, from the rates of the points and of the members. */
void increment_rates(const Friction *friction, const Contact *contact, const Bodies *bodies, const double *q_rate,
                     const double bolts[4], IncrementRate *rates);
/* Set the directions of the increments from their rates along the seed, or against the seed, as `side` says. */
void set_direction(Friction *friction, const IncrementRate *rates);
/* Rate of the update of patch j, from rates of its approach and displacement [m]. `after`: NULL, or the history after
 * the last update, from which a further motion starts. */
SliderUpdate update_rate(Friction *friction, int j, const double *history, const double *after, double approach_rate,
                         const double displacement_rate[3]);
/* Rates of the updates of all patches, in `friction->rate`. */
void update_rates(Friction *friction, const double *history, const double *after, const IncrementRate *rates);
/* Rate of `continued_motion_stiffness`. */
void continued_motion_stiffness_rate(const Friction *friction, const IncrementRate *rates, double stiffness[3]);

#endif
