/* Repeats `BoltedJointSpring.evolve` of the package: the sums over nodes and patches; the laws in it are
 * generated. */
#include "bolts.h"
#include "whole.h"

#include <math.h>
#include <string.h>

#include "optimize_for_size.h"
#include "tabulated_joint.h"
#include "simd.h"

enum { /* places of the inputs */
    PRELOAD = INPUT_PRELOAD,
    MOMENT = INPUT_MOMENT,
    S_REL = INPUT_S_REL_X,
    V_REL = INPUT_V_REL_X,
    THETA = INPUT_THETA_X,
    OMEGA = INPUT_OMEGA_X
};
_Static_assert((int)MOMENT == (int)PRELOAD + 1, "the arguments of bolt_pressures");
_Static_assert(SUM_NORMAL_X == SUM_NORMAL + 1 && SUM_NORMAL_Y == SUM_NORMAL + 2, "as Kind.sums");
_Static_assert(SUM_TANGENT_Y == SUM_TANGENT_X + 1 && SUM_TANGENT_Z == SUM_TANGENT_X + 2, "in this order");
_Static_assert(N_LAW_STATE == 2 && SUM_ELASTIC == SUM_PLASTIC + 1, "plastic and elastic work");
_Static_assert((int)HISTORY_APART == (int)HISTORY_FORCE + MAX_PATCHES * 2 * FOUNDATION_SLIDERS, "room for all patches");
_Static_assert((int)HISTORY_AMPLITUDE == (int)HISTORY_APART + 3 && (int)HISTORY_TANGENT == (int)HISTORY_AMPLITUDE + MODES &&
                   (int)N_HISTORY == (int)HISTORY_TANGENT + 6 * MAX_PATCHES,
               "as the key of Kind");

static inline int n_nodes(void)
{
    return (int)data.n_nodes;
}

static inline int n_patches(void)
{
    return (int)data.n_patches;
}

/* Whether friction remembers, as elastic sides ask for. */
static inline bool remembers(const Joint *joint)
{
    return ELASTIC || joint->model.memory;
}

static bool tabulate(Joint *joint, int steps, Text *reason)
{
    JointModel *model = &joint->model;
    return tabulate_approach(&model->approach, &joint->curve, &model->spots, joint->constants, steps, reason);
}

/* Lay the heights of a patch, where they do not stand so; its points are found again. */
static void lay(JointModel *model, int j, double reference, double lowest)
{
    Foundation *f = &model->foundation[j];
    if (f->reference == reference && f->lowest == lowest)
        return;
    if (f->reference != reference)
        foundation_lay(f, reference);
    foundation_lower(f, lowest);
    foundation_find(f, &model->from[j]);
    foundation_find(f, &model->to[j]);
}

bool tabulate_model(Joint *joint, Text *reason)
{
    JointModel *model = &joint->model;
    double head[7];
    model->tight = false;
    if (!set_spot_distribution(&model->spots, joint->constants, reason) || !refine_curve(joint, tabulate, APPROACH_STEPS, reason))
        return false;
    joint_head(0, joint->constants, head);
    model->memory = head[0] != 0.0;
    model->mu = head[1];
    model->ratio = head[2];
    model->area = head[3];
    model->bolt = head[4];
    model->bolt_count = head[6] / (double)data.n_bolts;
    model->begin.known = model->end.known = false;
    if (ELASTIC && (!model->memory || head[5] != 0.0)) {
        text_append(reason, model->memory ? "damping = true beside sides = elastic: expected false, the dashpots stand between rigid sides"
                                   : "memory = false beside sides = elastic: expected true, elastic sides go with friction that remembers");
        return false;
    }
    model->work.abreast.use_avx = has_avx();
    whole_begin(model);
    tabulate_energy(&model->energy, &joint->curve);
    for (int i = 0; i < n_nodes(); i++) {
        const double share = data.nodes[i][SHARE], x = data.nodes[i][PLACE_X], y = data.nodes[i][PLACE_Y];
        const double weight[6] = {share, share * x, share * y, share * y * y, share * x * x, share * x * y};
        memcpy(model->weight[i], weight, sizeof weight);
    }
    for (int j = 0; j < n_patches(); j++) {
        Foundation *f = &model->foundation[j];
        f->curve = &joint->curve;
        f->energy = &model->energy;
        f->mu = model->mu;
        f->ratio = model->ratio;
        f->turning[0] = data.turning[0];
        f->turning[1] = data.turning[1];
        f->offset = data.offsets[j][0];
        foundation_lay(f, 0.0);
        model->from[j] = model->to[j] = foundation_point(f, f->curve->end.x, 0);
    }
    return true;
}

/* Tightening */

static double tighten_point(const Joint *joint, const double *point, const double *bolts, int *segment, double *p)
{
    const double x[4] = {point[EQUAL], point[TILT], bolts[0], bolts[1]};
    double pressure;
    shaped_pressure(x, joint->constants, &pressure);
    return curve_inverse(&joint->curve, pressure, segment, p);
}

/* Approaches at tightening; kept while preload and moment stay. */
static void tighten(Joint *joint, const double *inputs)
{
    JointModel *model = &joint->model;
    if (model->tight && model->preload == inputs[PRELOAD] && model->moment == inputs[MOMENT])
        return;
    double bolts[2], carried;
    int segment = 0;
    bolt_pressures(inputs + PRELOAD, joint->constants, bolts);
    memset(model->sums, 0, sizeof model->sums);
    for (int i = 0; i < n_nodes(); i++) {
        const double *node = data.nodes[i];
        model->start[i] = tighten_point(joint, node, bolts, &segment, &model->tightened[i]);
        for (int d = 0; d < 3; d++)
            model->sums[d] += model->weight[i][d] * model->tightened[i];
    }
    for (int j = 0; j < n_patches() && !ELASTIC; j++)
        model->patch_start[j] = tighten_point(joint, data.patches[j], bolts, &segment, &carried);
    if (ELASTIC)
        whole_approach(joint, model->tightened, NULL, model->patch_start);
    bolts_tighten(joint, inputs);
    model->preload = inputs[PRELOAD];
    model->moment = inputs[MOMENT];
    model->tight = true;
    model->pressed = false;
}

/* Rate of a point's approach at tightening along a seed of preload and moment. */
static double tightening_rate(const Joint *joint, const double *point, const double *bolts, double start)
{
    const double x[6] = {point[EQUAL], point[TILT], bolts[0], bolts[1], bolts[2], bolts[3]};
    double rate, y[2];
    if (bolts[2] == 0.0 && bolts[3] == 0.0)
        return 0.0;
    shaped_pressure_seed(x, joint->constants, &rate);
    curve_evaluate(&joint->curve, start, 1, y);
    return y[1] > 0.0 ? rate / y[1] : 0.0;
}

static inline double along_x(const double *point, const double *v)
{
    return v[S_REL] - v[THETA + 2] * point[PLACE_Y];
}

static inline double along_y(const double *point, const double *v)
{
    return v[S_REL + 1] + v[THETA + 2] * point[PLACE_X];
}

/* Nodes */

/* Pressure with its derivatives up to an order at an approach, works of first loading and their slopes. */
static inline bool node_at(const Joint *joint, double approach, int order, double *y, double *works, double *slopes,
                           Text *reason)
{
    const JointModel *model = &joint->model;
    const Curve *curve = &joint->curve;
    if (approach >= curve->start.x && approach < curve->end.x) {
        const int segment = curve_find_segment(curve, approach);
        const double t = (approach - curve->x[segment]) * curve->inverse_length[segment];
        segment_derivatives(curve, segment, t, order, y);
        interpolate_law_state(&model->approach, curve, segment, t, works, slopes);
        return true;
    }
    curve_evaluate(curve, approach, order, y);
    if (approach >= curve->end.x) {
        if (!evaluate_law_state(&model->spots, joint->constants, y[0], model->approach.last_log_area, works, slopes, reason))
            return false;
        for (int q = 0; q < N_LAW_STATE; q++)
            slopes[q] *= y[1];
        return true;
    }
    for (int q = 0; q < N_LAW_STATE; q++) {
        works[q] = model->approach.state_polynomial[0][q][0];
        slopes[q] = 0.0;
    }
    return true;
}

/* Add what a node has to the sums of its normal side: pressure and stiffness, with what shear adds. */
static inline void add_normal(double *x, const double *node, double p, double k, double lifted, double stiffer)
{
    const double share = node[SHARE], px = node[PLACE_X], py = node[PLACE_Y];
    const double pressure = share * p, stiffness = share * k, all = share * (p + lifted);
    const double normal = share * (k + stiffer);
    x[SUM_NORMAL] += all;
    x[SUM_NORMAL_X] += all * px;
    x[SUM_NORMAL_Y] += all * py;
    x[SUM_NORMAL_STIFFNESS] += normal;
    x[SUM_NORMAL_ABOUT_X] += normal * py * py;
    x[SUM_NORMAL_ABOUT_Y] += normal * px * px;
    x[SUM_PRESSURE] += pressure;
    x[SUM_STIFFNESS] += stiffness;
    x[SUM_STIFFNESS_X] += stiffness * px;
    x[SUM_STIFFNESS_Y] += stiffness * py;
    x[SUM_ABOUT_X] += stiffness * py * py;
    x[SUM_ABOUT_Y] += stiffness * px * px;
    x[SUM_ABOUT_XY] += stiffness * px * py;
}

static inline void add_traction(double *x, const double *point, const double *traction)
{
    const double share = point[SHARE], px = point[PLACE_X], py = point[PLACE_Y];
    x[SUM_TRACTION_X] += share * traction[0];
    x[SUM_TRACTION_Y] += share * traction[1];
    x[SUM_TORSION] += share * (px * traction[1] - py * traction[0]);
}

/* xx, xy, yy of a point for a shift along x, along y and a turn. */
static inline void for_motions(const double *point, const double *tangent, double *motions)
{
    const double share = point[SHARE], px = point[PLACE_X], py = point[PLACE_Y];
    motions[0] = share * tangent[0];
    motions[1] = share * tangent[2];
    motions[2] = share * (py * py * tangent[0] - 2.0 * px * py * tangent[1] + px * px * tangent[2]);
}

/* Add a shear traction and its derivatives xx, xy, yy in the shift. */
static inline void add_shear(double *x, const double *point, const double *traction, const double *tangent)
{
    double motions[3];
    add_traction(x, point, traction);
    for_motions(point, tangent, motions);
    for (int d = 0; d < 3; d++)
        x[SUM_TANGENT_X + d] += motions[d];
}

/* The same of a patch, with what its sliders have around its centre. */
static inline void add_patch(double *x, const double *patch, const double traction[3])
{
    add_traction(x, patch, traction);
    x[SUM_TORSION] += patch[SHARE] * (patch[RADIUS] * traction[2]);
}

static inline void for_patch(const double *patch, const double tangent[6], double *motions)
{
    const double share = patch[SHARE], radius = patch[RADIUS];
    for_motions(patch, tangent, motions);
    motions[2] += share * (2.0 * radius * (patch[PLACE_X] * tangent[4] - patch[PLACE_Y] * tangent[3]) +
                           radius * radius * tangent[5]);
}

/* Sums over the patches for `further_tangent` of the package: of all that stick, of what those at their limits miss,
 * and this with the sign by which the traction goes along the motion. */
typedef struct {
    double stick[3], spent[3], along[3];
} Further;

static inline void add_further(Further *sum, const double *patch, double stick, const double *tangent,
                               const double *traction)
{
    const double px = patch[PLACE_X], py = patch[PLACE_Y];
    const double t[3] = {traction[0], traction[1], px * traction[1] - py * traction[0]};
    const double all[6] = {stick, 0.0, stick, 0.0, 0.0, stick};
    double sticks[3], spent[3], centred[3], less[6];
    for (int d = 0; d < 6; d++)
        less[d] = all[d] - tangent[d];
    for_patch(patch, all, sticks);
    for_patch(patch, less, spent);
    for_motions(patch, less, centred); /* around its centre as many slip on either way */
    for (int d = 0; d < 3; d++) {
        sum->stick[d] += sticks[d];
        sum->spent[d] += spent[d];
        sum->along[d] += t[d] < 0.0 ? -centred[d] : centred[d];
    }
}

/* The tangents of a further motion, each in the direction in which more slips on; or rates of them. */
static inline void tell_further(const Further *sum, const double *along, double *x)
{
    for (int d = 0; d < 3; d++)
        x[SUM_TANGENT_X + d] = sum->stick[d] - 0.5 * (sum->spent[d] + (along[d] < 0.0 ? -sum->along[d] : sum->along[d]));
}

enum { LIFTED = 5, STIFFER, N_ELASTIC };              /* results of `elastic_shear`: traction, tangent, then these */
enum { E_LIMIT, E_CURVE, E_SHIFT = E_CURVE + 4, N_E = E_SHIFT + 2 }; /* its arguments */

static void elastic_arguments(const Joint *joint, int i, const double *y, const double *inputs, double *x)
{
    x[E_LIMIT] = joint->model.mu * joint->model.tightened[i];
    memcpy(x + E_CURVE, y, 4 * sizeof *x);
    x[E_SHIFT] = along_x(data.nodes[i], inputs);
    x[E_SHIFT + 1] = along_y(data.nodes[i], inputs);
}

/* Pressure, stiffness and works of first loading of a node beside the table. */
static bool node_outside(const Joint *joint, double approach, double *p, double *k, double *works, Text *reason)
{
    double y[2], all[N_LAW_STATE], slopes[N_LAW_STATE];
    if (!node_at(joint, approach, 1, y, all, slopes, reason))
        return false;
    *p = y[0];
    *k = y[1];
    memcpy(works, all, sizeof all);
    return true;
}

/* Some nodes, looked up before they are summed up: all segments first, so that one does not wait for another. */
enum { BATCH = 32 };
typedef struct {
    double p[BATCH], k[BATCH], works[BATCH][N_LAW_STATE];
} Batch;

static inline bool look_up(const Joint *joint, const double *inputs, int first, int n, bool works, Batch *batch,
                           Text *reason)
{
    const Curve *curve = &joint->curve;
    const double begin = curve->start.x, end = curve->end.x;
    double approach[BATCH], at[BATCH];
    int segment[BATCH];
    for (int i = 0; i < n; i++) {
        const double x = joint->model.start[first + i] -
                         (apart_at(data.nodes[first + i], inputs) + joint->model.opened[first + i]);
        approach[i] = x;
        const double inside = x < begin ? begin : (x < end ? x : begin);
        segment[i] = curve_find_segment(curve, inside);
        at[i] = (inside - curve->x[segment[i]]) * curve->inverse_length[segment[i]];
    }
    for (int i = 0; i < n; i++) {
        const int k = segment[i];
        const double t = at[i], *a = curve->coefficients[k];
        batch->p[i] = polynomial_value(a, t);
        batch->k[i] = polynomial_slope(a, t) * curve->inverse_length[k];
        for (int q = 0; q < N_LAW_STATE && works; q++)
            batch->works[i][q] = polynomial_value(joint->model.approach.state_polynomial[k][q], t);
    }
    for (int i = 0; i < n; i++)
        if (!(approach[i] >= begin && approach[i] < end) &&
            !node_outside(joint, approach[i], &batch->p[i], &batch->k[i], batch->works[i], reason))
            return false;
    return true;
}

/* Pressure and stiffness of the nodes; false: one is beyond the law. */
static bool press_nodes(Joint *joint, const double *inputs, Text *reason)
{
    JointModel *model = &joint->model;
    Batch batch;
    for (int first = 0; first < n_nodes(); first += BATCH) {
        const int n = n_nodes() - first < BATCH ? n_nodes() - first : BATCH;
        if (!look_up(joint, inputs, first, n, false, &batch, reason))
            return false;
        memcpy(model->p + first, batch.p, (size_t)n * sizeof *model->p);
        memcpy(model->k + first, batch.k, (size_t)n * sizeof *model->k);
    }
    return true;
}

/* Sums over the nodes, without what shear adds; false: one is beyond the law. */
static bool sum_nodes(Joint *joint, const double *inputs, Text *reason)
{
    JointModel *model = &joint->model;
    double force[3] = {0.0}, stiffness[6] = {0.0}, work[N_LAW_STATE] = {0.0}, largest = 0.0, *x = model->normal;
    Batch batch;
    for (int first = 0; first < n_nodes(); first += BATCH) {
        const int n = n_nodes() - first < BATCH ? n_nodes() - first : BATCH;
        if (!look_up(joint, inputs, first, n, true, &batch, reason))
            return false;
        for (int i = 0; i < n; i++) {
            const double *weight = model->weight[first + i], p = batch.p[i];
            model->p[first + i] = p;
            model->k[first + i] = batch.k[i];
            for (int d = 0; d < 3; d++)
                force[d] += weight[d] * p;
            for (int d = 0; d < 6; d++)
                stiffness[d] += weight[d] * batch.k[i];
            for (int q = 0; q < N_LAW_STATE; q++)
                work[q] += weight[0] * batch.works[i][q];
            largest = p > largest ? p : largest;
        }
    }
    model->p_max = largest;
    x[SUM_NORMAL] = x[SUM_PRESSURE] = force[0];
    x[SUM_NORMAL_X] = force[1];
    x[SUM_NORMAL_Y] = force[2];
    x[SUM_NORMAL_STIFFNESS] = x[SUM_STIFFNESS] = stiffness[0];
    x[SUM_STIFFNESS_X] = stiffness[1];
    x[SUM_STIFFNESS_Y] = stiffness[2];
    x[SUM_NORMAL_ABOUT_X] = x[SUM_ABOUT_X] = stiffness[3];
    x[SUM_NORMAL_ABOUT_Y] = x[SUM_ABOUT_Y] = stiffness[4];
    x[SUM_ABOUT_XY] = stiffness[5];
    memcpy(x + SUM_PLASTIC, work, sizeof work);
    return true;
}

/* The normal sums with memory; kept while the sides stay as far apart. */
static bool press(Joint *joint, const double *inputs, Text *reason)
{
    JointModel *model = &joint->model;
    const double apart[3] = {inputs[S_REL + 2], inputs[THETA], inputs[THETA + 1]};
    if (model->pressed && !ELASTIC && memcmp(model->apart, apart, sizeof apart) == 0)
        return true;
    model->pressed = false;
    if (!sum_nodes(joint, inputs, reason))
        return false;
    memcpy(model->apart, apart, sizeof apart);
    model->pressed = true;
    return true;
}

/* All sums over the nodes without memory. */
static bool press_elastic(Joint *joint, const double *inputs, double *x, Text *reason)
{
    JointModel *model = &joint->model;
    double works[N_LAW_STATE], slopes[N_LAW_STATE], y[4], at[N_E], e[N_ELASTIC];
    model->p_max = 0.0;
    for (int i = 0; i < n_nodes(); i++) {
        const double approach = model->start[i] - apart_at(data.nodes[i], inputs);
        if (!node_at(joint, approach, 3, y, works, slopes, reason))
            return false;
        elastic_arguments(joint, i, y, inputs, at);
        elastic_shear(at, joint->constants, e);
        add_normal(x, data.nodes[i], y[0], y[1], e[LIFTED], e[STIFFER]);
        add_shear(x, data.nodes[i], e, e + 2);
        for (int q = 0; q < N_LAW_STATE; q++)
            x[SUM_PLASTIC + q] += data.nodes[i][SHARE] * works[q];
        model->p_max = y[0] > model->p_max ? y[0] : model->p_max;
    }
    return true;
}

/* Patches */

/* Heights of the patches for a way from the memory that begins at an approach. */
static void lay_from(JointModel *model, int j, const double *memory, double start)
{
    const bool first = memory[HISTORY_STATE] < (double)SLIP_1D;
    const double lowest = memory[HISTORY_LOWEST + j];
    const bool opened = lowest < model->foundation[j].curve->start.x;
    lay(model, j, first ? start : memory[HISTORY_REFERENCE + j], first || opened ? start : fmin(lowest, start));
}

/* The points of the patches at the ends of their paths from the memory to the inputs; before the memory begins it
 * is the shift alone. The last ones are kept where they are still right. */
static void find_points(Joint *joint, const double *inputs, const double *memory)
{
    JointModel *model = &joint->model;
    const bool begun = memory[HISTORY_STATE] != (double)UNKNOWN;
    for (int j = 0; j < n_patches(); j++) {
        Point *from = &model->from[j], *to = &model->to[j];
        const double end = ELASTIC ? model->patch_now[j] : model->patch_start[j] - apart_at(data.patches[j], inputs);
        const double start = begun ? memory[HISTORY_APPROACH + j] : end;
        if (model->moved != FULL_STICK)
            lay_from(model, j, memory, start);
        const Foundation *f = &model->foundation[j];
        if (from->approach != start)
            *from = to->approach == start ? *to : foundation_point(f, start, from->full);
        if (to->approach != end)
            *to = from->approach == end ? *from : foundation_point(f, end, to->full);
    }
}

static inline PatchPath path_of(const Joint *joint, int j, const double *inputs, const double *memory)
{
    const bool spread = joint->model.moved != FULL_STICK && memory[HISTORY_STATE] < (double)SLIP_1D;
    const double *patch = data.patches[j];
    const double *force = spread ? joint->model.spread[j][0] : memory + HISTORY_FORCE + j * 2 * FOUNDATION_SLIDERS;
    const double turn = inputs[THETA + 2] - memory[HISTORY_RIGID + 2];
    const double *bent = joint->model.bent[j], *before = joint->model.bent_before[j];
    const double u = inputs[S_REL] - memory[HISTORY_RIGID] - turn * patch[PLACE_Y] + (bent[0] - before[0]);
    const double v = inputs[S_REL + 1] - memory[HISTORY_RIGID + 1] + turn * patch[PLACE_X] + (bent[1] - before[1]);
    return (PatchPath){.force = {force, force + FOUNDATION_SLIDERS},
                       .from = &joint->model.from[j],
                       .to = &joint->model.to[j],
                       .shift = {u, v, turn * patch[RADIUS] + (bent[2] - before[2])},
                       .straight = joint->model.moved < SLIP_2D};
}

/* The integral of the curve from its beginning, the load and its slope. */
static inline double energy_at(const Joint *joint, double x, double *y)
{
    const Curve *curve = &joint->curve;
    const double at = x < curve->start.x ? curve->start.x : (x > curve->end.x ? curve->end.x : x);
    const int segment = curve_find_segment(curve, at);
    const double t = (at - curve->x[segment]) * curve->inverse_length[segment], beyond = x - at;
    segment_derivatives(curve, segment, t, 1, y);
    const double whole = segment_energy(&joint->model.energy, curve, segment, t) + beyond * (y[0] + 0.5 * beyond * y[1]);
    y[0] += beyond * y[1];
    return whole;
}

/* The same inside the table, without the slope. */
static inline double energy_near(const Joint *joint, double x, double *load)
{
    const Curve *curve = &joint->curve;
    double y[2];
    if (!(x >= curve->start.x && x < curve->end.x)) {
        const double energy = energy_at(joint, x, y);
        *load = y[0];
        return energy;
    }
    const int segment = curve_find_segment(curve, x);
    const double t = (x - curve->x[segment]) * curve->inverse_length[segment];
    *load = polynomial_value(curve->coefficients[segment], t);
    return segment_energy(&joint->model.energy, curve, segment, t);
}

/* Arguments of `loop` and `short_loop`; those from the amplitude on change a seed. */
enum { L_MU, L_RATIO, L_SIZE, L_LOAD, L_THEN, L_ENERGY, N_LOOP, L_NOW = L_LOAD, L_THERE = L_NOW + 3, N_SHORT = L_THERE + 3 };

/* As `short` of the package. */
static inline bool is_short(const Point *at, double reach)
{
    return reach * at->y[1] < SMALL_CYCLE_RATIO * at->y[0];
}

/* Load with four derivatives at both ends of a reach. */
static inline void both_ends(const Joint *joint, const Point *at, double reach, double now[5], double then[5])
{
    curve_evaluate(&joint->curve, at->approach, 4, now);
    curve_evaluate(&joint->curve, at->approach - reach, 4, then);
}

/* Add the loops whose amplitude is the present shift, see `loop_sums`. */
static void add_loops(const Joint *joint, const double *inputs, double *x)
{
    const double mu = joint->model.mu, ratio = joint->model.ratio, per_reach = ratio / mu;
    double works = 0.0, energies = 0.0;
    for (int j = 0; j < n_patches(); j++) {
        const Point *at = &joint->model.to[j];
        const double u = along_x(data.patches[j], inputs) + joint->model.bent[j][0];
        const double v = along_y(data.patches[j], inputs) + joint->model.bent[j][1];
        const double w = inputs[THETA + 2] * data.patches[j][RADIUS] + joint->model.bent[j][2];
        const double size = sqrt(u * u + v * v + w * w);
        const double reach = size * per_reach;
        double y[2];
        if (is_short(at, reach)) {
            double now[5], then[5];
            both_ends(joint, at, reach, now, then);
            const double given[N_SHORT] = {mu, ratio, size, now[1], now[2], now[3], then[1], then[2], then[3]};
            short_loop(given, NULL, y);
        } else {
            double then;
            const double energy = at->energy - energy_near(joint, at->approach - reach, &then);
            const double given[N_LOOP] = {mu, ratio, size, at->y[0], then, energy};
            loop(given, NULL, y);
        }
        works += data.patches[j][SHARE] * y[0];
        energies += data.patches[j][SHARE] * y[1];
    }
    x[SUM_LOOP_WORK] = works;
    x[SUM_LOOP_ENERGY] = energies;
}

/* Add the rate of the loop of a patch, whose approach, shift along x, y and around its centre have these rates. */
static void add_loop_rate(const Joint *joint, int j, const double *inputs, const double *rates, double *dx)
{
    const double *patch = data.patches[j], *bent = joint->model.bent[j];
    const Point *at = &joint->model.to[j];
    const double u = along_x(patch, inputs) + bent[0], v = along_y(patch, inputs) + bent[1];
    const double w = inputs[THETA + 2] * patch[RADIUS] + bent[2], size = sqrt(u * u + v * v + w * w);
    if (size == 0.0)
        return;
    const double mu = joint->model.mu, ratio = joint->model.ratio, reach = mu / ratio;
    const double grows = (u * rates[1] + v * rates[2] + w * rates[3]) / size, falls = rates[0] - grows / reach;
    double now[5], then[5], y[2], x[2 * N_SHORT - L_SIZE] = {mu, ratio, size};
    both_ends(joint, at, size / reach, now, then);
    if (is_short(at, size / reach)) {
        double *rate = x + N_SHORT;
        rate[0] = grows;
        for (int d = 0; d < 3; d++) {
            x[L_NOW + d] = now[1 + d];
            x[L_THERE + d] = then[1 + d];
            rate[1 + d] = now[2 + d] * rates[0];
            rate[4 + d] = then[2 + d] * falls;
        }
        short_loop_seed(x, NULL, y);
    } else {
        double load[2];
        const double energy = at->energy - energy_at(joint, at->approach - size / reach, load);
        const double rate[N_LOOP - L_SIZE] = {grows, now[1] * rates[0], then[1] * falls,
                                              now[0] * rates[0] - then[0] * falls};
        x[L_LOAD] = now[0];
        x[L_THEN] = then[0];
        x[L_ENERGY] = energy;
        memcpy(x + N_LOOP, rate, sizeof rate);
        loop_seed(x, NULL, y);
    }
    dx[SUM_LOOP_WORK] += patch[SHARE] * y[0];
    dx[SUM_LOOP_ENERGY] += patch[SHARE] * y[1];
}

/* How it has moved after the way to inputs, where it is no longer at rest. */
static int moved_on(const double *inputs, const double *memory)
{
    bool straight = !ELASTIC && memory[HISTORY_STATE] != (double)SLIP_2D && inputs[S_REL + 1] == memory[HISTORY_RIGID + 1] &&
                    inputs[THETA + 2] == memory[HISTORY_RIGID + 2];
    for (int j = 0; j < n_patches() && straight; j++)
        straight = memory[HISTORY_FORCE + (2 * j + 1) * FOUNDATION_SLIDERS] == 0.0 && memory[HISTORY_FORCE + (2 * j + 1) * FOUNDATION_SLIDERS + 1] == 0.0;
    return straight ? SLIP_1D : SLIP_2D;
}

/* The traction of a patch at rest, with that around its centre. */
static inline void resting_traction(const double *memory, int j, double traction[3])
{
    traction[0] = memory[HISTORY_FORCE + 2 * j * FOUNDATION_SLIDERS];
    traction[1] = memory[HISTORY_FORCE + (2 * j + 1) * FOUNDATION_SLIDERS];
    traction[2] = memory[HISTORY_FORCE + (2 * j + 1) * FOUNDATION_SLIDERS + 1];
}

/* All patches after the way if they stay at rest; false: one moves more than hardly. */
static bool rest_all(Joint *joint, const double *inputs, const double *memory, Shear *shears)
{
    bool rests = memory[HISTORY_STATE] < (double)SLIP_1D;
    if (rests) {
        joint->model.moved = FULL_STICK;
        find_points(joint, inputs, memory);
    }
    for (int j = 0; j < n_patches() && rests; j++) {
        const PatchPath path = path_of(joint, j, inputs, memory);
        double before[3];
        resting_traction(memory, j, before);
        rests = foundation_rest(&joint->model.foundation[j], &path, before, &shears[j]);
    }
    return rests;
}

/* How all patches move, with the points of their paths; at rest with their sums. */
static void move_all(Joint *joint, const double *inputs, const double *memory, Shear *shears)
{
    JointModel *model = &joint->model;
    if (rest_all(joint, inputs, memory, shears))
        return;
    model->moved = moved_on(inputs, memory);
    find_points(joint, inputs, memory);
    for (int j = 0; j < n_patches() && memory[HISTORY_STATE] < (double)SLIP_1D; j++) {
        double *const spread[2] = {model->spread[j][0], model->spread[j][1]}, before[3];
        resting_traction(memory, j, before);
        foundation_spread(&model->foundation[j], &model->from[j], before, spread);
    }
}

/* A patch that is not at rest moves: its sums, and the forces of all its sliders, known after `foundations_end`. */
static void slide(Joint *joint, int j, const double *inputs, const double *memory, double *const moved[2], Shear *shear)
{
    JointModel *model = &joint->model;
    const PatchPath path = path_of(joint, j, inputs, memory);
    const int n = 2 * touched_on(&path), n_y = model->moved < SLIP_2D ? 0 : n;
    foundation_move(&model->foundation[j], &path, moved, &model->work, shear);
    memset(moved[0] + n, 0, (size_t)(FOUNDATION_SLIDERS - n) * sizeof *moved[0]);
    memset(moved[1] + n_y, 0, (size_t)(FOUNDATION_SLIDERS - n_y) * sizeof *moved[1]);
}

/* A patch at rest: its force stands in the place of the first slider, that around its centre in y of the second. */
static void keep_at_rest(const Shear *shear, double *const moved[2])
{
    for (int d = 0; d < 2; d++) {
        memset(moved[d], 0, FOUNDATION_SLIDERS * sizeof *moved[d]);
        moved[d][0] = shear->traction[d];
    }
    moved[1][1] = shear->traction[2];
}

/* Sums over the patches, and the memory after the way. */
static void slide_all(Joint *joint, const double *inputs, const double *memory, double *after, double *x)
{
    JointModel *model = &joint->model;
    double heat = 0.0;
    Further sum = {.stick = {0.0}};
    Shear shears[MAX_PATCHES];
    if (remembers(joint)) {
        move_all(joint, inputs, memory, shears);
    } else {
        model->moved = FULL_STICK;
        find_points(joint, inputs, memory);
    }
    for (int j = 0; j < n_patches() && remembers(joint); j++) {
        double *const force = after + HISTORY_FORCE + 2 * j * FOUNDATION_SLIDERS, *const moved[2] = {force, force + FOUNDATION_SLIDERS};
        if (model->moved == FULL_STICK)
            keep_at_rest(&shears[j], moved);
        else
            slide(joint, j, inputs, memory, moved, &shears[j]);
    }
    foundations_end(&model->work);
    for (int j = 0; j < n_patches() && remembers(joint); j++) {
        const Shear shear = shears[j];
        add_patch(x, data.patches[j], shear.traction);
        add_further(&sum, data.patches[j], foundation_stick(&model->foundation[j], &model->to[j]), shear.tangent, shear.traction);
        memcpy(model->traction[j], shear.traction, sizeof shear.traction);
        memcpy(model->tangent[j], shear.tangent, sizeof shear.tangent);
        heat += data.patches[j][SHARE] * shear.loss;
        after[HISTORY_REFERENCE + j] = model->moved == FULL_STICK ? model->to[j].approach : model->foundation[j].reference;
        after[HISTORY_LOWEST + j] = model->moved == FULL_STICK ? model->to[j].approach : model->foundation[j].lowest;
        after[HISTORY_APPROACH + j] = model->to[j].approach;
    }
    if (remembers(joint)) {
        memcpy(model->along, sum.along, sizeof sum.along);
        tell_further(&sum, model->along, x);
    }
    const double loss = memory[HISTORY_LOSS] + model->area * heat;
    x[SUM_LOSS] = loss / model->area;
    after[HISTORY_STATE] = remembers(joint) ? model->moved : UNKNOWN;
    after[HISTORY_LOSS] = loss;
    after[HISTORY_RIGID] = remembers(joint) ? inputs[S_REL] : 0.0;
    after[HISTORY_RIGID + 1] = remembers(joint) ? inputs[S_REL + 1] : 0.0;
    after[HISTORY_RIGID + 2] = remembers(joint) ? inputs[THETA + 2] : 0.0;
}

/* Outputs */

static void fill(const Joint *joint, const double *inputs, double *x)
{
    const JointModel *model = &joint->model;
    memcpy(x + SUM_TIGHTENED, model->sums, sizeof model->sums);
    memcpy(x + X_S_REL, inputs + S_REL, 3 * sizeof *x);
    memcpy(x + X_THETA, inputs + THETA, 3 * sizeof *x);
    memcpy(x + X_RATES, inputs + V_REL, 3 * sizeof *x);
    memcpy(x + X_RATES + 3, inputs + OMEGA, 3 * sizeof *x);
    x[X_P_MAX] = model->p_max;
}

/* Whether the normal side is as tightened: nothing apart, and without memory no shear that would lift. */
static bool as_tightened(const JointModel *model, const double *inputs)
{
    const double *s = inputs + S_REL, *turn = inputs + THETA;
    const bool sheared = s[0] != 0.0 || s[1] != 0.0 || turn[2] != 0.0;
    for (int k = 0; k < MODES && ELASTIC; k++)
        if (model->amplitude[k] != 0.0)
            return false;
    return s[2] == 0.0 && turn[0] == 0.0 && turn[1] == 0.0 && (ELASTIC || model->memory || !sheared);
}

bool joint_press(Joint *joint, const double *inputs, Text *reason)
{
    tighten(joint, inputs);
    if (!press_nodes(joint, inputs, reason))
        return false;
    if (ELASTIC)
        whole_approach(joint, joint->model.p, inputs, joint->model.patch_now);
    return true;
}

bool joint_forces(Joint *joint, const double *inputs, const double *memory, Text *reason)
{
    JointModel *model = &joint->model;
    double *const moved[2] = {model->tried[0], model->tried[1]};
    Shear shears[MAX_PATCHES];
    if (!joint_press(joint, inputs, reason))
        return false;
    move_all(joint, inputs, memory, shears);
    model->work.forces = true;
    for (int j = 0; j < n_patches() && model->moved != FULL_STICK; j++) {
        const PatchPath path = path_of(joint, j, inputs, memory);
        foundation_move(&model->foundation[j], &path, moved, &model->work, &shears[j]);
    }
    foundations_end(&model->work);
    for (int j = 0; j < n_patches(); j++) {
        memcpy(model->traction[j], shears[j].traction, sizeof shears[j].traction);
        memcpy(model->tangent[j], shears[j].tangent, sizeof shears[j].tangent);
    }
    return true;
}

bool joint_try(Joint *joint, const double *inputs, const double *memory, double *after, double *x, Text *reason)
{
    JointModel *model = &joint->model;
    tighten(joint, inputs);
    if (remembers(joint)) {
        if (!press(joint, inputs, reason))
            return false;
        if (ELASTIC)
            whole_approach(joint, model->p, inputs, model->patch_now);
        memcpy(x, model->normal, sizeof model->normal);
    } else if (!press_elastic(joint, inputs, x, reason)) {
        return false;
    }
    if (as_tightened(model, inputs)) { /* the same sums, without the round-off of another order */
        memcpy(x + SUM_NORMAL, model->sums, sizeof model->sums);
        x[SUM_PRESSURE] = model->sums[0];
    }
    slide_all(joint, inputs, memory, after, x);
    return true;
}

static bool sum_up(Joint *joint, const double *inputs, const double *memory, double *after, double *x, Text *reason)
{
    if (ELASTIC) {
        tighten(joint, inputs);
        if (!whole_evaluate(joint, inputs, memory, after, x, reason))
            return false;
    } else {
        if (!joint_try(joint, inputs, memory, after, x, reason))
            return false;
        memset(after + HISTORY_APART, 0, (N_HISTORY - HISTORY_APART) * sizeof *after);
    }
    add_loops(joint, inputs, x);
    if (ELASTIC)
        whole_sums(joint, inputs, x);
    else
        bolts_sums(joint, inputs, x);
    fill(joint, inputs, x);
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *out,
                    Text *reason)
{
    double *x = joint->model.known;
    memset(x, 0, sizeof joint->model.known);
    if (!sum_up(joint, inputs, memory, after, x, reason))
        return false;
    outputs(x, joint->constants, out);
    if (ELASTIC)
        memcpy(out + N_INTERFACE_OUTPUTS, joint->model.bolt_force, (size_t)data.n_stretch * sizeof *out);
    return true;
}

OPTIMIZE_FOR_SIZE

/* Derivatives
 *
 * At a corner they are the mean of both sides; each side has a derivative of its own. */

static const double SAME_PRESSURE = 1e-11; /* of the largest: equal but for round-off and what equilibrium leaves */

/* Rates of the sums over the nodes; those of the patches come from the sliders with memory. */
static bool node_rates(Joint *joint, const double *inputs, const double *seed, const double *bolts, double *dx,
                       Text *reason)
{
    JointModel *model = &joint->model;
    double y[5], works[N_LAW_STATE], slopes[N_LAW_STATE], at[2 * N_E], e[N_ELASTIC] = {0.0};
    double first = 0.0;
    bool found = false;
    for (int i = 0; i < n_nodes(); i++) {
        const double *node = data.nodes[i];
        const double approach = model->start[i] - (apart_at(node, inputs) + model->opened[i]);
        const double tightening = tightening_rate(joint, node, bolts, model->start[i]);
        const double rate = tightening - (apart_at(node, seed) + model->opened_rate[i]);
        double carried[2] = {0.0, 0.0};
        if (tightening != 0.0)
            curve_evaluate(&joint->curve, model->start[i], 1, carried);
        if (!node_at(joint, approach, 4, y, works, slopes, reason))
            return false;
        if (!remembers(joint)) {
            elastic_arguments(joint, i, y, inputs, at);
            at[N_E + E_LIMIT] = model->mu * carried[1] * tightening;
            for (int d = 0; d < 4; d++)
                at[N_E + E_CURVE + d] = y[d + 1] * rate;
            at[N_E + E_SHIFT] = along_x(node, seed);
            at[N_E + E_SHIFT + 1] = along_y(node, seed);
            elastic_shear_seed(at, joint->constants, e);
            add_shear(dx, node, e, e + 2);
        }
        add_normal(dx, node, y[1] * rate, y[2] * rate, e[LIFTED], e[STIFFER]);
        model->pressing[i] = y[1] * rate - carried[1] * tightening;
        model->p_rate[i] = y[1] * rate;
        model->stiffening[i] = y[2] * rate;
        for (int q = 0; q < N_LAW_STATE; q++)
            dx[SUM_PLASTIC + q] += node[SHARE] * slopes[q] * rate;
        const double force = node[SHARE] * carried[1] * tightening;
        dx[SUM_TIGHTENED] += force;
        dx[SUM_TIGHTENED_X] += force * node[PLACE_X];
        dx[SUM_TIGHTENED_Y] += force * node[PLACE_Y];
        if (y[0] < (1.0 - SAME_PRESSURE) * model->p_max)
            continue;
        if (!found) /* of equally large pressures that which grows most, on the other side that which grows least */
            first = dx[X_P_MAX] = y[1] * rate;
        found = true;
        model->corner = model->corner || y[1] * rate != first;
        dx[X_P_MAX] = model->side * fmax(model->side * dx[X_P_MAX], model->side * (y[1] * rate));
    }
    return true;
}

Shear patch_rate(Joint *joint, int j, const double *inputs, const double *memory, const double *after, double rate,
                 const double shift[3])
{
    JointModel *model = &joint->model;
    const Foundation *f = &model->foundation[j];
    const bool first = !after && memory[HISTORY_STATE] == (double)UNKNOWN;
    const PathRate rates = {{first ? rate : 0.0, rate}, {shift[0], shift[1], shift[2]}};
    PathRate towards = model->towards[j];
    towards.ends[0] = first ? towards.ends[1] : 0.0;
    PatchPath path = path_of(joint, j, inputs, memory);
    Shear shear;
    bool corner;
    if (after) { /* a further motion from the place of the last evaluation */
        const double *force = after + HISTORY_FORCE + j * 2 * FOUNDATION_SLIDERS;
        path = (PatchPath){.force = {force, force + FOUNDATION_SLIDERS}, .from = &model->to[j], .to = &model->to[j]};
    }
    if (model->moved == FULL_STICK) {
        double before[3];
        resting_traction(after ? after : memory, j, before);
        corner = foundation_rest_rates(f, &path, before, &towards, &rates, &shear);
    } else {
        path.first = first;
        corner = foundation_rates(f, &path, &towards, &rates, &shear);
    }
    model->corner = model->corner || corner;
    return shear;
}

void patch_slopes(Joint *joint, const double *inputs, const double *memory, double step, Slopes *slope)
{
    JointModel *model = &joint->model;
    double *const tried[2] = {model->tried[0], model->tried[1]};
    if (model->moved == FULL_STICK) { /* where it has hardly moved, the normal force hardly matters */
        for (int j = 0; j < n_patches(); j++)
            slopes_of(model->tangent[j], slope[j]);
        return;
    }
    for (int j = 0; j < n_patches(); j++) {
        const PatchPath path = path_of(joint, j, inputs, memory);
        foundation_slopes(&model->foundation[j], &path, step, tried, &model->work, slope[j]);
    }
}

/* Rates of approach and shift of the patches along a seed. */
static void patch_motions(Joint *joint, const double *seed, const double *bolts, PathRate *motion)
{
    JointModel *model = &joint->model;
    double pressed[MAX_PATCHES];
    if (ELASTIC)
        whole_pressed(model, model->p_rate, pressed);
    for (int j = 0; j < n_patches(); j++) {
        const double *patch = data.patches[j], stiffness = model->to[j].y[1], *bent = model->bent_rate[j];
        const double rate = !ELASTIC          ? tightening_rate(joint, patch, bolts, model->patch_start[j]) - apart_at(patch, seed)
                            : stiffness > 0.0 ? pressed[j] / stiffness
                                              : 0.0;
        motion[j] = (PathRate){{0.0, rate},
                               {along_x(patch, seed) + bent[0], along_y(patch, seed) + bent[1],
                                patch[RADIUS] * seed[THETA + 2] + bent[2]}};
    }
}

/* Let the rates be those on the side to which the patches move. */
static void point_side(JointModel *model, const PathRate *motion)
{
    for (int j = 0; j < n_patches(); j++) {
        model->towards[j].ends[1] = model->side * motion[j].ends[1];
        for (int d = 0; d < 3; d++)
            model->towards[j].shift[d] = model->side * motion[j].shift[d];
    }
}

static void patch_rates(Joint *joint, const double *inputs, const double *memory, const double *after,
                        const PathRate *motion, double *dx)
{
    JointModel *model = &joint->model;
    Further sum = {.stick = {0.0}};
    for (int j = 0; j < n_patches(); j++) {
        const double *patch = data.patches[j], rate = motion[j].ends[1], *shift = motion[j].shift;
        const double loop[4] = {rate, shift[0], shift[1], shift[2]};
        add_loop_rate(joint, j, inputs, loop, dx);
        if (!remembers(joint))
            continue;
        const Shear shear = model->shears[j] = patch_rate(joint, j, inputs, memory, after, rate, shift);
        add_patch(dx, patch, shear.traction);
        add_further(&sum, patch, model->ratio * model->to[j].y[2] * rate, shear.tangent, model->traction[j]);
        dx[SUM_LOSS] += patch[SHARE] * shear.loss;
    }
    if (remembers(joint))
        tell_further(&sum, model->along, dx);
}

enum { MAX_SIDE_ITERATIONS = 20 }; /* until the sliders that slip are those that the motion of the patches lets slip */

/* How the amplitudes of elastic sides follow a seed, on one side of a corner. */
static bool amplitude_rates(Joint *joint, const double *inputs, const double *memory, const double *after,
                            const double *seed, const double *bolts, Text *reason)
{
    JointModel *model = &joint->model;
    double before[MODES];
    PathRate motion[MAX_PATCHES];
    memset(model->towards, 0, sizeof model->towards);
    for (int n = 0; n < MAX_SIDE_ITERATIONS; n++) {
        double unused[N_X] = {0.0};
        memcpy(before, model->amplitude_rate, sizeof before);
        memset(model->opened_rate, 0, sizeof model->opened_rate);
        memset(model->bent_rate, 0, sizeof model->bent_rate);
        if (!node_rates(joint, inputs, seed, bolts, unused, reason))
            return false;
        patch_motions(joint, seed, bolts, motion);
        if (n == 0)
            point_side(model, motion);
        model->corner = false;
        patch_rates(joint, inputs, memory, after, motion, unused);
        whole_rates(joint, inputs, memory, after, seed);
        if (!model->corner || (n > 0 && memcmp(before, model->amplitude_rate, sizeof before) == 0))
            break;
        if (!node_rates(joint, inputs, seed, bolts, unused, reason))
            return false;
        patch_motions(joint, seed, bolts, motion);
        point_side(model, motion);
    }
    return true;
}

/* Derivative along a seed on one side of a corner. */
static bool side_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                            const double *seed, const double *bolts, double *result)
{
    JointModel *model = &joint->model;
    double x[2 * N_X] = {0.0}, *dx = x + N_X;
    PathRate motion[MAX_PATCHES];
    Text ignored;
    text_clear(&ignored);
    memcpy(x, model->known, sizeof model->known);
    if (ELASTIC && !amplitude_rates(joint, inputs, memory, after, seed, bolts, &ignored))
        return false;
    if (!node_rates(joint, inputs, seed, bolts, dx, &ignored))
        return false;
    patch_motions(joint, seed, bolts, motion);
    if (!ELASTIC)
        point_side(model, motion);
    patch_rates(joint, inputs, memory, after, motion, dx);
    if (ELASTIC)
        whole_sum_rates(joint, inputs, seed, dx);
    else
        bolts_sum_rates(joint, seed, dx);
    memcpy(dx + X_S_REL, seed + S_REL, 3 * sizeof *dx);
    memcpy(dx + X_THETA, seed + THETA, 3 * sizeof *dx);
    memcpy(dx + X_RATES, seed + V_REL, 3 * sizeof *dx);
    memcpy(dx + X_RATES + 3, seed + OMEGA, 3 * sizeof *dx);
    outputs_seed(x, joint->constants, result);
    if (ELASTIC)
        whole_bolt_rates(joint, seed, result + N_INTERFACE_OUTPUTS);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    JointModel *model = &joint->model;
    const double at[4] = {inputs[PRELOAD], inputs[MOMENT], seed[PRELOAD], seed[MOMENT]};
    double other[N_OUTPUTS], bolts[4];
    bolt_pressures(at, joint->constants, bolts);
    bolt_pressures_seed(at, joint->constants, bolts + 2);
    bolts_tighten_rates(joint, inputs, seed);
    if (after && model->moved != FULL_STICK) /* as the next way begins */
        for (int j = 0; j < n_patches() && remembers(joint); j++)
            lay_from(model, j, after, model->to[j].approach);
    model->corner = false;
    model->side = 1.0;
    if (!side_derivative(joint, inputs, memory, after, seed, bolts, result) || !model->corner)
        return;
    model->side = -1.0;
    if (!side_derivative(joint, inputs, memory, after, seed, bolts, other))
        return;
    for (int k = 0; k < N_OUTPUTS; k++)
        result[k] = 0.5 * (result[k] + other[k]);
}

END_OPTIMIZE_FOR_SIZE
