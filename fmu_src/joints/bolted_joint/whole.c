#include "whole.h"

#include <math.h>
#include <string.h>

#include "bolts.h"
#include "optimize_for_size.h"
#include "tabulated_joint.h"

enum { MOTIONS = 6 };

/* How far patches come apart by modes and motions in the last trial: as the points that press on them do. */
static void open_patches(JointModel *model)
{
    for (int j = 0, e = 0; j < (int)data.n_patches; j++) {
        const double stiffness = model->to[j].y[1], per = stiffness > 0.0 ? 1.0 / stiffness : 0.0;
        double sum[WIDE] = {0.0};
        for (; e < model->press_end[j]; e++) {
            const int i = data.pressing[e][PAIR_POINT];
            const double by = model->presses[e] * model->k[i] * per;
            for (int k = 0; k < WIDE; k++)
                sum[k] += by * model->opening[i][k];
        }
        memcpy(model->patch[3][j], sum, sizeof sum);
    }
}

void whole_pressed(const JointModel *model, const double *points, double *patches)
{
    for (int j = 0, e = 0; j < (int)data.n_patches; j++) {
        double even = 0.0, odd = 0.0;
        for (; e + 1 < model->press_end[j]; e += 2) {
            even += model->presses[e] * points[data.pressing[e][PAIR_POINT]];
            odd += model->presses[e + 1] * points[data.pressing[e + 1][PAIR_POINT]];
        }
        for (; e < model->press_end[j]; e++)
            even += model->presses[e] * points[data.pressing[e][PAIR_POINT]];
        patches[j] = even + odd;
    }
}

/* The approach of a patch whose points are all open: that of the nearest one. */
static double open_approach(const Joint *joint, int j, const double *inputs)
{
    const JointModel *model = &joint->model;
    double nearest = -INFINITY;
    for (int e = 0; e < (int)data.n_pressing; e++) {
        const int i = data.pressing[e][PAIR_POINT];
        if (data.pressing[e][PAIR_PATCH] == j)
            nearest = fmax(nearest, model->start[i] - (apart_at(data.nodes[i], inputs) + model->opened[i]));
    }
    return fmin(nearest, joint->curve.start.x);
}

void whole_approach(const Joint *joint, const double *pressure, const double *inputs, double *approach)
{
    double pressed[MAX_PATCHES], carried;
    int segment[MAX_PATCHES];
    whole_pressed(&joint->model, pressure, pressed);
    for (int j = 0; j < (int)data.n_patches; j++) /* first, so that one does not wait for another */
        segment[j] = pressed[j] < joint->curve.end.y ? curve_find_segment_of_load(&joint->curve, pressed[j]) : 0;
    for (int j = 0; j < (int)data.n_patches; j++)
        approach[j] = !inputs || pressed[j] > 0.0 ? curve_inverse(&joint->curve, pressed[j], &segment[j], &carried)
                                                  : open_approach(joint, j, inputs);
}

OPTIMIZE_FOR_SIZE

/* Places of the motions of side 2 in the inputs: s_x, s_y, s_z, theta_x, theta_y, theta_z. */
static inline int motion_of(int d)
{
    return d < 3 ? INPUT_S_REL_X + d : INPUT_THETA_X + d - 3;
}

/* A joint with rigid sides has nothing of this: ELASTIC is a constant. */

/* A row of what modes move, as numbers, and three motions beside them. */
static void lay_row(const int16_t *digits, double first, double second, double third, double *row)
{
    const double motions[LANES_OF_MODES] = {first, second, third};
    for (int k = 0; k < (int)data.n_modes; k++)
        row[k] = digits[k] / MODE_DIGITS;
    memcpy(row + MODES, motions, sizeof motions);
}

void whole_begin(JointModel *model)
{
    if (!ELASTIC)
        return;
    for (int k = 0; k < MODES; k++)
        model->bodies[k] = k < (int)data.n_modes ? data.modes[k][0] : 1.0;
    for (int i = 0; i < (int)data.n_opening; i++)
        lay_row(data.opening[i], 1.0, data.nodes[i][PLACE_Y], -data.nodes[i][PLACE_X], model->opening[i]);
    for (int j = 0; j < (int)data.n_patch_x; j++) {
        const double x = data.patches[j][PLACE_X], y = data.patches[j][PLACE_Y];
        lay_row(data.patch_x[j], 1.0, 0.0, -y, model->patch[0][j]);
        lay_row(data.patch_y[j], 0.0, 1.0, x, model->patch[1][j]);
        lay_row(data.patch_around[j], 0.0, 0.0, data.patches[j][RADIUS], model->patch[2][j]);
    }
    for (int b = 0; b < (int)data.n_stretch; b++)
        lay_row(data.stretch[b], 1.0, data.bolts[b][BOLT_Y], -data.bolts[b][BOLT_X], model->stretch[b]);
    for (int e = 0; e < (int)data.n_pressing; e++) {
        const int16_t *pair = data.pressing[e];
        model->presses[e] = pair[PAIR_PART] / TRANSFER_SCALE * data.nodes[pair[PAIR_POINT]][SHARE] / data.patches[pair[PAIR_PATCH]][SHARE];
        model->press_end[pair[PAIR_PATCH]] = e + 1;
    }
}

static inline void add_scaled(double by, const double *restrict row, double *restrict sum)
{
    for (int k = 0; k < MODES; k++)
        sum[k] += by * row[k];
}

void whole_deform(const double *amplitude, const JointModel *model, double *opened, double (*bent)[3])
{
    if (!ELASTIC)
        return;
    const bool use_avx = model->work.abreast.use_avx;
    const int patches = (int)data.n_patch_x;
    for (int d = 0; d < 3; d++)
        dense_dots(use_avx, patches, model->patch[d], amplitude, 3, &bent[0][d]);
    if (opened)
        dense_dots(use_avx, (int)data.n_opening, model->opening, amplitude, 1, opened);
}

/* The stiffness by normal motions beside the modes, up to a size, of points and bolts. */
static void press_all(JointModel *model, int size)
{
    const bool use_avx = model->work.abreast.use_avx;
    const int sizes[2] = {(int)data.n_nodes, (int)data.n_stretch};
    const double(*const rows[2])[WIDE] = {(const double(*)[WIDE])model->opening, (const double(*)[WIDE])model->stretch};
    memset(model->by_normal, 0, sizeof model->by_normal);
    for (int s = 0; s < 2; s++) {
        for (int i = 0; i < sizes[s]; i++)
            model->by[i] = s == 0 ? model->area * data.nodes[i][SHARE] * model->k[i] : model->bolt * model->bolt_pulls[i];
        dense_weigh(use_avx, sizes[s], model->by, rows[s], model->weighted);
        dense_products(use_avx, sizes[s], (const double(*)[WIDE])model->weighted, rows[s], size, false, model->by_normal);
    }
}

/* The same by shear in `by_shear`, of patches by their slopes; all of the matrix or its lower half. */
static void shear_all(JointModel *model, int size, bool all)
{
    const bool use_avx = model->work.abreast.use_avx;
    const int n = (int)data.n_patches;
    const double(*rows[4])[WIDE];
    double by[MAX_PATCHES][4];
    for (int s = 0; s < 4; s++)
        rows[s] = (const double(*)[WIDE])model->patch[s];
    memset(model->by_shear, 0, sizeof model->by_shear);
    for (int d = 0; d < 3; d++) {
        for (int j = 0; j < n; j++)
            for (int s = 0; s < 4; s++)
                by[j][s] = model->area * data.patches[j][SHARE] * model->slope[j][s][d];
        dense_combine(use_avx, n, (const double(*)[4])by, rows, model->weighted);
        dense_products(use_avx, n, (const double(*)[WIDE])model->weighted, rows[d], size, all, model->by_shear);
    }
}

/* Factors of the derivative of the residual by the amplitudes, and what acts beside it up to a size: from the slopes of
 * the patches; all of it or as if it were symmetric. */
static void differentiate(JointModel *model, int size, bool all, Factors *factors)
{
    double(*a)[MODES] = factors->a;
    press_all(model, size);
    shear_all(model, size, all);
    for (int r = 0; r < MODES; r++) {
        for (int k = 0; k <= r; k++) {
            const double normal = model->by_normal[r][k], shear = model->by_shear[r][k];
            a[r][k] = normal + shear;
            a[k][r] = normal + (all ? model->by_shear[k][r] : shear);
        }
        a[r][r] += model->bodies[r];
    }
    dense_factor(model->work.abreast.use_avx, factors);
}

/* Equilibrium */

static inline double stretched(const JointModel *model, int b, const double *v, const double *amplitude)
{
    return seat(b, v) + dense_dot(model->stretch[b], amplitude);
}

/* Gaps, forces and stiffness of the bolts at inputs and amplitudes. */
static void elongate_bolts(JointModel *model, const double *inputs, const double *amplitude)
{
    for (int b = 0; b < (int)data.n_stretch; b++)
        bolt_elongate(model, b, stretched(model, b, inputs, amplitude));
}

/* Residual of the amplitudes, and what of it is round-off. */
static double residual(const Joint *joint, const double *inputs, const double *amplitude, double *r)
{
    const JointModel *model = &joint->model;
    const bool use_avx = model->work.abreast.use_avx;
    double forces = 0.0, stiffness = 0.0, apart = 0.0;
    double normal[MAX_OPENING], shear[3][MAX_PATCHES], bolts[MAX_STRETCH];
    for (int k = 0; k < MODES; k++)
        r[k] = model->bodies[k] * amplitude[k];
    for (int i = 0; i < (int)data.n_nodes; i++) {
        const double weight = model->area * data.nodes[i][SHARE], p = model->p[i], tight = model->tightened[i];
        const double moved = fabs(apart_at(data.nodes[i], inputs));
        normal[i] = -weight * (p - tight);
        forces += weight * (p + tight);
        stiffness += weight * model->k[i];
        apart = moved > apart ? moved : apart;
    }
    for (int j = 0; j < (int)data.n_patches; j++) {
        const double weight = model->area * data.patches[j][SHARE];
        for (int d = 0; d < 3; d++) {
            shear[d][j] = weight * model->traction[j][d];
            forces += fabs(shear[d][j]);
        }
    }
    for (int b = 0; b < (int)data.n_stretch; b++) {
        bolts[b] = model->bolt * (stretched(model, b, inputs, amplitude) + model->bolt_gap[b]);
        forces += fabs(bolts[b]);
    }
    dense_add_rows(use_avx, (int)data.n_nodes, normal, (const double(*)[WIDE])model->opening, r);
    for (int d = 0; d < 3; d++)
        dense_add_rows(use_avx, (int)data.n_patches, shear[d], (const double(*)[WIDE])model->patch[d], r);
    dense_add_rows(use_avx, (int)data.n_stretch, bolts, (const double(*)[WIDE])model->stretch, r);
    return RELATIVE_TOLERANCE * (forces + stiffness * apart * CANCELLATION_RATIO + model->area * model->approach.closing_end_pressure);
}

/* The derivative by what the memory says; in a further motion where that after it is given. */
static void exact(Joint *joint, const double *inputs, const double *memory, const double *after)
{
    JointModel *model = &joint->model;
    static const double units[4][4] = {{0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0, 1.0}, {-1.0}};
    for (int j = 0; j < (int)data.n_patches; j++)
        for (int c = 0; c < 4; c++) {
            const Shear rate = patch_rate(joint, j, inputs, memory, after, units[c][0], units[c] + 1);
            memcpy(model->slope[j][c], rate.traction, sizeof model->slope[j][c]);
        }
    open_patches(model);
    differentiate(model, MODES, true, &model->factors);
}

/* The same at the last trial; what ranges of heights gain that change by differences. */
static void jacobian(Joint *joint, const double *inputs, const double *memory)
{
    JointModel *model = &joint->model;
    double deepest = -joint->curve.start.x; /* where the contact has closed */
    for (int j = 0; j < (int)data.n_patches; j++)
        deepest = fmax(deepest, model->patch_start[j] - joint->curve.start.x);
    patch_slopes(joint, inputs, memory, DIFFERENCE_STEP * deepest, model->slope);
    open_patches(model);
    differentiate(model, MODES, true, &model->factors);
}

/* How the amplitudes follow the motions, in the tangents of points and patches, and the stiffnesses that are left. */
static void follow(JointModel *model, const double (*tangent)[6], Followed *followed)
{
    for (int j = 0; j < (int)data.n_patches; j++)
        slopes_of(tangent[j], model->slope[j]);
    differentiate(model, WIDE, false, &followed->factors);
    for (int d = 0; d < MOTIONS; d++) {
        static const int beside[MOTIONS] = {0, 1, 0, 1, 2, 2};
        const int at = MODES + beside[d];
        const double *h = d < 2 || d == 5 ? model->by_shear[at] : model->by_normal[at];
        double *z = followed->follow[d];
        for (int k = 0; k < MODES; k++)
            z[k] = -h[k];
        dense_solve(model->work.abreast.use_avx, &followed->factors, z);
        model->whole[d] = fmax(h[at] + dense_dot(h, z), 0.0); /* not below by round-off */
    }
    followed->known = true;
}

/* What decides how the amplitudes follow: preload, moment, shift, and the end of the memory. */
static void key_of(const double *inputs, const double *memory, double key[FOLLOW_KEY])
{
    key[0] = inputs[INPUT_PRELOAD];
    key[1] = inputs[INPUT_MOMENT];
    memcpy(key + 2, memory + HISTORY_RIGID, 3 * sizeof *key);
    memcpy(key + 5, memory + HISTORY_APART, (FOLLOW_KEY - 5) * sizeof *key);
}

/* The place after a part of the way from the memory to the inputs. */
static void place(const double *inputs, const double *memory, double part, double *at)
{
    const double first[MOTIONS] = {memory[HISTORY_RIGID], memory[HISTORY_RIGID + 1], memory[HISTORY_APART],
                                   memory[HISTORY_APART + 1], memory[HISTORY_APART + 2], memory[HISTORY_RIGID + 2]};
    memcpy(at, inputs, N_INPUTS * sizeof *at);
    for (int d = 0; d < MOTIONS && part != 1.0; d++)
        at[motion_of(d)] = first[d] + part * (inputs[motion_of(d)] - first[d]);
}

/* The bodies at amplitudes, and the bolts at inputs. */
static void deform(JointModel *model, const double *inputs, const double *amplitude)
{
    elongate_bolts(model, inputs, amplitude);
    memcpy(model->amplitude, amplitude, sizeof model->amplitude);
    whole_deform(amplitude, model, model->opened, model->bent);
}

/* Amplitudes at the end of the way in the tangent of its beginning; less those there are their rate. */
static bool predict(Joint *joint, const double *inputs, const double *memory, double *rate, Text *reason)
{
    JointModel *model = &joint->model;
    double key[FOLLOW_KEY], first[N_INPUTS], tangent[MAX_PATCHES][6];
    key_of(inputs, memory, key);
    place(inputs, memory, 0.0, first);
    if (model->end.known && memcmp(key, model->end.key, sizeof key) == 0) {
        model->begin = model->end;
    } else if (!model->begin.known || memcmp(key, model->begin.key, sizeof key) != 0) {
        deform(model, first, memory + HISTORY_AMPLITUDE);
        if (!joint_press(joint, first, reason))
            return false;
        memcpy(tangent, memory + HISTORY_TANGENT, sizeof tangent);
        for (int j = 0; j < (int)data.n_patches && memory[HISTORY_STATE] == (double)UNKNOWN; j++) {
            const Point at = foundation_point(&model->foundation[j], model->patch_start[j], 0);
            const double stick = foundation_stick(&model->foundation[j], &at);
            const double sticks[6] = {stick, 0.0, stick, 0.0, 0.0, stick};
            memcpy(tangent[j], sticks, sizeof sticks);
        }
        follow(model, (const double(*)[6])tangent, &model->begin);
        memcpy(model->begin.key, key, sizeof key);
    }
    memset(rate, 0, MODES * sizeof *rate);
    for (int d = 0; d < MOTIONS; d++)
        add_scaled(inputs[motion_of(d)] - first[motion_of(d)], model->begin.follow[d], rate);
    return true;
}

typedef struct {
    const double *inputs, *memory;
    double *after, *x;
    bool whole; /* the last trial gave sums and memory too */
} Way;

static bool try_at(Joint *joint, Way *way, const double *at, const double *amplitude, bool whole, Text *reason)
{
    deform(&joint->model, at, amplitude);
    way->whole = whole;
    if (!whole)
        return joint_forces(joint, at, way->memory, reason);
    memset(way->x, 0, N_SUMS * sizeof *way->x);
    return joint_try(joint, at, way->memory, way->after, way->x, reason);
}

static double largest(const double *r)
{
    double most = 0.0;
    for (int k = 0; k < MODES; k++)
        most = fabs(r[k]) > most || !(r[k] == r[k]) ? fabs(r[k]) : most;
    return most;
}

typedef enum { FOUND, LOST, REFUSED } Newton;

/* The newest of some steps since the last derivative as Broyden's (good) update of it has it. */
static void broyden(JointModel *model, int kept)
{
    double(*steps)[MODES] = model->steps, *squares = model->squares;
    double *step = steps[kept];
    for (int i = 0; i + 1 < kept; i++)
        add_scaled(dense_dot(steps[i], step) / squares[i], steps[i + 1], step);
    if (kept > 0) {
        const double by = 1.0 / (1.0 - dense_dot(steps[kept - 1], step) / squares[kept - 1]);
        for (int k = 0; k < MODES; k++)
            step[k] *= by;
    }
    squares[kept] = dense_dot(step, step);
}

/* As `Whole._newton` of the package; where nothing is found with the residual that is missed. */
static Newton newton(Joint *joint, Way *way, double part, double *amplitude, double *missed, Text *reason)
{
    JointModel *model = &joint->model;
    const double close = part == 1.0 ? 1.0 : INTERMEDIATE_TOLERANCE_FACTOR;
    double at[N_INPUTS], r[MODES], least;
    place(way->inputs, way->memory, part, at);
    if (!try_at(joint, way, at, amplitude, false, reason))
        return REFUSED;
    least = residual(joint, at, amplitude, r);
    const Factors *with = &model->begin.factors; /* of the derivative: at first that at the beginning of the way */
    double before = INFINITY;
    bool own = false; /* the derivative is that at the amplitudes */
    for (int n = 0, kept = 0; n < MAX_ITERATIONS; n++) {
        const double left = largest(r);
        if (left <= close * least)
            return FOUND;
        if (!(left < TANGENT_REUSE_RATIO * before)) { /* else the last derivative is still good */
            jacobian(joint, at, way->memory);
            with = &model->factors;
            kept = 0;
            own = true;
        }
        const bool last = part == 1.0 && n > 0 && left < TANGENT_REUSE_RATIO * before && left * left < before * least;
        before = left;
        double begin[MODES], size = 1.0, *step = model->steps[kept];
        for (int k = 0; k < MODES; k++)
            step[k] = -r[k];
        dense_solve(model->work.abreast.use_avx, with, step);
        broyden(model, kept++);
        memcpy(begin, amplitude, sizeof begin);
        const double falls = dense_dot(r, step);
        for (int p = 0; p < MAX_LINE_SEARCH; p++) {
            for (int k = 0; k < MODES; k++)
                amplitude[k] = begin[k] + size * step[k];
            if (!try_at(joint, way, at, amplitude, last, reason))
                return REFUSED;
            least = residual(joint, at, amplitude, r);
            const double rises = dense_dot(r, step);
            if (size == 0.0 || !(rises > 0.5 * fabs(falls)))
                break;
            size *= own ? fmax(falls / (falls - rises), 0.1) : 0.0;
            before = 0.0;
        }
        own = false;
    }
    *missed = largest(r);
    return *missed <= close * least ? FOUND : LOST;
}

static void tell(const double *inputs, double done, double missed, Text *reason)
{
    static const int told[] = {INPUT_PRELOAD, INPUT_MOMENT};
    text_clear(reason);
    for (int v = 0; v < 2 + MOTIONS; v++) {
        const int at = v < 2 ? told[v] : motion_of(v - 2);
        if (inputs[at] == 0.0)
            continue;
        text_append(reason, reason->length > 0 ? ", " : "");
        text_append(reason, variables[FIRST_INPUT + at].name);
        text_append(reason, " = ");
        text_append_number(reason, inputs[at], 6);
    }
    text_append(reason, ": the sides find no equilibrium beyond ");
    text_append_number(reason, done, 3);
    text_append(reason, " of the way, the residual is ");
    text_append_number(reason, missed, 2);
    text_append(reason, " N");
}

bool whole_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *x, Text *reason)
{
    if (!ELASTIC)
        return false;
    JointModel *model = &joint->model;
    Way way = {inputs, memory, after, x, false};
    double done = 0.0, step = 1.0, missed = 0.0, amplitude[MODES], rate[MODES], trial[MODES];
    memcpy(amplitude, memory + HISTORY_AMPLITUDE, sizeof amplitude);
    whole_deform(amplitude, model, NULL, model->bent_before);
    if (!predict(joint, inputs, memory, rate, reason))
        return false;
    for (;;) {
        const double part = fmin(done + step, 1.0);
        for (int k = 0; k < MODES; k++)
            trial[k] = amplitude[k] + (part - done) * rate[k];
        const Newton found = newton(joint, &way, part, trial, &missed, reason);
        if (found == REFUSED)
            return false;
        if (found == LOST) {
            step *= 0.5;
            if (step < MIN_LOAD_STEP) {
                tell(inputs, done, missed, reason);
                return false;
            }
            continue;
        }
        if (part == 1.0)
            break;
        for (int k = 0; k < MODES; k++)
            rate[k] = (trial[k] - amplitude[k]) / (part - done);
        memcpy(amplitude, trial, sizeof amplitude);
        done = part;
        step *= 2.0;
    }
    if (!way.whole && !try_at(joint, &way, inputs, trial, true, reason))
        return false;
    for (int d = 0; d < 3; d++)
        after[HISTORY_APART + d] = inputs[motion_of(2 + d)];
    memcpy(after + HISTORY_AMPLITUDE, trial, sizeof trial);
    memset(after + HISTORY_TANGENT, 0, 6 * MAX_PATCHES * sizeof *after);
    memcpy(after + HISTORY_TANGENT, model->tangent, 6 * (size_t)data.n_patches * sizeof *after);
    follow(model, (const double(*)[6])model->tangent, &model->end);
    key_of(inputs, after, model->end.key);
    return true;
}

/* Sums and forces */

/* Stiffnesses of the whole less what the bolts have between rigid sides, over the area, where the sums have them. */
static void tell_whole(const JointModel *model, const double stiffness[MOTIONS], double own, double *x)
{
    static const int sums[MOTIONS] = {SUM_TANGENT_X, SUM_TANGENT_Y, SUM_NORMAL_STIFFNESS,
                                      SUM_NORMAL_ABOUT_X, SUM_NORMAL_ABOUT_Y, SUM_TANGENT_Z};
    double bolts[MOTIONS] = {0.0};
    for (int b = 0; b < (int)data.n_stretch; b++) {
        bolts[2] += own;
        bolts[3] += own * data.bolts[b][BOLT_Y] * data.bolts[b][BOLT_Y];
        bolts[4] += own * data.bolts[b][BOLT_X] * data.bolts[b][BOLT_X];
    }
    for (int d = 0; d < MOTIONS; d++)
        x[sums[d]] = (stiffness[d] - bolts[d]) / model->area;
}

static void tell_stretch(const JointModel *model, const double *amplitude, const double *gaps, double *x)
{
    for (int b = 0; b < (int)data.n_stretch; b++) {
        const double stretch = dense_dot(model->stretch[b], amplitude) + gaps[b];
        x[SUM_STRETCH] += stretch;
        x[SUM_STRETCH_X] += stretch * data.bolts[b][BOLT_X];
        x[SUM_STRETCH_Y] += stretch * data.bolts[b][BOLT_Y];
    }
}

void whole_sums(Joint *joint, const double *inputs, double *x)
{
    if (!ELASTIC)
        return;
    const JointModel *model = &joint->model;
    double energy = 0.0;
    tell_whole(model, model->whole, model->bolt, x);
    tell_stretch(model, model->amplitude, model->bolt_gap, x);
    for (int k = 0; k < MODES; k++)
        energy += model->bodies[k] * model->amplitude[k] * model->amplitude[k];
    for (int b = 0; b < (int)data.n_stretch; b++) {
        const double stretch = stretched(model, b, inputs, model->amplitude), gap = model->bolt_gap[b];
        energy += model->bolt * stretch * stretch - model->bolt * gap * gap;
    }
    x[SUM_LOOP_ENERGY] += 0.5 * energy / model->area;
}

void whole_rates(Joint *joint, const double *inputs, const double *memory, const double *after, const double *seed)
{
    if (!ELASTIC)
        return;
    JointModel *model = &joint->model;
    double r[MODES] = {0.0};
    for (int i = 0; i < (int)data.n_nodes; i++)
        add_scaled(model->area * data.nodes[i][SHARE] * model->pressing[i], model->opening[i], r);
    for (int j = 0; j < (int)data.n_patches; j++)
        for (int d = 0; d < 3; d++)
            add_scaled(-model->area * data.patches[j][SHARE] * model->shears[j].traction[d], model->patch[d][j], r);
    for (int b = 0; b < (int)data.n_stretch; b++)
        add_scaled(-model->bolt * (seat(b, seed) + bolt_gap_rate(model, b, seat(b, seed))), model->stretch[b], r);
    exact(joint, inputs, memory, after);
    dense_solve(model->work.abreast.use_avx, &model->factors, r);
    memcpy(model->amplitude_rate, r, sizeof r);
    whole_deform(r, model, model->opened_rate, model->bent_rate);
}

void whole_sum_rates(const Joint *joint, const double *inputs, const double *seed, double *dx)
{
    if (!ELASTIC)
        return;
    const JointModel *model = &joint->model;
    double rates[MOTIONS], energy = 0.0;
    for (int d = 0; d < MOTIONS; d++) { /* the motion with what follows is stationary: only tangents change it */
        const double *z = model->end.follow[d];
        double sum = 0.0;
        for (int i = 0; i < (int)data.n_nodes; i++) {
            const double normal[MOTIONS] = {0.0, 0.0, 1.0, data.nodes[i][PLACE_Y], -data.nodes[i][PLACE_X], 0.0};
            const double u = normal[d] + dense_dot(model->opening[i], z);
            sum += data.nodes[i][SHARE] * model->stiffening[i] * u * u;
        }
        for (int j = 0; j < (int)data.n_patches; j++) {
            const double along[MOTIONS] = {1.0, 0.0, 0.0, 0.0, 0.0, -data.patches[j][PLACE_Y]};
            const double across[MOTIONS] = {0.0, 1.0, 0.0, 0.0, 0.0, data.patches[j][PLACE_X]};
            const double u = along[d] + dense_dot(model->patch[0][j], z), v = across[d] + dense_dot(model->patch[1][j], z);
            const double *t = model->shears[j].tangent;
            const double w = (d == MOTIONS - 1 ? data.patches[j][RADIUS] : 0.0) + dense_dot(model->patch[2][j], z);
            sum += data.patches[j][SHARE] * (t[0] * u * u + t[2] * v * v + t[5] * w * w +
                                             2.0 * (t[1] * u * v + t[3] * u * w + t[4] * v * w));
        }
        rates[d] = model->area * sum;
    }
    tell_whole(model, rates, 0.0, dx);
    double gap_rates[MAX_STRETCH];
    for (int b = 0; b < (int)data.n_stretch; b++)
        gap_rates[b] = bolt_gap_rate(model, b, stretched(model, b, seed, model->amplitude_rate));
    tell_stretch(model, model->amplitude_rate, gap_rates, dx);
    for (int k = 0; k < MODES; k++)
        energy += model->bodies[k] * model->amplitude[k] * model->amplitude_rate[k];
    for (int b = 0; b < (int)data.n_stretch; b++)
        energy += model->bolt * stretched(model, b, inputs, model->amplitude) *
                      stretched(model, b, seed, model->amplitude_rate) -
                  model->bolt * model->bolt_gap[b] * gap_rates[b];
    dx[SUM_LOOP_ENERGY] += energy / model->area;
}

void whole_bolt_rates(const Joint *joint, const double *seed, double *result)
{
    if (!ELASTIC)
        return;
    const JointModel *model = &joint->model;
    for (int b = 0; b < (int)data.n_stretch; b++) {
        const double rate = stretched(model, b, seed, model->amplitude_rate);
        result[b] = model->bolt_tightening[b] + model->bolt * (rate + bolt_gap_rate(model, b, rate));
    }
}

END_OPTIMIZE_FOR_SIZE
