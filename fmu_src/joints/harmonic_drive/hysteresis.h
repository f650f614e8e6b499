/* Friction torque with memory of a harmonic drive: sliders in parallel, spring and friction each.
 *
 * Memory: their forces, the wind-up, the loss. */
#ifndef JOINTFMU_HYSTERESIS_H
#define JOINTFMU_HYSTERESIS_H

#include "curve.h"
#include "text.h"

enum { AT_WIND_UP = SLIDERS, AT_LOSS }; /* of the memory */

typedef struct {
    bool acts;
    double most;            /* friction of all */
    double length;          /* wind-up over which the sliders begin to slip */
    double spring[SLIDERS]; /* of each slider */
    double compliance[SLIDERS];
    double limit[SLIDERS];  /* of its friction */
} Hysteresis;

/* What the sliders do on the straight path from a memory to a wind-up. */
typedef struct {
    double torque, loss; /* loss: since the memory began */
    double tangent;      /* of the torque in the wind-up */
    double heat;         /* the same of the loss */
} Slid;

/* Numbers of a drive and of its sliders, and its midline; false: refused. */
bool hysteresis_of(Hysteresis *hysteresis, const double *head, const double *share, const Curve *curve,
                   Text *why);

/* Torque, and its derivatives up to an order (2 at most), of the odd midline at a wind-up. */
void midline(const Curve *curve, double phi, int order, double *y);
/* Wind-up at which it carries a torque. */
double midline_inverse(const Curve *curve, double torque);

Slid hysteresis_at(const Hysteresis *hysteresis, const double *memory, double phi);
/* The memory after such a path; `rest` where nothing acts. */
void hysteresis_move(const Hysteresis *hysteresis, const double *before, double phi, double *after);
void hysteresis_rest(const double *before, double phi, double *after);

/* Wind-up at which midline and sliders carry a torque, coming from a memory. */
double hysteresis_wind_up(const Hysteresis *hysteresis, const Curve *curve, const double *memory,
                          double torque);

#endif
