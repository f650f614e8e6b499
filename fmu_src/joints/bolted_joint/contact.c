#include "contact.h"

#include <math.h>

#include "cold.h"

_Static_assert(N_LAW_STATE == 2, "plastic and elastic work");

void contact_tabulate(Contact *contact)
{
    contact->preload.is_current = false;
    energy_tabulate(&contact->energy, contact->curve);
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

static inline double point_approach(const Contact *contact, const double *modal_opening, int i, const double *q)
{
    return contact->preload.approach[i] - (opening_at(data.points[i], q) + modal_opening[i]);
}

/* Approach of a patch whose points are all open: that of the nearest one. */
static double open_approach(const Contact *contact, const double *modal_opening, int j, const double *q)
{
    double nearest = -INFINITY;
    for (int e = 0; e < (int)data.n_pressure_transfer; e++)
        if (data.pressure_transfer[e][TRANSFER_PATCH] == j)
            nearest = fmax(nearest,
                           point_approach(contact, modal_opening, data.pressure_transfer[e][TRANSFER_POINT], q));
    return fmin(nearest, contact->curve->first.x);
}

/* Patch approaches at pressures of the points; in the preload state q is NULL, and no patch is open. */
static void set_patch_approach(const Contact *contact, const double *pressure, const double *modal_opening,
                               const double *q, double *approach)
{
    const Curve *curve = contact->curve;
    double transferred[MOST_PATCHES], carried;
    int segment[MOST_PATCHES];
    transfer_pressure(contact, pressure, transferred);
    for (int j = 0; j < n_patches(); j++) /* in a loop of its own: no search waits for another */
        segment[j] = transferred[j] < curve->end.y ? curve_segment_of_load(curve, transferred[j]) : 0;
    for (int j = 0; j < n_patches(); j++)
        approach[j] = !q || transferred[j] > 0.0 ? curve_inverse(curve, transferred[j], &segment[j], &carried)
                                                 : open_approach(contact, modal_opening, j, q);
}

void evaluate_patches(Contact *contact, const double *modal_opening, const double *q)
{
    if (ELASTIC) {
        set_patch_approach(contact, contact->pressure, modal_opening, q, contact->patch_approach);
        return;
    }
    for (int j = 0; j < n_patches(); j++)
        contact->patch_approach[j] = contact->preload.patch_approach[j] - opening_at(data.patches[j], q);
}

/* Preload state */

static double preload_approach(const Contact *contact, const double *point, const double bolts[2], int *segment,
                               double *p)
{
    const double x[4] = {point[PRELOAD_SHAPE], point[MOMENT_SHAPE], bolts[0], bolts[1]};
    double pressure;
    shaped_pressure(x, contact->c, &pressure);
    return curve_inverse(contact->curve, pressure, segment, p);
}

bool set_preload_state(Contact *contact, double preload, double moment)
{
    PreloadState *state = &contact->preload;
    if (state->is_current && state->preload == preload && state->moment == moment)
        return false;
    double bolts[2], carried;
    int segment = 0;
    bolt_pressures((const double[]){preload, moment}, contact->c, bolts);
    memset(state->sums, 0, sizeof state->sums);
    for (int i = 0; i < n_points(); i++) {
        state->approach[i] = preload_approach(contact, data.points[i], bolts, &segment, &state->pressure[i]);
        for (int d = 0; d < 3; d++)
            state->sums[d] += contact->weight[i][d] * state->pressure[i];
    }
    for (int j = 0; j < n_patches() && !ELASTIC; j++)
        state->patch_approach[j] = preload_approach(contact, data.patches[j], bolts, &segment, &carried);
    if (ELASTIC)
        set_patch_approach(contact, state->pressure, NULL, NULL, state->patch_approach);
    state->preload = preload;
    state->moment = moment;
    state->is_current = true;
    return true;
}

/* Points */

/* Pressure with derivatives up to an order at an approach, works of first loading [J] and their derivatives [J/m]. */
static bool point_state(const Contact *contact, double approach, int order, double *y, double *works,
                               double *slopes, Text *why)
{
    const Curve *curve = contact->curve;
    if (approach >= curve->first.x && approach < curve->end.x) {
        const int segment = curve_segment(curve, approach);
        const double t = (approach - curve->x[segment]) * curve->per[segment];
        curve_derivatives(curve, segment, t, order, y);
        approach_state(&contact->law, curve, segment, t, works, slopes);
        return true;
    }
    curve_at(curve, approach, order, y);
    if (approach >= curve->end.x) {
        if (!approach_exact(&contact->spots, contact->c, y[0], contact->law.last, works, slopes, why))
            return false;
        for (int q = 0; q < N_LAW_STATE; q++)
            slopes[q] *= y[1];
        return true;
    }
    for (int q = 0; q < N_LAW_STATE; q++) {
        works[q] = contact->law.state[0][q][0];
        slopes[q] = 0.0;
    }
    return true;
}

/* Pressure, stiffness and works of a point beyond the ends of the table. */
static bool point_outside(const Contact *contact, double approach, double *p, double *k, double *works, Text *why)
{
    double y[2], all[N_LAW_STATE], slopes[N_LAW_STATE];
    if (!point_state(contact, approach, 1, y, all, slopes, why))
        return false;
    *p = y[0];
    *k = y[1];
    memcpy(works, all, sizeof all);
    return true;
}

/* Points that are evaluated together: first all segments, so that no search waits for another. */
enum { POINT_BATCH = 32 };
typedef struct {
    double p[POINT_BATCH], k[POINT_BATCH], works[POINT_BATCH][N_LAW_STATE];
} PointBatch;

static inline bool evaluate_batch(const Contact *contact, const double *modal_opening, const double *q, int first, int n,
                                  bool with_work, PointBatch *batch, Text *why)
{
    const Curve *curve = contact->curve;
    const double begin = curve->first.x, end = curve->end.x;
    double approach[POINT_BATCH], at[POINT_BATCH];
    int segment[POINT_BATCH];
    for (int i = 0; i < n; i++) {
        const double x = point_approach(contact, modal_opening, first + i, q);
        approach[i] = x;
        const double inside = x < begin ? begin : (x < end ? x : begin);
        segment[i] = curve_segment(curve, inside);
        at[i] = (inside - curve->x[segment[i]]) * curve->per[segment[i]];
    }
    for (int i = 0; i < n; i++) {
        const int k = segment[i];
        const double t = at[i], *a = curve->a[k];
        batch->p[i] = curve_value(a, t);
        batch->k[i] = curve_slope(a, t) * curve->per[k];
        for (int w = 0; w < N_LAW_STATE && with_work; w++)
            batch->works[i][w] = curve_value(contact->law.state[k][w], t);
    }
    for (int i = 0; i < n; i++)
        if (!(approach[i] >= begin && approach[i] < end) &&
            !point_outside(contact, approach[i], &batch->p[i], &batch->k[i], batch->works[i], why))
            return false;
    return true;
}

bool evaluate_points(Contact *contact, const double *modal_opening, const double *q, bool with_work, Text *why)
{
    PointBatch batch;
    for (int first = 0; first < n_points(); first += POINT_BATCH) {
        const int n = n_points() - first < POINT_BATCH ? n_points() - first : POINT_BATCH;
        if (!evaluate_batch(contact, modal_opening, q, first, n, with_work, &batch, why))
            return false;
        memcpy(contact->pressure + first, batch.p, (size_t)n * sizeof *batch.p);
        memcpy(contact->stiffness + first, batch.k, (size_t)n * sizeof *batch.k);
        if (with_work)
            memcpy(contact->work + first, batch.works, (size_t)n * sizeof *batch.works);
    }
    return true;
}

bool evaluate_derivatives(Contact *contact, const double *modal_opening, const double *q, int order, Text *why)
{
    for (int i = 0; i < n_points(); i++) {
        PointRate *rate = &contact->rate[i];
        const double approach = point_approach(contact, modal_opening, i, q);
        if (!point_state(contact, approach, order, rate->derivatives, rate->work, rate->work_slope, why))
            return false;
    }
    return true;
}

COLD

/* Rates */

double preload_approach_rate(const Contact *contact, const double *point, const double bolts[4], double approach,
                             double *stiffness)
{
    const double x[6] = {point[PRELOAD_SHAPE], point[MOMENT_SHAPE], bolts[0], bolts[1], bolts[2], bolts[3]};
    double rate, y[2];
    *stiffness = 0.0;
    if (bolts[2] == 0.0 && bolts[3] == 0.0)
        return 0.0;
    shaped_pressure_seed(x, contact->c, &rate);
    curve_at(contact->curve, approach, 1, y);
    *stiffness = y[1];
    return y[1] > 0.0 ? rate / y[1] : 0.0;
}

void set_point_rates(Contact *contact, const double *modal_opening_rate, const double *q_rate, const double bolts[4])
{
    for (int i = 0; i < n_points(); i++) {
        PointRate *rate = &contact->rate[i];
        const double *point = data.points[i], approach = contact->preload.approach[i];
        rate->preload_approach = preload_approach_rate(contact, point, bolts, approach, &rate->preload_stiffness);
        rate->approach = rate->preload_approach - (opening_at(point, q_rate) + modal_opening_rate[i]);
    }
}

END_OF_COLD
