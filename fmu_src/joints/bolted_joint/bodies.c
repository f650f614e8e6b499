#include "bodies.h"

#include <string.h>

#include "optimize_for_size.h"
#include "simd.h"

OPTIMIZE_FOR_SIZE

/* Row of a Jacobian from modal values, stored as integers in units of the last digit, and three derivatives by q. */
static void set_row(const int16_t *digits, const double rigid[3], double *row)
{
    const double padded[LANES] = {rigid[0], rigid[1], rigid[2]};
    for (int k = 0; k < (int)data.n_modal_stiffness; k++)
        row[k] = digits[k] / MODE_DIGITS;
    memcpy(row + MODES, padded, sizeof padded);
}

void bodies_tabulate(Bodies *bodies)
{
    double rigid[3];
    bodies->use_avx = has_avx();
    if (!ELASTIC)
        return;
    for (int k = 0; k < MODES; k++)
        bodies->stiffness[k] = k < (int)data.n_modal_stiffness ? data.modal_stiffness[k][0] : 1.0;
    for (int i = 0; i < (int)data.n_opening; i++) {
        opening_jacobian(data.points[i][POSITION_X], data.points[i][POSITION_Y], rigid);
        set_row(data.opening[i], rigid, bodies->full_opening_jacobian[i]);
    }
    for (int j = 0; j < (int)data.n_patch_displacement_x; j++) {
        double rows[3][3];
        tangential_jacobian(data.patches[j], rows);
        set_row(data.patch_displacement_x[j], rows[0], bodies->full_tangential_jacobian[0][j]);
        set_row(data.patch_displacement_y[j], rows[1], bodies->full_tangential_jacobian[1][j]);
        set_row(data.patch_displacement_around[j], rows[2], bodies->full_tangential_jacobian[2][j]);
    }
    for (int b = 0; b < (int)data.n_bolt_elongation; b++) {
        opening_jacobian(data.bolts[b][BOLT_X], data.bolts[b][BOLT_Y], rigid);
        set_row(data.bolt_elongation[b], rigid, bodies->full_elongation_jacobian[b]);
    }
}

void modal_displacement(const Bodies *bodies, const double *modal_coordinates, double (*displacement)[3])
{
    const int patches = (int)data.n_patch_displacement_x;
    for (int d = 0; d < 3 && ELASTIC; d++)
        dense_dots(bodies->use_avx, patches, bodies->full_tangential_jacobian[d], modal_coordinates, 3,
                   &displacement[0][d]);
}

void deform(const Bodies *bodies, const double *modal_coordinates, Deformation *deformation)
{
    if (!ELASTIC)
        return;
    memcpy(deformation->modal_coordinates, modal_coordinates, sizeof deformation->modal_coordinates);
    modal_displacement(bodies, modal_coordinates, deformation->patch_displacement);
    dense_dots(bodies->use_avx, (int)data.n_opening, bodies->full_opening_jacobian, modal_coordinates, 1,
               deformation->opening);
}

END_OPTIMIZE_FOR_SIZE
