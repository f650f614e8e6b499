/* Repeats equilibrium.py of the package: static equilibrium of elastic members, contact, friction and bolts. */
#ifndef JOINTFMU_EQUILIBRIUM_H
#define JOINTFMU_EQUILIBRIUM_H

#include <stdbool.h>

#include "bodies.h"
#include "bolts.h"
#include "contact.h"
#include "dense.h"
#include "friction.h"
#include "kinematics.h"
#include "text.h"

/* Size of a key that the predictor depends on: preload, moment, rigid displacement, and the end of a history. */
enum { PREDICTOR_KEY = 5 + 3 + MODES + 6 * MAX_PATCHES };

/* Number of rows of a Jacobian that are weighted and multiplied together: at least all patches and all bolts. */
enum { WEIGHTED_ROWS = (int)MAX_BOLT_ELONGATION > 64 ? (int)MAX_BOLT_ELONGATION : 64 };
_Static_assert((int)MAX_PATCHES <= (int)WEIGHTED_ROWS, "one set of rows");

/* Derivatives of the modal coordinates by q at one end of a load step, from the tangent stiffness there; and a key of
 * everything on which they depend. */
typedef struct {
    bool is_known;
    double key[PREDICTOR_KEY], modal_rates[N_DISPLACEMENTS][MODES];
    Factorization factors; /* factors of the modal tangent stiffness, the first Jacobian of Newton's method */
} ModalPredictor;

typedef struct {
    Contact *contact;
    Bodies *bodies;
    Bolts *bolts;
    Friction *friction;
} JointAssembly;

typedef struct {
    JointAssembly assembly;
    ModalPredictor start, end;         /* at both ends of the last load step */
    double condensed[N_DISPLACEMENTS]; /* diagonal of the condensed stiffness at the end of the step [N/m, N.m] */
    /* Work arrays, as Windows does not allow them on the stack. */
    double patch_opening_jacobian[MAX_PATCH_DISPLACEMENT_X][N_COLUMNS]; /* derivatives of the opening of the patches */
    double weighted[WEIGHTED_ROWS][N_COLUMNS]; /* rows of the Jacobians times their weights */
    double normal_stiffness[N_COLUMNS][N_COLUMNS], shear_stiffness[N_COLUMNS][N_COLUMNS];
    TractionDerivatives derivatives[MAX_PATCHES];
    Factorization factors; /* factors of the residual Jacobian in Newton's method */
    /* Corrections since this Jacobian [m], and their squares [m2]. */
    double corrections[MAX_NEWTON_ITERATIONS][MODES], squares[MAX_NEWTON_ITERATIONS];
} Equilibrium;

/* Elongation [m] of bolt b at q and modal coordinates, or its rate. */
static inline double bolt_elongation(const Bodies *bodies, int b, const double *q, const double *modal_coordinates)
{
    return rigid_elongation(b, q) + dense_dot(bodies->full_elongation_jacobian[b], modal_coordinates);
}

/* Equilibrium at the end of the load step from a history to the inputs, and the history there. Contact, bodies, bolts
 * and friction are then in the state of equilibrium. false: refused, with the reason. */
bool solve_equilibrium(Equilibrium *equilibrium, const double *inputs, const double *history, double *after,
                       Text *reason);
/* Rates of the deformation along a seed, from rates of points, patches and bolts at constant modal coordinates. */
void solve_modal_rates(Equilibrium *equilibrium, const double *q_rate, const double *history, const double *after);

#endif
