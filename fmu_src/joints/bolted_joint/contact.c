#include "contact.h"

#include <math.h>

#include "optimize_for_size.h"
#include "dense.h"

_Static_assert(N_LAW_STATE == 2, "plastic and elastic work");

/* Pressure transfer */

void transfer_pressure(const Contact *contact, const double *points, double *patches)
{
    for (int j = 0, e = 0; j < n_patches(); j++) {
        double even = 0.0, odd = 0.0;
        for (; e + 1 < contact->transfer_end[j]; e += 2) {
            even += contact->pressure_transfer[e] * points[data.pressure_transfer[e][TRANSFER_POINT]];
            odd += contact->pressure_transfer[e + 1] * points[data.pressure_transfer[e + 1][TRANSFER_POINT]];
        }
        for (; e < contact->transfer_end[j]; e++)
            even += contact->pressure_transfer[e] * points[data.pressure_transfer[e][TRANSFER_POINT]];
        patches[j] = even + odd;
    }
}

static inline double point_approach(const Contact *contact, const double *elastic_opening, int i, const double *q)
{
    return contact->preload.approach[i] - (opening_at(data.points[i], q) + elastic_opening[i]);
}

/* Approach of a patch whose points are all open: the approach of the nearest point. */
static double open_approach(const Contact *contact, const double *elastic_opening, int j, const double *q)
{
    double nearest = -INFINITY;
    for (int e = 0; e < (int)data.n_pressure_transfer; e++)
        if (data.pressure_transfer[e][TRANSFER_PATCH] == j)
            nearest = fmax(nearest,
                           point_approach(contact, elastic_opening, data.pressure_transfer[e][TRANSFER_POINT], q));
    return fmin(nearest, contact->curve->start.x);
}

/* Invert the curve: approaches at n pressures, which are replaced by the exact pressures at these approaches.
 * `leave_out_open`: the approach of an open patch is not changed. */
static void invert_curve(const Curve *curve, int n, bool leave_out_open, double *pressure, double *approach)
{
    int segment[MAX_POINTS > MAX_PATCHES ? MAX_POINTS : MAX_PATCHES] = {0};
    for (int i = 0; i < n && ELASTIC; i++) /* in a loop of its own: independent searches overlap */
        segment[i] = pressure[i] < curve->end.y ? curve_find_segment_of_load(curve, pressure[i]) : 0;
    for (int i = 0; i < n; i++)
        if (!leave_out_open || pressure[i] > 0.0)
            approach[i] = curve_inverse(curve, pressure[i], &segment[ELASTIC ? i : 0], &pressure[i]);
}

void evaluate_patches(Contact *contact, const double *elastic_opening, const double *q)
{
    if (ELASTIC) {
        double transferred[MAX_PATCHES];
        transfer_pressure(contact, contact->pressure, transferred);
        for (int j = 0; j < n_patches(); j++)
            if (!(transferred[j] > 0.0))
                contact->patch_approach[j] = open_approach(contact, elastic_opening, j, q);
        invert_curve(contact->curve, n_patches(), true, transferred, contact->patch_approach);
        return;
    }
    NOT_VECTORIZED
    for (int j = 0; j < n_patches(); j++)
        contact->patch_approach[j] = contact->preload.patch_approach[j] - opening_at(data.patches[j], q);
}

/* Preload state */

/* Approaches and pressures of n points or patches, from the bolt pressures. */
static void preload_rows(const Contact *contact, int n, const double *points, int columns, const double bolts[2],
                         double *approach, double *pressure)
{
    for (int i = 0; i < n; i++) {
        const double *point = points + i * columns;
        const double x[4] = {point[PRELOAD_PRESSURE_RATIO], point[MOMENT_PRESSURE_RATIO], bolts[0], bolts[1]};
        superposed_pressure(x, contact->c, &pressure[i]);
    }
    invert_curve(contact->curve, n, false, pressure, approach);
}

bool set_preload_state(Contact *contact, double preload, double moment)
{
    PreloadState *state = &contact->preload;
    if (state->is_current && state->preload == preload && state->moment == moment)
        return false;
    double bolts[2], patch_pressure[MAX_PATCHES];
    bolt_pressures((const double[]){preload, moment}, contact->c, bolts);
    preload_rows(contact, n_points(), data.points[0], sizeof data.points[0] / sizeof(double), bolts, state->approach,
                 state->pressure);
    if (ELASTIC) {
        transfer_pressure(contact, state->pressure, patch_pressure);
        invert_curve(contact->curve, n_patches(), false, patch_pressure, state->patch_approach);
    } else {
        preload_rows(contact, n_patches(), data.patches[0], sizeof data.patches[0] / sizeof(double), bolts,
                     state->patch_approach, patch_pressure);
    }
    memset(state->sums, 0, sizeof state->sums);
    for (int i = 0; i < n_points(); i++)
        for (int d = 0; d < 3; d++)
            state->sums[d] += contact->weight[i][d] * state->pressure[i];
    state->preload = preload;
    state->moment = moment;
    state->is_current = true;
    return true;
}

/* Points */

bool state_outside(const Contact *contact, double approach, int order, double *y, double *works, double *slopes,
                   Text *reason)
{
    const Curve *curve = contact->curve;
    curve_evaluate(curve, approach, order, y);
    if (approach >= curve->end.x) {
        if (!evaluate_law_state(&contact->spots, contact->c, y[0], contact->law.last_log_area, works, slopes, reason))
            return false;
        for (int w = 0; w < N_LAW_STATE; w++)
            slopes[w] *= y[1];
        return true;
    }
    for (int w = 0; w < N_LAW_STATE; w++) {
        works[w] = state_polynomial(curve, 0, w)[0];
        slopes[w] = 0.0;
    }
    return true;
}

/* Number of points evaluated together: the segments of all are found first, so that independent searches overlap. */
enum { POINT_BATCH = 32 };
typedef struct {
    double p[POINT_BATCH], k[POINT_BATCH], works[POINT_BATCH][N_LAW_STATE];
} PointBatch;

static inline bool evaluate_batch(const Contact *contact, const double *elastic_opening, const double *q, int first,
                                  int n, bool with_work, PointBatch *batch, Text *reason)
{
    const Curve *curve = contact->curve;
    const Segment *segments = curve->segments;
    const double begin = curve->start.x, end = curve->end.x;
    double approach[POINT_BATCH], at[POINT_BATCH];
    int segment[POINT_BATCH];
    for (int i = 0; i < n; i++) {
        const double x = point_approach(contact, elastic_opening, first + i, q);
        approach[i] = x;
        const double inside = x < begin ? begin : (x < end ? x : begin);
        segment[i] = curve_find_segment(curve, inside);
        at[i] = segment_parameter(curve, segment[i], inside);
    }
    for (int i = 0; i < n; i++) {
        const int k = segment[i];
        const double t = at[i], *a = segments[k].coefficients;
        batch->p[i] = polynomial_value(a, t);
        batch->k[i] = polynomial_slope(a, t) * segments[k].inverse_length;
        for (int w = 0; w < N_LAW_STATE && with_work; w++)
            batch->works[i][w] = polynomial_value(state_polynomial(curve, k, w), t);
    }
    for (int i = 0; i < n; i++) {
        double y[2], slopes[N_LAW_STATE];
        if (approach[i] >= begin && approach[i] < end)
            continue;
        if (!state_outside(contact, approach[i], 1, y, batch->works[i], slopes, reason))
            return false;
        batch->p[i] = y[0];
        batch->k[i] = y[1];
    }
    return true;
}

bool evaluate_points(Contact *contact, const double *elastic_opening, const double *q, bool with_work, Text *reason)
{
    PointBatch batch;
    for (int first = 0; first < n_points(); first += POINT_BATCH) {
        const int n = n_points() - first < POINT_BATCH ? n_points() - first : POINT_BATCH;
        if (!evaluate_batch(contact, elastic_opening, q, first, n, with_work, &batch, reason))
            return false;
        memcpy(contact->pressure + first, batch.p, (size_t)n * sizeof *batch.p);
        memcpy(contact->stiffness + first, batch.k, (size_t)n * sizeof *batch.k);
        if (with_work)
            memcpy(contact->work + first, batch.works, (size_t)n * sizeof *batch.works);
    }
    return true;
}

OPTIMIZE_FOR_SIZE

void contact_tabulate(Contact *contact)
{
    contact->preload.is_current = false;
    for (int i = 0; i < n_points(); i++) {
        const double share = data.points[i][SHARE], x = data.points[i][POSITION_X], y = data.points[i][POSITION_Y];
        const double weight[6] = {share, share * x, share * y, share * y * y, share * x * x, share * x * y};
        memcpy(contact->weight[i], weight, sizeof weight);
    }
    for (int e = 0; e < (int)data.n_pressure_transfer && ELASTIC; e++) {
        const int16_t *row = data.pressure_transfer[e];
        const int j = row[TRANSFER_PATCH], i = row[TRANSFER_POINT];
        contact->pressure_transfer[e] =
            row[TRANSFER_SHARE] / TRANSFER_SCALE * data.points[i][SHARE] / data.patches[j][SHARE];
        contact->transfer_end[j] = e + 1;
    }
}

/* Rates */

double preload_approach_rate(const Contact *contact, const double *point, const double bolts[4], double approach,
                             double *stiffness)
{
    const double x[6] = {point[PRELOAD_PRESSURE_RATIO], point[MOMENT_PRESSURE_RATIO], bolts[0], bolts[1],
                         bolts[2], bolts[3]};
    double rate, y[2];
    *stiffness = 0.0;
    if (bolts[2] == 0.0 && bolts[3] == 0.0)
        return 0.0;
    superposed_pressure_seed(x, contact->c, &rate);
    curve_evaluate(contact->curve, approach, 1, y);
    *stiffness = y[1];
    return y[1] > 0.0 ? rate / y[1] : 0.0;
}

bool evaluate_derivatives(Contact *contact, const double *elastic_opening, const double *q, Text *reason)
{
    for (int i = 0; i < n_points(); i++) {
        PointRate *rate = &contact->rate[i];
        const double approach = point_approach(contact, elastic_opening, i, q);
        double works[N_LAW_STATE];
        if (!point_state(contact, approach, 4, rate->derivatives, works, rate->work_slope, reason))
            return false;
    }
    return true;
}

void set_point_rates(Contact *contact, const double *elastic_opening_rate, const double *q_rate, const double bolts[4])
{
    for (int i = 0; i < n_points(); i++) {
        PointRate *rate = &contact->rate[i];
        const double *point = data.points[i], approach = contact->preload.approach[i];
        rate->preload_approach = preload_approach_rate(contact, point, bolts, approach, &rate->preload_stiffness);
        rate->approach = rate->preload_approach - (opening_at(point, q_rate) + elastic_opening_rate[i]);
    }
}

END_OPTIMIZE_FOR_SIZE
