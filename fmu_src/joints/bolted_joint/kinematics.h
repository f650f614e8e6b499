/* Repeats kinematics.py of the package: relative displacement q of side 2, and the motion of points, patches and bolts
 * that it causes between rigid members. */
#ifndef JOINTFMU_KINEMATICS_H
#define JOINTFMU_KINEMATICS_H

#include "data.h"
#include "law.h"
#include "variables.h"

/* Components of q [m, rad], or of its rate. Normal: S_Z, THETA_X, THETA_Y; tangential: S_X, S_Y, THETA_Z. */
enum { S_X, S_Y, S_Z, THETA_X, THETA_Y, THETA_Z, N_DISPLACEMENTS };

/* Columns of `data.bolts`: position [m], force over the moment [1/m]. */
enum { BOLT_X, BOLT_Y, BOLT_LEVER };

/* Numbers of contact points and friction patches [1]. */
static inline int n_points(void)
{
    return (int)data.n_points;
}

static inline int n_patches(void)
{
    return (int)data.n_patches;
}

/* Index in the inputs of a component of the relative displacement q. */
static inline int input_of(int component)
{
    return component < THETA_X ? INPUT_S_REL_X + component : INPUT_THETA_X + component - THETA_X;
}

/* Relative displacement in the inputs, or its rate in a seed. */
static inline void relative_displacement(const double *inputs, double q[N_DISPLACEMENTS])
{
    for (int d = 0; d < N_DISPLACEMENTS; d++)
        q[d] = inputs[input_of(d)];
}

/* Opening [m] of rigid members at a position x, y [m]. */
static inline double rigid_opening(double x, double y, const double q[N_DISPLACEMENTS])
{
    return q[S_Z] + q[THETA_X] * y - q[THETA_Y] * x;
}

/* Opening [m] of rigid members at a point or patch. */
static inline double opening_at(const double *point, const double q[N_DISPLACEMENTS])
{
    return rigid_opening(point[POSITION_X], point[POSITION_Y], q);
}

/* Derivative of the rigid opening by S_Z, THETA_X, THETA_Y [1, m]. */
static inline void opening_jacobian(double x, double y, double row[3])
{
    row[0] = 1.0;
    row[1] = y;
    row[2] = -x;
}

/* Displacement [m] of rigid members at a point or patch along x and y. */
static inline double tangential_x(const double *point, const double q[N_DISPLACEMENTS])
{
    return q[S_X] - q[THETA_Z] * point[POSITION_Y];
}

static inline double tangential_y(const double *point, const double q[N_DISPLACEMENTS])
{
    return q[S_Y] + q[THETA_Z] * point[POSITION_X];
}

/* Displacement [m] of a patch along x, along y and around its centre. */
static inline void tangential_displacement(const double *patch, const double q[N_DISPLACEMENTS], double u[3])
{
    u[0] = tangential_x(patch, q);
    u[1] = tangential_y(patch, q);
    u[2] = q[THETA_Z] * patch[RADIUS];
}

/* Derivatives of the displacement of a patch by S_X, S_Y, THETA_Z [1, m]. */
static inline void tangential_jacobian(const double *patch, double rows[3][3])
{
    const double jacobian[3][3] = {
        {1.0, 0.0, -patch[POSITION_Y]}, {0.0, 1.0, patch[POSITION_X]}, {0.0, 0.0, patch[RADIUS]}};
    for (int d = 0; d < 3; d++)
        for (int k = 0; k < 3; k++)
            rows[d][k] = jacobian[d][k];
}

#endif
