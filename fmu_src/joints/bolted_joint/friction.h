/* Repeats `Foundation` of the package: friction with memory, by sliders that follow from the normal law. */
#ifndef JOINTFMU_FRICTION_H
#define JOINTFMU_FRICTION_H

#include "curve.h"
#include "jenkins.h"

enum {
    N_HEIGHTS = N_BELOW + N_ABOVE + 3,
    HEIGHTS = N_HEIGHTS - 1, /* ranges of heights, whose springs two sliders stand for */
    FOUNDATION_SLIDERS = 2 * HEIGHTS   /* from the lowest heights on, of each range first the one that slips earlier */
};

_Static_assert((int)FOUNDATION_SLIDERS <= (int)MAX_SLIDERS, "in one call");

typedef struct {
    const Curve *curve;
    const CurveEnergy *energy; /* its integral */
    double mu, ratio;
    const double *turning[2]; /* shifts of the sliders in a turn about the centre, over its way */
    double offset;    /* of the heights, see `around` */
    double reference; /* approach around which they lie */
    double lowest;    /* the least one since then, at which the height `lowered` stands that lay at `laid`; 0: none */
    double laid;
    int lowered;
    double height[N_HEIGHTS], load[N_HEIGHTS], stiffness[N_HEIGHTS];
    double springs[HEIGHTS]; /* normal stiffness of all springs of a range */
    double normal[HEIGHTS];  /* their normal force when the last one touches */
    double apart[HEIGHTS];   /* normal force by which the two sliders differ from then on */
    /* Of the sliders of ranges whose springs all touch: K, 1/K, and the limit at no approach, from which it grows
     * by K mu/ratio. */
    double K[FOUNDATION_SLIDERS], per_K[FOUNDATION_SLIDERS], limit[FOUNDATION_SLIDERS];
    double stick[HEIGHTS]; /* sum of K of all sliders up to a range */
} Foundation;

/* Where a patch is on the curve: approach, the load with its derivatives there, its integral up to there. */
typedef struct {
    double approach, y[3], energy;
    int full, touched; /* ranges whose springs all, or some, touch */
} Point;

/* A straight path of a patch: force of the sliders before, where it begins and ends, the shift along x, y and around
 * the centre. */
typedef struct {
    const double *force[2];
    const Point *from, *to;
    double shift[3];
    bool straight; /* no force and no shift along y and around the centre */
    bool first;    /* for rates: the first path, whose heights are laid around the approach at its end */
} PatchPath;

/* Rates of a path: of the approaches at its ends [m], of the shift [m]. */
typedef struct {
    double ends[2], shift[3];
} PathRate;

/* Ranges of which some springs touch on the way. */
static inline int touched_on(const PatchPath *path)
{
    return path->from->touched > path->to->touched ? path->from->touched : path->to->touched;
}

/* What the sliders of a patch give together, per area, as SliderResultant; a rate is its derivative along a seed. */
typedef struct {
    double traction[3], tangent[6], loss; /* the tangent of a further motion */
} Shear;

/* Two sliders of a range that stand abreast of others; of one that changes with its stiffness before, and beside them
 * the same half way where it is `across`. */
typedef struct {
    int at;
    bool changes, across;
    double K;
    const double *turning[2];
    double *moved[2];
    Shear *shear;
} Run;

/* Sliders of all patches side by side, with their shifts. */
enum { ABREAST = 64 };
typedef struct {
    bool use_avx; /* the processor has has_avx */
    int n;
    double force[2][ABREAST], shift[2][ABREAST], keeps[ABREAST], carries[ABREAST], K[ABREAST], per_K[ABREAST];
    double before[ABREAST], after[ABREAST], slid[N_MAPPING][ABREAST];
} Abreast;

/* Beside them, for slopes: shifts in a turn, and what coming apart is as a change of limit and shift. */
typedef struct {
    double turning[2][ABREAST], limit[ABREAST], shift[2][ABREAST];
} Apart;

/* Pairs that may slip, of all patches. */
typedef struct {
    Abreast abreast;
    Apart apart;
    bool forces; /* alone, up to the next end */
    int n;
    Run runs[ABREAST / 2];
} Work;

/* Lay the heights around an approach; curve, energy, mu, ratio, turning and offset are given. */
void foundation_lay(Foundation *foundation, double reference);
/* Put the next height above the lowest approach so far there. */
void foundation_lower(Foundation *foundation, double lowest);
/* The ranges that a point touches. */
void foundation_find(const Foundation *foundation, Point *point);
/* The search begins at a number of ranges that are near to be full. */
Point foundation_point(const Foundation *foundation, double approach, int near);
/* Carry the sliders along a path; `moved` are the forces after it, along x and y, of those that
 * touch on it; along y they are left out where the path is straight and the load rests. What slips is known after
 * `foundations_end`. */
void foundation_move(const Foundation *foundation, const PatchPath *path, double *const moved[2], Work *work,
                     Shear *shear);
void foundations_end(Work *work);
/* Derivatives of the traction of a patch after a path by shifts along x, y and around the centre, and by coming apart;
 * what ranges that change gain by differences over a step. `tried` is room for the forces. */
void foundation_slopes(const Foundation *f, const PatchPath *path, double step, double *const tried[2], Work *work,
                       double slope[4][3]);
/* Stiffness of all sliders that touch at a point. */
double foundation_stick(const Foundation *foundation, const Point *at);
/* A patch after a path on which all sliders stick, from a traction before; false: it moves more than hardly. */
bool foundation_rest(const Foundation *foundation, const PatchPath *path, const double before[3], Shear *shear);
/* Derivative of what it gives by the approach at both ends and the shift, on the side to which `towards` points; true:
 * the path ends at a corner, whose other side has another one. */
bool foundation_rest_rates(const Foundation *foundation, const PatchPath *path, const double before[3],
                           const PathRate *towards, const PathRate *rates, Shear *rate);
/* Forces of sliders that have stuck so far with a traction together. */
void foundation_spread(const Foundation *foundation, const Point *at, const double traction[3], double *const force[2]);
/* The same of what `foundation_move` gives. */
bool foundation_rates(const Foundation *foundation, const PatchPath *path, const PathRate *towards,
                      const PathRate *rates, Shear *rate);

#endif
