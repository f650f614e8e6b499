/* Repeats bodies.py of the package: elastic deformation of both members (the bodies of the joint), by modes. Rigid
 * members have no modes: all numbers are 0. */
#ifndef JOINTFMU_BODIES_H
#define JOINTFMU_BODIES_H

#include <stdbool.h>

#include "data.h"
#include "dense.h"
#include "kinematics.h"

/* Modal coordinates a [m], the opening [m] of the points and the displacement [m] of the patches along x, y and around
 * their centres; or their rates. */
typedef struct {
    double modal_coordinates[MODES], opening[MAX_POINTS], patch_displacement[MAX_PATCHES][3];
} Deformation;

/* A row of a full Jacobian has derivatives by the modal coordinates [1], then by three components of q [1, m]: the
 * normal components for openings of points and elongations of bolts, the tangential components for patches. In Python,
 * the rows have all six components of q, and these come first. */
typedef struct {
    bool use_avx;            /* the processor has AVX */
    double stiffness[MODES]; /* modal stiffness [N/m]; 1 for unused modes */
    double full_opening_jacobian[MAX_OPENING][N_COLUMNS];
    double full_tangential_jacobian[3][MAX_PATCH_DISPLACEMENT_X][N_COLUMNS];
    double full_elongation_jacobian[MAX_BOLT_ELONGATION][N_COLUMNS];
    Deformation state, rate; /* of the last trial, and along the last seed */
    double start_displacement[MAX_PATCHES][3]; /* modal displacement [m] of the patches at the start of the load step */
} Bodies;

/* Read the modes from the data. */
void bodies_tabulate(Bodies *bodies);
/* Modal displacement [m] of the patches at modal coordinates. */
void modal_displacement(const Bodies *bodies, const double *modal_coordinates, double (*displacement)[3]);
/* Deformation at modal coordinates, or its rate. */
void deform(const Bodies *bodies, const double *modal_coordinates, Deformation *deformation);

#endif
