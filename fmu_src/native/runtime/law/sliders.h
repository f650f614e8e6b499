/* Jenkins sliders side by side: loops around the rule of one slider, which is generated. */
#ifndef JOINTFMU_SLIDERS_H
#define JOINTFMU_SLIDERS_H

#include <stdbool.h>
#include <stddef.h>

#include "law.h"

enum { MOST_SLIDERS = 48 }; /* of one call; an even number each */

/* Sliders before a straight path along one direction: springs K and 1/K (0 without), limits at both ends of it,
 * forces. */
typedef struct {
    const double *K, *per_K, *before, *after, *force;
} Sliders;

/* The same in a plane, by a shift along x, y and around the centre. Each limit is what stands there and K `from`, or
 * `to`, but not below 0; a force keeps a part and gains `carries` times the slider's shift, which is as far around the
 * centre as `turning` says. */
typedef struct {
    const double *force[2], *turning[2], *keeps, *carries, *K, *per_K, *before, *after;
    double from, to, shift[3];
} PlaneSliders;

/* Shift of a slider along x or y, or its rate. */
static inline double shift_of(const double *const turning[2], int k, const double shift[3], int d)
{
    return shift[d] + shift[2] * turning[d][k];
}

/* Where springs have just come to touch round-off would leave less than nothing. */
static inline double limit_at(double limit, double K, double grown)
{
    const double at = limit + K * grown;
    return at > 0.0 ? at : 0.0;
}

/* What they give together: forces along x, y and around the centre, tangents xx, xy, yy, xt, yt, tt of a further
 * motion, t around the centre; heat. Along one direction the tangents are along and, as yy, across it. */
typedef struct {
    double force[3], tangent[6], loss;
} SliderSum;

/* Along one direction, a multiple of four sliders; `before` and `after` are one array where the limits stay. */
void sliders_line(int n, const Sliders *s, double shift, double *moved, SliderSum *sum);
/* Force along one direction with limits that stay, and its tangent; a multiple of four sliders. */
double sliders_force(int n, const Sliders *s, double shift, double *tangent);
/* Derivative of the heat along one direction with limits that stay; a multiple of four sliders. */
double sliders_heat(int n, const Sliders *s, double shift);
/* Rates of force and heat along one direction where limits change, by rates of the shift and of the limits after. */
void sliders_line_rate(int n, const Sliders *s, double shift, double shift_rate, const double *after_rate,
                       SliderSum *rate);

/* In a plane, a shift along x alone with limits that stay, where most stick: the tangents are those from a slider on
 * that is returned. */
int sliders_sticking(int n, const PlaneSliders *s, double *moved, SliderSum *sum);
/* Add those of an even number of sliders along x, y and around the centre, from their forces along x and y. */
static inline void add_forces(int n, const double *x, const double *y, const double *e_x, const double *e_y,
                              double force[3])
{
    double sum[3][2] = {{0.0}};
    for (int k = 0; k < n; k += 2)
        for (int l = 0; l < 2; l++) {
            sum[0][l] += x[k + l];
            sum[1][l] += y[k + l];
            sum[2][l] += x[k + l] * e_x[k + l] + y[k + l] * e_y[k + l];
        }
    for (int d = 0; d < 3; d++)
        force[d] += sum[d][0] + sum[d][1];
}

/* In a plane: the forces of those that stick, up to the first at its limit, which is returned, and their sum; beyond it
 * those that they would have; on a processor with vectors_of_four or any other. */
int sliders_stick(bool fours, int n, const PlaneSliders *s, double *const moved[2], double force[3]);

/* Results of sliders that may slip, one row each: forces, tangents xx, xy, yy of a further motion, heat, slip. */
enum { SLID_FORCE, SLID_LOSS = 5, SLID_SLIP, N_SLID };

/* Sliders from `first` to `end` that may slip, a multiple of four; of forces alone the other rows stay as they are. */
void sliders_slide(bool fours, int first, int end, const PlaneSliders *s, double *const slid[N_SLID], bool forces);
/* What they give together. */
void sliders_sum(bool fours, int first, int end, const PlaneSliders *s, double *const slid[N_SLID], SliderSum *sum);

/* How sliders move with something else: their shift around the centre, and what is as a change of the limit after and
 * of the shift. */
typedef struct {
    const double *turning[2], *limit, *shift[2];
} SliderRates;
/* Derivatives of their forces along x, y and around the centre by a shift along x, y, around the centre, and by that
 * something; a multiple of four sliders. */
void sliders_slopes(bool fours, int n, const PlaneSliders *s, const SliderRates *rates, double slope[4][3]);

#endif
