/* Repeats outputs.py of the package: sums over points, patches and bolts, from which the generated function `outputs`
 * computes the outputs; and their rates. */
#ifndef JOINTFMU_OUTPUTS_H
#define JOINTFMU_OUTPUTS_H

#include <stdbool.h>

#include "bolts.h"
#include "contact.h"
#include "equilibrium.h"
#include "friction.h"
#include "kinematics.h"

/* Arguments of `outputs`: the sums, q, its rates, the largest pressure. */
enum { X_S_REL = N_SUMS, X_THETA = X_S_REL + 3, X_RATES = X_THETA + 3, X_P_MAX = X_RATES + 6, N_X };

typedef struct {
    double x[N_X]; /* arguments of the last evaluation, for its derivative */
    /* Sums over the points, for the same preload state and normal components of q. */
    bool points_are_current;
    double points[N_SUMS], p_max, opening[3];
} OutputSums;

/* Sums over the points that were evaluated last. */
void sum_points(OutputSums *sums, const Contact *contact);
/* Sums over the points between rigid members. The points are evaluated first, unless q has the normal components of the
 * last evaluation. */
bool evaluate_point_sums(OutputSums *sums, Contact *contact, const Bodies *bodies, const double *q, Text *reason);
/* Sums over the points with elastic shear, without history. */
bool evaluate_elastic_shear(OutputSums *sums, const Contact *contact, double mu, const double *q, Text *reason);
/* Replace the normal sums by the sums of the preload state, so that both have the same round-off. */
void use_preload_sums(OutputSums *sums, const Contact *contact);
/* Sums over the patches after an update of friction. */
void sum_patches(OutputSums *sums, Friction *friction, const double *after, double area);
/* Loss and elastic energy of a cycle with the present displacement of the patches as amplitude. */
void sum_cycles(OutputSums *sums, const Friction *friction, const Contact *contact, const Bodies *bodies,
                const double *q);
/* Gaps of the bolts between rigid members, and the stiffness of bolts that is inactive because heads lift off. */
void sum_gaps(OutputSums *sums, Bolts *bolts, double area, const double *q);
/* Condensed stiffness without the bolts between rigid members, elongation of the bolts, elastic energy. */
void elastic_member_sums(OutputSums *sums, const Equilibrium *equilibrium, const double *q);
/* Set the arguments of `outputs` that are not sums. */
void set_output_arguments(OutputSums *sums, const Contact *contact, const double *inputs);

/* Rates of the sums along a seed: add them to `dx` of N_X zeros. */
void add_point_rates(const Contact *contact, const Friction *friction, const double *q, const double *q_rate,
                     double *dx);
/* Rate of the largest pressure, on a side; true: the other side has another rate. */
bool max_pressure_rate(const OutputSums *sums, const Contact *contact, double side, double *rate);
void add_patch_rates(const Friction *friction, const IncrementRate *rates, double *dx);
void add_cycle_rates(const Friction *friction, const Contact *contact, const Bodies *bodies, const double *q,
                     const IncrementRate *rates, double *dx);
void add_gap_rates(const Bolts *bolts, const double *q_rate, double *dx);
void add_elastic_member_rates(const Equilibrium *equilibrium, const double *q, const double *q_rate, double *dx);
/* Rates of the forces of the bolts between elastic members. */
void bolt_force_rates(const Equilibrium *equilibrium, const double *q_rate, double *rates);

#endif
