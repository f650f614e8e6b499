/* Repeats `Foundation` in sliders.py of the package: the friction sliders of one patch. Their stiffnesses and limits
 * follow from its curve of pressure over approach. Forces and stiffnesses are per area. */
#ifndef JOINTFMU_FOUNDATION_H
#define JOINTFMU_FOUNDATION_H

#include "curve.h"
#include "jenkins.h"

enum {
    N_HEIGHTS = HEIGHTS_BELOW_REFERENCE + HEIGHTS_ABOVE_REFERENCE + 3,
    N_RANGES = N_HEIGHTS - 1, /* ranges of springs between two heights; each has two sliders */
    /* in the order of the heights; of each range the slider that slips first, then the other one */
    FOUNDATION_SLIDER_COUNT = 2 * N_RANGES
};

_Static_assert((int)FOUNDATION_SLIDER_COUNT <= (int)MAX_SLIDERS, "all sliders of a patch in one call");

typedef struct {
    const Curve *curve;
    double mu, ratio;     /* friction coefficient, stiffness ratio K_T/K_N [1] */
    const double *torsion_directions[2]; /* unit vectors of the sliders on the circle of the patch */
    double offset;         /* offset of the heights [1], see `slider_heights` */
    double onset_approach; /* reference approach of the heights [m] */
    double min_approach;   /* smallest approach [m] since the heights were set */
    int liftoff_height;    /* index of the height that moved from `replaced_height` [m] to `min_approach`; 0: none */
    double replaced_height;
    double height[N_HEIGHTS], load[N_HEIGHTS], stiffness[N_HEIGHTS]; /* [m]; pressure [Pa], stiffness [Pa/m] there */
    double normal_stiffness[N_RANGES]; /* stiffness of all springs of a range [Pa/m] */
    double normal_force[N_RANGES];     /* normal force of a range when its last spring touches [Pa] */
    double force_deviation[N_RANGES];  /* at that approach: deviation of both sliders from their mean force [Pa] */
    /* Sliders of ranges in full contact: tangential stiffness K, 1/K, and the limit at zero approach, from which it
     * increases by K mu/ratio. */
    double K[FOUNDATION_SLIDER_COUNT], per_K[FOUNDATION_SLIDER_COUNT], limit_at_zero_approach[FOUNDATION_SLIDER_COUNT];
    double stick_stiffness[N_RANGES]; /* sum of K of all sliders up to a range */
} Foundation;

/* Normal state of a patch: approach [m], pressure [Pa] with two derivatives by the approach, energy [J/m2]. */
typedef struct {
    double approach, y[3], energy;
    int full_ranges, touched_ranges; /* numbers of ranges with all springs, or at least one spring, in contact */
} PatchState;

/* Increment of a patch: slider forces at the start, states at both ends, displacement [m] along x, along y and around
 * the centre. */
typedef struct {
    const double *force[2];
    const PatchState *start, *end;
    double displacement[3];
    bool is_1d;    /* all forces and displacements are along x */
    bool is_first; /* for rates: the slider heights are set at the end of this increment */
} PatchIncrement;

/* Rates of an increment: of the approaches at both ends [m], of the displacement [m]. */
typedef struct {
    double ends[2], displacement[3];
} IncrementRate;

/* Number of ranges of which some springs touch during an increment. */
static inline int touched_ranges_of(const PatchIncrement *path)
{
    const int start = path->start->touched_ranges, end = path->end->touched_ranges;
    return start > end ? start : end;
}

/* Result of an increment of a patch, or its rate: traction against the displacement along x, along y and around the
 * centre [Pa]; tangent stiffness xx, xy, yy, xr, yr, rr [Pa/m], r around the centre; dissipated energy [J/m2]. */
typedef struct {
    double traction[3], tangent[6], loss;
} SliderUpdate;

/* Rows of a batch for both sliders of a range, from row `at` on. If springs of the range come into contact or lift off,
 * two rows with half of the increment follow. */
typedef struct {
    int at;
    bool stiffness_changes, contact_changes;
    double K; /* at the start */
    const double *torsion_directions[2];
    double *force_end[2];
    SliderUpdate *update;
} Run;

/* Arguments and results of the return mapping of sliders of several patches. */
enum { BATCH_SIZE = 64 };
typedef struct {
    bool use_avx; /* the processor has AVX */
    int n;
    double force[2][BATCH_SIZE], displacement[2][BATCH_SIZE], retention[BATCH_SIZE], secant_stiffness[BATCH_SIZE];
    double K[BATCH_SIZE], per_K[BATCH_SIZE], limit_start[BATCH_SIZE], limit_end[BATCH_SIZE];
    double results[N_MAPPING][BATCH_SIZE];
} SimdBatch;

/* Derivatives of the arguments of a batch: of the displacement by the displacement around the centre, and of limit and
 * displacement by the opening. */
typedef struct {
    double torsion_directions[2][BATCH_SIZE], limit_rate[BATCH_SIZE], displacement_rate[2][BATCH_SIZE];
} OpeningBatch;

/* Sliders whose return mapping is not yet computed. */
typedef struct {
    SimdBatch batch;
    OpeningBatch opening;
    bool forces_only; /* until the next `foundations_finish`, only tractions are computed, no tangents and losses */
    int n;
    Run runs[BATCH_SIZE / 2];
} SliderWork;

/* Set all heights for an onset approach; curve, mu, ratio, directions and offset are given. */
void foundation_set_heights(Foundation *foundation, double onset_approach);
/* Move the first height above the smallest approach since the onset down to this approach. */
void heights_after_liftoff(Foundation *foundation, double min_approach);
/* Find the numbers of ranges in contact. */
void find_ranges(const Foundation *foundation, PatchState *state);
/* Normal state of a patch at an approach [m]; the search starts with `near` ranges in full contact. */
PatchState patch_state(const Foundation *foundation, double approach, int near);
/* Return-map all sliders for one increment. `force_end` gets the forces along x and along y of the sliders that touch
 * during the increment; forces along y are left out if the increment is along x under constant load. Results of sliders
 * that slip are known after `foundations_finish`. */
void foundation_advance(const Foundation *foundation, const PatchIncrement *path, double *const force_end[2],
                        SliderWork *work, SliderUpdate *update);
void foundations_finish(SliderWork *work);
/* Derivatives of the traction after an increment by displacements along x, along y and around the centre, and by
 * opening. Ranges whose contact changes are differentiated by differences over a step [m]. `trial_force` is room for
 * slider forces. */
void foundation_traction_derivatives(const Foundation *f, const PatchIncrement *path, double step,
                                     double *const trial_force[2], SliderWork *work, double derivatives[4][3]);
/* Tangential stiffness [Pa/m] of a patch while all its sliders stick. */
double stick_stiffness(const Foundation *foundation, const PatchState *state);
/* Update of a patch while all its sliders stick, from the traction at the start; false: the displacement exceeds
 * FULL_STICK_OVER_GROSS_SLIP_DISPLACEMENT, so sliders may slip. */
bool full_stick_update(const Foundation *foundation, const PatchIncrement *path, const double traction[3],
                       SliderUpdate *update);
/* Rate of `full_stick_update`, from rates of the increment, on the side to which `direction` points; true: the
 * increment ends at a corner, where the other side has another rate. */
bool full_stick_rates(const Foundation *foundation, const PatchIncrement *path, const double traction[3],
                      const IncrementRate *direction, const IncrementRate *rates, SliderUpdate *rate);
/* Distribute a traction of full stick to the sliders, by stiffness. */
void distribute_stick_force(const Foundation *foundation, const PatchState *state, const double traction[3],
                            double *const force[2]);
/* Rate of the update by `foundation_advance`; arguments and result are as for `full_stick_rates`. */
bool foundation_rates(const Foundation *foundation, const PatchIncrement *path, const IncrementRate *direction,
                      const IncrementRate *rates, SliderUpdate *rate);

#endif
