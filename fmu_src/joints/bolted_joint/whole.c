#include "whole.h"

#include <math.h>
#include <string.h>

#include "tabulated.h"

enum { MOTIONS = 6, N_H = MOTIONS + MODES };

/* Places of the motions of side 2 in the inputs: s_x, s_y, s_z, theta_x, theta_y, theta_z. */
static inline int motion_of(int d)
{
    return d < 3 ? INPUT_S_REL_X + d : INPUT_THETA_X + d - 3;
}

static inline int n_modes(void)
{
    return (int)data.n_modes;
}

/* A joint with rigid sides has nothing of this: ELASTIC is a constant. */

void whole_begin(Kind *kind)
{
    if (!ELASTIC)
        return;
    for (int i = 0; i < (int)data.n_opening; i++)
        for (int k = 0; k < n_modes(); k++)
            kind->opening[i][k] = data.opening[i][k] / MODE_DIGITS;
    for (int j = 0; j < (int)data.n_patch_x; j++)
        for (int k = 0; k < n_modes(); k++) {
            kind->patch[0][j][k] = data.patch_x[j][k] / MODE_DIGITS;
            kind->patch[1][j][k] = data.patch_y[j][k] / MODE_DIGITS;
            kind->patch[2][j][k] = data.patch_z[j][k] / MODE_DIGITS;
        }
    for (int b = 0; b < (int)data.n_bolts; b++)
        for (int k = 0; k < n_modes(); k++)
            kind->stretch[b][k] = data.stretch[b][k] / MODE_DIGITS;
}

static inline double dot(const double *a, const double *b)
{
    double sum = 0.0;
    for (int k = 0; k < n_modes(); k++)
        sum += a[k] * b[k];
    return sum;
}

static inline void add_scaled(double by, const double *row, double *sum)
{
    for (int k = 0; k < n_modes(); k++)
        sum[k] += by * row[k];
}

void whole_deform(const double *amplitude, const Kind *kind, double *opened, double *patch_opened, double (*bent)[2])
{
    if (!ELASTIC)
        return;
    for (int i = 0; i < (int)data.n_opening && opened; i++)
        opened[i] = dot(kind->opening[i], amplitude);
    for (int j = 0; j < (int)data.n_patch_x; j++) {
        bent[j][0] = dot(kind->patch[0][j], amplitude);
        bent[j][1] = dot(kind->patch[1][j], amplitude);
        if (patch_opened)
            patch_opened[j] = dot(kind->patch[2][j], amplitude);
    }
}

/* Dense systems */

/* Factors of `factors` in its place, with partial pivoting. */
static void factor(Kind *kind)
{
    double(*a)[MODES] = kind->factors;
    int *pivots = kind->pivots;
    for (int c = 0; c < n_modes(); c++) {
        int best = c;
        for (int r = c + 1; r < n_modes(); r++)
            best = fabs(a[r][c]) > fabs(a[best][c]) ? r : best;
        pivots[c] = best;
        for (int k = 0; k < n_modes() && best != c; k++) {
            const double kept = a[c][k];
            a[c][k] = a[best][k];
            a[best][k] = kept;
        }
        for (int r = c + 1; r < n_modes(); r++) {
            const double by = a[r][c] / a[c][c];
            a[r][c] = by;
            for (int k = c + 1; k < n_modes(); k++)
                a[r][k] -= by * a[c][k];
        }
    }
}

static void solve(const Kind *kind, double *x)
{
    const double(*a)[MODES] = (const double(*)[MODES])kind->factors;
    const int *pivots = kind->pivots;
    for (int c = 0; c < n_modes(); c++) {
        const double kept = x[pivots[c]];
        x[pivots[c]] = x[c];
        x[c] = kept;
    }
    for (int r = 0; r < n_modes(); r++)
        for (int k = 0; k < r; k++)
            x[r] -= a[r][k] * x[k];
    for (int r = n_modes() - 1; r >= 0; r--) {
        for (int k = r + 1; k < n_modes(); k++)
            x[r] -= a[r][k] * x[k];
        x[r] /= a[r][r];
    }
}

/* Add weight times row row^T, its lower half. */
static inline void add_square(double weight, const double *row, int n, double *h, int width)
{
    for (int r = 0; r < n; r++) {
        const double by = weight * row[r];
        for (int k = 0; k <= r; k++)
            h[r * width + k] += by * row[k];
    }
}

static void mirror(double (*a)[MODES])
{
    for (int r = 0; r < n_modes(); r++)
        for (int k = 0; k < r; k++)
            a[k][r] = a[r][k];
}

/* Equilibrium */

static inline double seat(int b, const double *v)
{
    return v[INPUT_S_REL_X + 2] + v[INPUT_THETA_X] * data.bolts[b][1] - v[INPUT_THETA_X + 1] * data.bolts[b][0];
}

static inline double stretched(const Kind *kind, int b, const double *v, const double *amplitude)
{
    return seat(b, v) + dot(kind->stretch[b], amplitude);
}

/* Residual of the amplitudes, and what of it is round-off. */
static double residual(const Joint *joint, const double *inputs, const double *amplitude, double *r)
{
    const Kind *kind = &joint->kind;
    double forces = 0.0, stiffness = 0.0, apart = 0.0;
    for (int k = 0; k < n_modes(); k++)
        r[k] = data.modes[k][0] * amplitude[k];
    for (int i = 0; i < (int)data.n_nodes; i++) {
        const double weight = kind->area * data.nodes[i][SHARE], p = kind->p[i], tight = kind->tightened[i];
        const double moved = fabs(inputs[INPUT_S_REL_X + 2] + inputs[INPUT_THETA_X] * data.nodes[i][PLACE_Y] -
                                  inputs[INPUT_THETA_X + 1] * data.nodes[i][PLACE_X]);
        add_scaled(-weight * (p - tight), kind->opening[i], r);
        forces += weight * (p + tight);
        stiffness += weight * kind->k[i];
        apart = moved > apart ? moved : apart;
    }
    for (int j = 0; j < (int)data.n_patches; j++) {
        const double weight = kind->area * data.patches[j][SHARE];
        for (int d = 0; d < 2; d++) {
            add_scaled(weight * kind->traction[j][d], kind->patch[d][j], r);
            forces += weight * fabs(kind->traction[j][d]);
        }
    }
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double force = kind->bolt * stretched(kind, b, inputs, amplitude);
        add_scaled(force, kind->stretch[b], r);
        forces += fabs(force);
    }
    return WHOLE_CLOSE * (forces + stiffness * apart * WHOLE_CANCELS);
}

/* The derivative of the residual, factored; in a further motion where the memory after it is given. */
static void jacobian(Joint *joint, const double *inputs, const double *memory, const double *after)
{
    Kind *kind = &joint->kind;
    double(*a)[MODES] = kind->factors;
    static const double units[3][3] = {{0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}};
    memset(a, 0, sizeof kind->factors);
    for (int k = 0; k < n_modes(); k++)
        a[k][k] = data.modes[k][0];
    for (int i = 0; i < (int)data.n_nodes; i++)
        add_square(kind->area * data.nodes[i][SHARE] * kind->k[i], kind->opening[i], n_modes(), a[0], MODES);
    for (int b = 0; b < (int)data.n_bolts; b++)
        add_square(kind->bolt, kind->stretch[b], n_modes(), a[0], MODES);
    mirror(a);
    for (int j = 0; j < (int)data.n_patches; j++) {
        const double weight = kind->area * data.patches[j][SHARE];
        double rows[2][MODES] = {{0.0}};
        for (int c = 0; c < 3; c++) {
            const Shear slope = patch_rate(joint, j, inputs, memory, after, units[c][0], units[c] + 1);
            for (int d = 0; d < 2; d++)
                add_scaled(weight * slope.traction[d], kind->patch[c][j], rows[d]);
        }
        for (int d = 0; d < 2; d++)
            for (int r = 0; r < n_modes(); r++)
                add_scaled(kind->patch[d][j][r], rows[d], a[r]);
    }
    factor(kind);
}

/* How the amplitudes follow the motions, in the tangents of points and patches, and the stiffnesses that are left. */
static void follow(Kind *kind, const double (*tangent)[3])
{
    double row[N_H], other[N_H], (*h)[N_H] = kind->slope, (*a)[MODES] = kind->factors;
    memset(h, 0, sizeof kind->slope);
    for (int i = 0; i < (int)data.n_nodes; i++) {
        const double normal[MOTIONS] = {0.0, 0.0, 1.0, data.nodes[i][PLACE_Y], -data.nodes[i][PLACE_X], 0.0};
        memcpy(row, normal, sizeof normal);
        memcpy(row + MOTIONS, kind->opening[i], MODES * sizeof *row);
        add_square(kind->area * data.nodes[i][SHARE] * kind->k[i], row, MOTIONS + n_modes(), h[0], N_H);
    }
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double normal[MOTIONS] = {0.0, 0.0, 1.0, data.bolts[b][1], -data.bolts[b][0], 0.0};
        memcpy(row, normal, sizeof normal);
        memcpy(row + MOTIONS, kind->stretch[b], MODES * sizeof *row);
        add_square(kind->bolt, row, MOTIONS + n_modes(), h[0], N_H);
    }
    for (int j = 0; j < (int)data.n_patches; j++) {
        const double weight = kind->area * data.patches[j][SHARE], *t = tangent[j];
        const double along[MOTIONS] = {1.0, 0.0, 0.0, 0.0, 0.0, -data.patches[j][PLACE_Y]};
        const double across[MOTIONS] = {0.0, 1.0, 0.0, 0.0, 0.0, data.patches[j][PLACE_X]};
        memcpy(row, along, sizeof along);
        memcpy(row + MOTIONS, kind->patch[0][j], MODES * sizeof *row);
        memcpy(other, across, sizeof across);
        memcpy(other + MOTIONS, kind->patch[1][j], MODES * sizeof *other);
        for (int r = 0; r < MOTIONS + n_modes(); r++) {
            const double x = weight * (t[0] * row[r] + t[1] * other[r]), y = weight * (t[1] * row[r] + t[2] * other[r]);
            for (int k = 0; k <= r; k++)
                h[r][k] += x * row[k] + y * other[k];
        }
    }
    for (int r = 0; r < n_modes(); r++) {
        memcpy(a[r], h[MOTIONS + r] + MOTIONS, (size_t)(r + 1) * sizeof *a[r]);
        a[r][r] += data.modes[r][0];
    }
    mirror(a);
    factor(kind);
    for (int d = 0; d < MOTIONS; d++) {
        double *z = kind->follow[d];
        for (int k = 0; k < n_modes(); k++)
            z[k] = -h[MOTIONS + k][d];
        solve(kind, z);
        kind->whole[d] = h[d][d];
        for (int k = 0; k < n_modes(); k++)
            kind->whole[d] += h[MOTIONS + k][d] * z[k];
    }
}

/* What decides how the amplitudes follow: preload, moment, shift, and the end of the memory. */
static void key_of(const double *inputs, const double *memory, double key[FOLLOW_KEY])
{
    key[0] = inputs[INPUT_PRELOAD];
    key[1] = inputs[INPUT_MOMENT];
    memcpy(key + 2, memory + AT_RIGID, 3 * sizeof *key);
    memcpy(key + 5, memory + AT_APART, (FOLLOW_KEY - 5) * sizeof *key);
}

/* The place after a part of the way from the memory to the inputs. */
static void place(const double *inputs, const double *memory, double part, double *at)
{
    const double first[MOTIONS] = {memory[AT_RIGID], memory[AT_RIGID + 1], memory[AT_APART],
                                   memory[AT_APART + 1], memory[AT_APART + 2], memory[AT_RIGID + 2]};
    memcpy(at, inputs, N_INPUTS * sizeof *at);
    for (int d = 0; d < MOTIONS && part != 1.0; d++)
        at[motion_of(d)] = first[d] + part * (inputs[motion_of(d)] - first[d]);
}

static void deform(Kind *kind, const double *amplitude)
{
    memcpy(kind->amplitude, amplitude, sizeof kind->amplitude);
    whole_deform(amplitude, kind, kind->opened, kind->patch_opened, kind->bent);
}

/* Amplitudes at the end of the way in the tangent of its beginning; less those there are their rate. */
static bool predict(Joint *joint, const double *inputs, const double *memory, double *rate, Text *why)
{
    Kind *kind = &joint->kind;
    double key[FOLLOW_KEY], first[N_INPUTS], tangent[MOST_PATCHES][3];
    key_of(inputs, memory, key);
    place(inputs, memory, 0.0, first);
    if (!kind->follows || memcmp(key, kind->key, sizeof key) != 0) {
        deform(kind, memory + AT_AMPLITUDE);
        if (!joint_press(joint, first, why))
            return false;
        memcpy(tangent, memory + AT_TANGENT, sizeof tangent);
        for (int j = 0; j < (int)data.n_patches && (int)memory[AT_STATE] == UNKNOWN; j++) {
            const Point at = foundation_point(&kind->foundation[j], kind->patch_start[j], 0);
            const double stick = foundation_stick(&kind->foundation[j], &at);
            tangent[j][0] = tangent[j][2] = stick;
            tangent[j][1] = 0.0;
        }
        follow(kind, (const double(*)[3])tangent);
        memcpy(kind->key, key, sizeof key);
        kind->follows = true;
    }
    memset(rate, 0, MODES * sizeof *rate);
    for (int d = 0; d < MOTIONS; d++)
        add_scaled(inputs[motion_of(d)] - first[motion_of(d)], kind->follow[d], rate);
    return true;
}

typedef struct {
    const double *inputs, *memory;
    double *after, *x;
} Way;

static bool try_at(Joint *joint, const Way *way, const double *at, const double *amplitude, Text *why)
{
    deform(&joint->kind, amplitude);
    memset(way->x, 0, N_SUMS * sizeof *way->x);
    return joint_try(joint, at, way->memory, way->after, way->x, why);
}

static double largest(const double *r)
{
    double most = 0.0;
    for (int k = 0; k < n_modes(); k++)
        most = fabs(r[k]) > most || !(r[k] == r[k]) ? fabs(r[k]) : most;
    return most;
}

typedef enum { FOUND, LOST, REFUSED } Newton;

/* As `Whole._newton` of the package. */
static Newton newton(Joint *joint, const Way *way, double part, double *amplitude, Text *why)
{
    const Kind *kind = &joint->kind;
    const double close = part == 1.0 ? 1.0 : WHOLE_ROUGH;
    double at[N_INPUTS], r[MODES], least;
    place(way->inputs, way->memory, part, at);
    if (!try_at(joint, way, at, amplitude, why))
        return REFUSED;
    least = residual(joint, at, amplitude, r);
    double before = 0.0;
    for (int n = 0; n < NEWTON_STEPS; n++) {
        const double left = largest(r);
        if (left <= close * least)
            return FOUND;
        double step[MODES], begin[MODES], size = 1.0;
        if (!(left < WHOLE_CHORD * before)) /* else the last derivative is still good */
            jacobian(joint, at, way->memory, NULL);
        before = left;
        memcpy(step, r, sizeof step);
        solve(kind, step);
        memcpy(begin, amplitude, sizeof begin);
        const double falls = -dot(r, step);
        for (int p = 0; p < NEWTON_PARTS; p++) {
            for (int k = 0; k < n_modes(); k++)
                amplitude[k] = begin[k] - size * step[k];
            if (!try_at(joint, way, at, amplitude, why))
                return REFUSED;
            least = residual(joint, at, amplitude, r);
            const double rises = -dot(r, step);
            if (!(rises > 0.5 * fabs(falls)))
                break;
            size *= fmax(falls / (falls - rises), 0.1);
        }
    }
    return largest(r) <= close * least ? FOUND : LOST;
}

static void tell(const double *inputs, double done, Text *why)
{
    static const int told[] = {INPUT_PRELOAD, INPUT_MOMENT};
    text_clear(why);
    for (int v = 0; v < 2 + MOTIONS; v++) {
        const int at = v < 2 ? told[v] : motion_of(v - 2);
        if (inputs[at] == 0.0)
            continue;
        text_add(why, why->length > 0 ? ", " : "");
        text_add(why, variables[FIRST_INPUT + at].name);
        text_add(why, " = ");
        text_number(why, inputs[at], 6);
    }
    text_add(why, ": the sides find no equilibrium beyond ");
    text_number(why, done, 3);
    text_add(why, " of the way");
}

bool whole_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *x, Text *why)
{
    if (!ELASTIC)
        return false;
    Kind *kind = &joint->kind;
    const Way way = {inputs, memory, after, x};
    double done = 0.0, step = 1.0, amplitude[MODES], rate[MODES], trial[MODES];
    memcpy(amplitude, memory + AT_AMPLITUDE, sizeof amplitude);
    whole_deform(amplitude, kind, NULL, NULL, kind->bent_before);
    if (!predict(joint, inputs, memory, rate, why))
        return false;
    for (;;) {
        const double part = fmin(done + step, 1.0);
        for (int k = 0; k < MODES; k++)
            trial[k] = amplitude[k] + (part - done) * rate[k];
        const Newton found = newton(joint, &way, part, trial, why);
        if (found == REFUSED)
            return false;
        if (found == LOST) {
            step *= 0.5;
            if (step < WHOLE_LEAST_PART) {
                tell(inputs, done, why);
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
    for (int d = 0; d < 3; d++)
        after[AT_APART + d] = inputs[motion_of(2 + d)];
    memcpy(after + AT_AMPLITUDE, trial, sizeof trial);
    memset(after + AT_TANGENT, 0, 3 * MOST_PATCHES * sizeof *after);
    memcpy(after + AT_TANGENT, kind->tangent, 3 * (size_t)data.n_patches * sizeof *after);
    follow(kind, (const double(*)[3])(after + AT_TANGENT));
    key_of(inputs, after, kind->key);
    kind->follows = true;
    return true;
}

/* Sums and forces */

/* Stiffnesses of the whole less what the bolts have between rigid sides, over the area, where the sums have them. */
static void tell_whole(const Kind *kind, const double stiffness[MOTIONS], double own, double *x)
{
    static const int sums[MOTIONS] = {SUM_TANGENT_X, SUM_TANGENT_Y, SUM_NORMAL_STIFFNESS,
                                      SUM_NORMAL_ABOUT_X, SUM_NORMAL_ABOUT_Y, SUM_TANGENT_Z};
    double bolts[MOTIONS] = {0.0};
    for (int b = 0; b < (int)data.n_bolts; b++) {
        bolts[2] += own;
        bolts[3] += own * data.bolts[b][1] * data.bolts[b][1];
        bolts[4] += own * data.bolts[b][0] * data.bolts[b][0];
    }
    for (int d = 0; d < MOTIONS; d++)
        x[sums[d]] = (stiffness[d] - bolts[d]) / kind->area;
}

static void tell_stretch(const Kind *kind, const double *amplitude, double *x)
{
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double stretch = dot(kind->stretch[b], amplitude);
        x[SUM_STRETCH] += stretch;
        x[SUM_STRETCH_X] += stretch * data.bolts[b][0];
        x[SUM_STRETCH_Y] += stretch * data.bolts[b][1];
    }
}

void whole_sums(Joint *joint, const double *inputs, double *x)
{
    if (!ELASTIC)
        return;
    const Kind *kind = &joint->kind;
    double energy = 0.0;
    tell_whole(kind, kind->whole, kind->bolt, x);
    tell_stretch(kind, kind->amplitude, x);
    for (int k = 0; k < n_modes(); k++)
        energy += data.modes[k][0] * kind->amplitude[k] * kind->amplitude[k];
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double stretch = stretched(kind, b, inputs, kind->amplitude);
        energy += kind->bolt * stretch * stretch;
    }
    x[SUM_LOOP_ENERGY] += 0.5 * energy / kind->area;
}

void whole_bolts(const Joint *joint, const double *inputs, double *out)
{
    if (!ELASTIC)
        return;
    const Kind *kind = &joint->kind;
    double left;
    working_preload(inputs + INPUT_PRELOAD, joint->c, &left);
    for (int b = 0; b < (int)data.n_bolts; b++)
        out[b] = left + inputs[INPUT_MOMENT] * data.bolts[b][2] +
                 kind->bolt * stretched(kind, b, inputs, kind->amplitude);
}

void whole_rates(Joint *joint, const double *inputs, const double *memory, const double *after, const double *seed)
{
    if (!ELASTIC)
        return;
    Kind *kind = &joint->kind;
    double r[MODES] = {0.0};
    for (int i = 0; i < (int)data.n_nodes; i++)
        add_scaled(kind->area * data.nodes[i][SHARE] * kind->pressing[i], kind->opening[i], r);
    for (int j = 0; j < (int)data.n_patches; j++)
        for (int d = 0; d < 2; d++)
            add_scaled(-kind->area * data.patches[j][SHARE] * kind->shears[j].traction[d], kind->patch[d][j], r);
    for (int b = 0; b < (int)data.n_bolts; b++)
        add_scaled(-kind->bolt * seat(b, seed), kind->stretch[b], r);
    jacobian(joint, inputs, memory, after);
    solve(kind, r);
    memcpy(kind->amplitude_rate, r, sizeof r);
    whole_deform(r, kind, kind->opened_rate, kind->patch_opened_rate, kind->bent_rate);
}

void whole_sum_rates(const Joint *joint, const double *inputs, const double *seed, double *dx)
{
    if (!ELASTIC)
        return;
    const Kind *kind = &joint->kind;
    double rates[MOTIONS], energy = 0.0;
    for (int d = 0; d < MOTIONS; d++) { /* the motion with what follows is stationary: only tangents change it */
        const double *z = kind->follow[d];
        double sum = 0.0;
        for (int i = 0; i < (int)data.n_nodes; i++) {
            const double normal[MOTIONS] = {0.0, 0.0, 1.0, data.nodes[i][PLACE_Y], -data.nodes[i][PLACE_X], 0.0};
            const double u = normal[d] + dot(kind->opening[i], z);
            sum += data.nodes[i][SHARE] * kind->stiffening[i] * u * u;
        }
        for (int j = 0; j < (int)data.n_patches; j++) {
            const double along[MOTIONS] = {1.0, 0.0, 0.0, 0.0, 0.0, -data.patches[j][PLACE_Y]};
            const double across[MOTIONS] = {0.0, 1.0, 0.0, 0.0, 0.0, data.patches[j][PLACE_X]};
            const double u = along[d] + dot(kind->patch[0][j], z), v = across[d] + dot(kind->patch[1][j], z);
            const double *t = kind->shears[j].tangent;
            sum += data.patches[j][SHARE] * (t[0] * u * u + 2.0 * t[1] * u * v + t[2] * v * v);
        }
        rates[d] = kind->area * sum;
    }
    tell_whole(kind, rates, 0.0, dx);
    tell_stretch(kind, kind->amplitude_rate, dx);
    for (int k = 0; k < n_modes(); k++)
        energy += data.modes[k][0] * kind->amplitude[k] * kind->amplitude_rate[k];
    for (int b = 0; b < (int)data.n_bolts; b++)
        energy += kind->bolt * stretched(kind, b, inputs, kind->amplitude) *
                  stretched(kind, b, seed, kind->amplitude_rate);
    dx[SUM_LOOP_ENERGY] += energy / kind->area;
}

void whole_bolt_rates(const Joint *joint, const double *inputs, const double *seed, double *result)
{
    if (!ELASTIC)
        return;
    const Kind *kind = &joint->kind;
    double left;
    working_preload_seed((const double[]){inputs[INPUT_PRELOAD], seed[INPUT_PRELOAD]}, joint->c, &left);
    for (int b = 0; b < (int)data.n_bolts; b++)
        result[b] = left + seed[INPUT_MOMENT] * data.bolts[b][2] +
                    kind->bolt * stretched(kind, b, seed, kind->amplitude_rate);
}
