/* Jenkins sliders side by side: loops around the rule of one slider, which is generated. */
#ifndef JOINTFMU_SLIDERS_H
#define JOINTFMU_SLIDERS_H

#include <stdbool.h>
#include <stddef.h>

#include "law.h"

enum { MOST_SLIDERS = 48 }; /* of one call; an even number each */

/* Sliders before a straight path: springs K and 1/K (0 without), limits at both ends of it, forces. */
typedef struct {
    const double *K, *per_K, *before, *after;
    const double *force[2];   /* in a plane; along one direction the first */
    const double *turning[2]; /* in a plane: shifts in a turn about the centre, over its way */
} Sliders;

/* What they give together: forces along x, y and around the centre, tangents xx, xy, yy, xt, yt, tt of a further
 * motion, t around the centre; heat. Along one direction the tangents are along and, as yy, across it. */
typedef struct {
    double force[3], tangent[6], loss;
} SliderSum;

/* Along one direction, a multiple of four sliders; `before` and `after` are one array where the limits stay. */
void sliders_line(int n, const Sliders *s, double shift, double *moved, SliderSum *sum);
/* The same in a plane with limits that stay, with nothing along y and around the centre and where most stick: the
 * tangents are those from a slider on that is returned. */
int sliders_sticking(int n, const Sliders *s, double shift, double *moved, SliderSum *sum);
/* Force along one direction with limits that stay, and its tangent; a multiple of four sliders. */
double sliders_force(int n, const Sliders *s, double shift, double *tangent);
/* Derivative of the heat along one direction with limits that stay; a multiple of four sliders. */
double sliders_heat(int n, const Sliders *s, double shift);
/* Rates of force and heat along one direction where limits change, by rates of the shift and of the limits after. */
void sliders_line_rate(int n, const Sliders *s, double shift, double shift_rate, const double *after_rate,
                       SliderSum *rate);

/* In a plane, by a shift along x, y and around the centre: the forces of those that stick, up to the first at its
 * limit, which is returned, and their sum; beyond it those that they would have; on a processor with
 * vectors_of_four or any other. */
int sliders_stick(bool fours, int n, const Sliders *s, const double shift[3], double *const moved[2],
                  double force[3]);

/* Sliders that may slip, side by side whosever they are: arguments and results of `slide_plane`. */
enum { ABREAST = 64, N_SLIDER = 11, SLID_FORCE = 0, SLID_TANGENT = 2, SLID_LOSS = 5, SLID_SLIP, N_SLID };
_Static_assert((int)ABREAST >= (int)MOST_SLIDERS, "those of one call");
typedef struct {
    bool fours; /* the processor has vectors_of_four */
    int n;
    double given[N_SLIDER][ABREAST], found[N_SLID][ABREAST];
} Abreast;

/* Fills what is found; of forces alone the others stay as they are. */
void sliders_slide(Abreast *abreast, bool forces);

#endif
