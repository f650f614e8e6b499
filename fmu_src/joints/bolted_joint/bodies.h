/* Repeats bodies.py of the package: elastic deformation of both bodies, by modes. Rigid bodies have none: all is 0. */
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

/* A row of a Jacobian has derivatives by the modal coordinates [1], then by three components of q [1, m]: the normal
 * components for openings and elongations, the tangential components for patches. */
typedef struct {
    bool use_avx;            /* the processor has AVX */
    double stiffness[MODES]; /* modal stiffness [N/m]; 1 for unused modes */
    double opening_jacobian[MAX_OPENING][N_COLUMNS];
    double patch_jacobian[3][MAX_PATCH_DISPLACEMENT_X][N_COLUMNS];
    double elongation_jacobian[MAX_BOLT_ELONGATION][N_COLUMNS];
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
