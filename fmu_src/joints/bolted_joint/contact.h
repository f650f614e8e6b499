/* Repeats contact.py of the package: pressure and stiffness of the points at an opening, the preload state, and the
 * transfer of pressure to the patches. Approach 0: end of the closing of the contact, where the contact law begins. At
 * a negative approach the contact is closing, or open. */
#ifndef JOINTFMU_CONTACT_H
#define JOINTFMU_CONTACT_H

#include <stdbool.h>
#include <string.h>

#include "approach.h"
#include "curve.h"
#include "data.h"
#include "kinematics.h"
#include "text.h"

enum { TRANSFER_PATCH, TRANSFER_POINT, TRANSFER_SHARE }; /* columns of `data.pressure_transfer` */

/* Contact state under preload alone, for one preload per bolt [N] and moment [N.m]. */
typedef struct {
    bool is_current;
    double preload, moment;
    double approach[MAX_POINTS], pressure[MAX_POINTS]; /* approach [m] and pressure [Pa] of the points */
    double patch_approach[MAX_PATCHES];                 /* [m] */
    double sums[3]; /* sums over the points of share times pressure [Pa], times pressure and x, and y [N/m] */
} PreloadState;

/* Derivatives at a contact point. By the approach: pressure with four derivatives, derivatives of the works [J/m].
 * Along a seed of preload, moment and q: rate of the approach [m]. In the preload state: stiffness [Pa/m], rate of the
 * approach [m]. */
typedef struct {
    double derivatives[5], work_slope[N_LAW_STATE];
    double approach, preload_stiffness, preload_approach;
} PointRate;

typedef struct {
    const double *c; /* constants of the joint */
    const Curve *curve;
    SpotDistribution spots;
    ApproachTable law; /* law of first loading, tabulated over the approach */
    double area;  /* nominal area of the contact [m2] */
    double weight[MAX_POINTS][6]; /* share of each point, times 1, x, y, y^2, x^2, x y */
    double pressure_transfer[MAX_PRESSURE_TRANSFER]; /* pressure of a patch over that of a point, rows of the data */
    int transfer_end[MAX_PATCHES];                   /* end of the rows of each patch */
    PreloadState preload;
    /* In the last trial: pressure [Pa], stiffness [Pa/m] and work [J] of the points, approach [m] of the patches. */
    double pressure[MAX_POINTS], stiffness[MAX_POINTS], work[MAX_POINTS][N_LAW_STATE];
    double patch_approach[MAX_PATCHES];
    PointRate rate[MAX_POINTS];
} Contact;

/* Shares of the points and pressure transfer, once for a parameter set. */
void contact_tabulate(Contact *contact);
/* Compute the preload state; false: preload and moment are unchanged, so there was nothing to compute. */
bool set_preload_state(Contact *contact, double preload, double moment);
/* Transfer pressures (or stiffnesses, rates) of the points to the patches. */
void transfer_pressure(const Contact *contact, const double *points, double *patches);
/* Pressure and stiffness of the points at a displacement q; `elastic_opening` (n) [m]: opening of the points by the
 * deformation of the members. If `with_work`, also their work [J]. false: refused, with the reason. */
bool evaluate_points(Contact *contact, const double *elastic_opening, const double *q, bool with_work, Text *reason);
/* Patch approach [m] that gives the transferred pressure. If all points of a patch are open: the approach of the
 * nearest point. Between rigid members it follows from q. */
void evaluate_patches(Contact *contact, const double *elastic_opening, const double *q);
/* Set the pressure and work derivatives of all points by their approaches, in `contact->rate`. */
bool evaluate_derivatives(Contact *contact, const double *elastic_opening, const double *q, Text *reason);
/* Rates of the points along a seed; bolt pressures as `bolt_pressures` gives them, with their rates. */
void set_point_rates(Contact *contact, const double *elastic_opening_rate, const double *q_rate, const double bolts[4]);
/* Rate of the approach [m] of a point or patch in the preload state; and the stiffness [Pa/m] there. */
double preload_approach_rate(const Contact *contact, const double *point, const double bolts[4], double approach,
                             double *stiffness);

/* As `point_state`, at approaches beyond the ends of the table. */
bool state_outside(const Contact *contact, double approach, int order, double *y, double *works, double *slopes,
                   Text *reason);

/* Pressure with derivatives up to an order (1 to 4) at an approach, works [J] and their slopes [J/m]. */
static inline bool point_state(const Contact *contact, double approach, int order, double *y, double *works,
                               double *slopes, Text *reason)
{
    const Curve *curve = contact->curve;
    if (!(approach >= curve->start.x && approach < curve->end.x))
        return state_outside(contact, approach, order, y, works, slopes, reason);
    const int segment = curve_find_segment(curve, approach);
    const double t = segment_parameter(curve, segment, approach);
    segment_derivatives(curve, segment, t, order, y);
    interpolate_law_state(curve, segment, t, works, slopes);
    return true;
}

#endif
