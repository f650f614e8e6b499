/* Bolted joint: every node follows the curve of pressure over approach from its pressure at tightening; fewer
 * patches, which follow it as well, carry the friction. */
#ifndef JOINTFMU_BOLTED_JOINT_H
#define JOINTFMU_BOLTED_JOINT_H

#include "approach.h"
#include "data.h"
#include "dense.h"
#include "friction.h"

/* Arguments of `outputs`. */
enum { X_S_REL = N_SUMS, X_THETA = X_S_REL + 3, X_RATES = X_THETA + 3, X_P_MAX = X_RATES + 6, N_X };

/* Derivatives of a patch's traction by shifts along x, y and around its centre, and by coming apart. */
typedef double Slopes[4][3];

/* Preload, moment, shift along the surface, and the end of the memory. */
enum { FOLLOW_KEY = 5 + 3 + MODES + 6 * MAX_PATCHES };

/* Amplitudes per motion, and what decides them. */
typedef struct {
    bool known;
    double key[FOLLOW_KEY], follow[6][MODES];
    Factors factors; /* of the derivative by the amplitudes */
} Followed;

typedef struct {
    SpotDistribution spots;
    ApproachTable approach;
    CurveEnergy energy;
    Foundation foundation[MAX_PATCHES];
    bool memory;
    double mu, ratio, area;
    double weight[MAX_NODES][6]; /* share of a node alone, times x, y, y^2, x^2, x y */
    bool tight; /* the values at tightening are those of this preload and moment */
    double preload, moment;
    double start[MAX_NODES];           /* approach of each node at tightening */
    double tightened[MAX_NODES];       /* its pressure */
    double patch_start[MAX_PATCHES];   /* approach of each patch */
    double patch_now[MAX_PATCHES];     /* the same at the last pressures, of elastic sides */
    double sums[3];                  /* of the pressures at tightening: alone, times x, times y */
    bool pressed;                    /* the normal sums below are those at tightening and this displacement */
    double apart[3], normal[N_SUMS], p_max;
    Point from[MAX_PATCHES], to[MAX_PATCHES]; /* of the last evaluation */
    int moved;                       /* how it has moved up to the last evaluation */
    double known[N_X];               /* arguments of `outputs` in it, for its derivative */
    double traction[MAX_PATCHES][3], along[3]; /* of the patches in it, and what `Further` has there */
    double spread[MAX_PATCHES][2][FOUNDATION_SLIDERS]; /* forces before it of sliders that were at rest */
    Work work;

    /* Stiffness of a bolt, bolts at each place; of each place the force at tightening, whether the moment would have
     * made it negative, its rate along the last seed; in the last evaluation the gap under the head, the force, and
     * what part of its stiffness it has. */
    double bolt, bolt_count, bolt_tightened[MAX_BOLTS], bolt_tightening[MAX_BOLTS];
    bool bolt_unloaded[MAX_BOLTS];
    double bolt_gap[MAX_BOLTS], bolt_force[MAX_BOLTS], bolt_pulls[MAX_BOLTS];

    /* Elastic sides: stiffness of the modes; what modes and motions move, at points, patches (along x, y, around their centres and apart)
     * and bolts. */
    double bodies[MODES], opening[MAX_OPENING][WIDE], patch[4][MAX_PATCH_X][WIDE], stretch[MAX_STRETCH][WIDE];
    double presses[MAX_PRESSING]; /* pressure of a patch over that of a point, of the pairs in `data` */
    int press_end[MAX_PATCHES];   /* of the pairs of each patch */
    /* In the last evaluation, zero of rigid sides: amplitudes, what they open and shift; what they shifted before. */
    double amplitude[MODES], opened[MAX_NODES], bent[MAX_PATCHES][3];
    double bent_before[MAX_PATCHES][3];
    double p[MAX_NODES], k[MAX_NODES], tangent[MAX_PATCHES][6]; /* pressures, and the tangents of a further motion */
    Followed begin, end; /* at the memory before the last evaluation, and after it */
    double whole[6];     /* the stiffness of the whole after it */
    /* Rates along the last seed, zero of rigid sides; of pressure less that at tightening, stiffness and patches. */
    double amplitude_rate[MODES], opened_rate[MAX_NODES], bent_rate[MAX_PATCHES][3];
    double pressing[MAX_NODES], p_rate[MAX_NODES], stiffening[MAX_NODES];
    Shear shears[MAX_PATCHES];
    double side; /* from which the rates are taken, 1 or -1 along the seed */
    PathRate towards[MAX_PATCHES]; /* the way of the patches on that side */
    bool corner; /* the other side has other rates */
    /* Room, as large frames need more on Windows: weights, weighted rows, stiffness by normal motions and shear beside
     * the modes, slopes of the patches, factors of a derivative by the amplitudes, forces of a patch that is tried, steps since it. */
    double by[MAX_OPENING + MAX_STRETCH];
    double weighted[MAX_OPENING + MAX_PATCH_X + MAX_STRETCH][WIDE];
    double by_normal[WIDE][WIDE], by_shear[WIDE][WIDE], tried[2][FOUNDATION_SLIDERS];
    Slopes slope[MAX_PATCHES];
    Factors factors;
    double steps[MAX_ITERATIONS][MODES], squares[MAX_ITERATIONS];
} JointModel;

#endif
