/* Repeats `stiffness_tables`, `pair_table` and `torque_curve` of the package: the sums and tables that are
 * made for every parameter set; the laws in them are generated. */
#include "harmonic_drive.h"

#include <math.h>
#include <string.h>

#include "tabulated.h"

_Static_assert(N_LAW_TABLE == 2 + 2 * BLOCK_FUNCTIONS, "load, normal and tangential stiffness with slopes");
_Static_assert(MOST_CELLS % 2 == 0 && CURVE_NODES > DRIVE_STEPS, "blocks of two cells; one curve at least");
static void add_parameter(Text *why, const Joint *joint, const char *name)
{
    int i = 0;
    while (i + 1 < N_PARAMETERS && strcmp(variables[FIRST_PARAMETER + i].name, name) != 0)
        i++;
    text_add(why, name);
    text_add(why, " = ");
    text_number(why, joint->c[i], 6);
}

static void no_stiffness(const Joint *joint, double K, Text *why)
{
    add_parameter(why, joint, "K_FTS0");
    text_add(why, " N.m/rad, ");
    add_parameter(why, joint, "pair_scale");
    text_add(why, " and ");
    add_parameter(why, joint, "drive_scale");
    text_add(why, " give K_WTS = ");
    text_number(why, K, 6);
    text_add(why, " N.m/rad, allowed is (");
    text_number(why, SOFTEST, 6);
    text_add(why, ", ");
    text_number(why, joint->kind.K_FTS0, 6);
    text_add(why, ") N.m/rad with K_TS at most ");
    text_number(why, 1.0 / STIFFEST, 6);
    text_add(why, " times K_FTS0");
}

/* Stiffnesses of the area A_0 at a log-pressure inside a regime (between two log-areas). */
static bool sample(const Joint *joint, double x, double left, double right, double *u, Sample *out, Text *why)
{
    const Spots *spots = &joint->kind.spots;
    double y[N_LAW_TABLE], slope;
    if (!spots_solve(spots, joint->c, exp(x), u, &slope, why))
        return false;
    const double at = fmin(fmax(*u, left), right);
    const double side = fmin(fmax(at, left + SIDE), right - SIDE);
    spots_table(spots, joint->c, at, y);
    out->value[0] = y[2];
    out->value[1] = y[4];
    if (side != at)
        spots_table(spots, joint->c, side, y);
    const double growth = y[1] / y[0];
    out->slope[0] = y[3] / growth;
    out->slope[1] = y[5] / growth;
    return true;
}

/* Tables of the stiffness over the log-pressure, one per regime, up to a pressure. */
static bool tabulate_regimes(Joint *joint, double highest, Text *why)
{
    Kind *kind = &joint->kind;
    const Spots *spots = &kind->spots;
    double ends[N_LAW_ENDS + 1], y[N_LAW_TABLE];
    kind->n_regimes = 0;
    for (int i = 0; i < spots->n_ends; i++) {
        spots_table(spots, joint->c, spots->ends[i], y);
        if (y[0] / spots->area < highest)
            kind->edges[kind->n_regimes++] = y[0] / spots->area;
    }
    const int n = kind->n_regimes;
    for (int i = 0; i < n; i++)
        ends[i] = log(kind->edges[i]);
    ends[n] = log(highest);
    const double widest = n > 0 ? (ends[n] - ends[0]) / MOST_CELLS : 0.0;
    const double cell = fmax(CELL, widest);
    Block *free = kind->regime_blocks;
    for (int i = 0; i < n; i++) {
        const double low = ends[i], high = ends[i + 1];
        const int blocks = (int)fmax(ceil((high - low) / (2.0 * cell)), 1.0);
        const double step = (high - low) / (2 * blocks);
        const double left = spots->ends[i];
        const double right = i + 1 < spots->n_ends ? spots->ends[i + 1] : INFINITY;
        double u = left;
        Sample three[3];
        if (free + blocks > kind->regime_blocks + REGIME_BLOCKS) {
            text_add(why, "the tables of the stiffness need more than ");
            text_number(why, REGIME_BLOCKS, 6);
            text_add(why, " blocks");
            return false;
        }
        kind->regimes[i] = (Blocks){.start = low, .cell = step, .n = blocks, .block = free};
        for (int k = 0; k <= 2 * blocks; k++) {
            const double x = k == 2 * blocks ? high : low + k * step;
            if (!sample(joint, x, left, right, &u, &three[k == 0 ? 0 : 2 - k % 2], why))
                return false;
            if (k > 0 && k % 2 == 0) {
                block_through(free++, &three[0], &three[1], &three[2], step);
                three[0] = three[2];
            }
        }
    }
    return true;
}

/* Sum over the nodes of a piece of a lobe, where one regime of the law holds. */
static void add_piece(const Joint *joint, int regime, double z, double axis, double t, double width,
                      double axial, double *value, double *slope)
{
    double x[4] = {0.0, 0.0, z, axis}, point[4], k[2], growth[2];
    for (int i = 0; i < N_PLACES; i++) {
        const double at = t + width * PLACES[i];
        x[0] = sin(at);
        x[1] = cos(at);
        lobe(x, joint->c, point);
        blocks_at(&joint->kind.regimes[regime], 2, log(point[0]), k, growth);
        const double share = axial * width * WEIGHTS[i] * point[3];
        *value += share * (k[0] * point[1] + k[1] * point[2]);
        *slope += share * axis / point[0] * (growth[0] * point[1] + growth[1] * point[2]);
    }
}

/* The lobe at one height: from the axis outward through the regimes. */
static void add_height(const Joint *joint, double peak, double z, double axial, double *value, double *slope)
{
    const double at[2] = {peak, z};
    double axis, t = 0.0;
    lobe_local(at, joint->c, &axis);
    for (int regime = joint->kind.n_regimes - 1; regime >= 0; regime--) {
        const double edge[2] = {axis, joint->kind.edges[regime]};
        double end;
        lobe_end(edge, joint->c, &end);
        if (end > t)
            add_piece(joint, regime, z, axis, t, end - t, axial, value, slope);
        t = end;
    }
}

/* K_TS on the paper's scale at a peak pressure, and its slope in the log of it. */
static Sample pair_at(const Joint *joint, double peak)
{
    const Kind *kind = &joint->kind;
    Sample sum = {{0.0, 0.0}, {0.0, 0.0}};
    double z = 0.0;
    for (int regime = kind->n_regimes - 1; regime >= -1; regime--) {
        double end = kind->length;
        if (regime >= 0) {
            const double at[2] = {peak, kind->edges[regime]};
            lobe_height(at, joint->c, &end);
        }
        const double width = end - z;
        for (int i = 0; i < N_HEIGHTS && width > 0.0; i++)
            add_height(joint, peak, z + width * HEIGHTS[i], width / kind->length * HEIGHT_WEIGHTS[i],
                       &sum.value[0], &sum.slope[0]);
        z = end;
    }
    sum.value[0] *= kind->pair_scale;
    sum.slope[0] *= kind->pair_scale;
    return sum;
}

/* Two blocks against one in their place, at the quarter points of their cells. */
static void measure_pair(Kind *kind, const Block *fine, const Sample *five, double cell)
{
    Block coarse;
    block_through(&coarse, &five[0], &five[2], &five[4], 2.0 * cell);
    for (int k = 0; k < 4; k++)
        for (int i = 1; i < 4; i++) {
            const double place = k + 0.25 * i; /* cells from the first node */
            const double exact = block_value(&fine[k / 2], place - 2.0 * (k / 2) - 1.0);
            const double error = 0.5 * fabs(block_value(&coarse, 0.5 * place - 1.0) / exact - 1.0);
            kind->pair_error = fmax(kind->pair_error, error);
        }
}

static void tabulate_pair(Joint *joint, double low, double high, int steps)
{
    Kind *kind = &joint->kind;
    const double start = log(low), range = log(high / low);
    const double pairs = fmin(ceil(steps / (double)PAIR_STEPS * range), PAIR_BLOCKS / 2);
    const int blocks = 2 * (int)fmax(pairs, 1.0);
    const double cell = (log(high) - start) / (2 * blocks);
    kind->pair = (Blocks){.start = start, .cell = cell, .n = blocks, .block = kind->pair_blocks};
    kind->pair_error = 0.0;
    Sample five[5];
    for (int k = 0; k <= 2 * blocks; k++) {
        five[k == 0 ? 0 : (k - 1) % 4 + 1] = pair_at(joint, exp(k == 2 * blocks ? log(high) : start + k * cell));
        if (k == 0 || k % 4 != 0)
            continue;
        Block *fine = &kind->pair_blocks[k / 2 - 2];
        block_through(&fine[0], &five[0], &five[1], &five[2], cell);
        block_through(&fine[1], &five[2], &five[3], &five[4], cell);
        measure_pair(kind, fine, five, cell);
        five[0] = five[4];
    }
}

/* K_WTS and its slope at a torque. */
static void stiffness(const Joint *joint, double torque, double *K)
{
    double at[2], pair[1], slope[1];
    peak(&torque, joint->c, at);
    blocks_at(&joint->kind.pair, 1, log(at[0]), pair, slope);
    const double x[2] = {pair[0], slope[0] / at[0] * at[1]};
    in_series(x, joint->c, K);
}

static bool windup(Joint *joint, int steps, Text *why)
{
    const Kind *kind = &joint->kind;
    const double none = 0.0;
    double low[2], high[2], K[2];
    peak(&none, joint->c, low);
    peak(&kind->max_torque, joint->c, high);
    tabulate_pair(joint, low[0], high[0], steps);
    const double step = asinh(kind->max_torque / kind->smoothing) / steps, half = 0.5 * step;
    double phi = 0.0;
    curve_begin(&joint->curve, kind->pair_error);
    for (int k = 0; k <= steps; k++) {
        const double xi = k * step, torque = kind->smoothing * sinh(xi);
        stiffness(joint, torque, K);
        if (!(K[0] > SOFTEST && K[0] < (1.0 - STIFFEST) * kind->K_FTS0)) {
            stiffness(joint, kind->max_torque, K);
            no_stiffness(joint, K[0], why);
            return false;
        }
        const Node node = {.x = phi, .y = torque, .s = K[0], .bend = K[0] * K[1]};
        if (k == 0)
            curve_piece(&joint->curve, node);
        else if (!curve_add(&joint->curve, node))
            return false;
        double rise = 0.0;
        for (int i = 0; i < N_DRIVE_GAUSS && k < steps; i++) {
            const double at = xi + half * (1.0 + DRIVE_GAUSS[i]);
            stiffness(joint, kind->smoothing * sinh(at), K);
            rise += DRIVE_GAUSS_WEIGHTS[i] * kind->smoothing * cosh(at) / K[0];
        }
        phi += half * rise;
    }
    curve_finish(&joint->curve);
    return true;
}

bool kind_tabulate(Joint *joint, Text *why)
{
    Kind *kind = &joint->kind;
    double head[5], highest[2];
    if (!spots_begin(&kind->spots, joint->c, why))
        return false;
    drive_head(0, joint->c, head);
    kind->length = head[0];
    kind->smoothing = head[1];
    kind->max_torque = head[2];
    kind->pair_scale = head[3];
    kind->K_FTS0 = head[4];
    peak(&kind->max_torque, joint->c, highest);
    return tabulate_regimes(joint, highest[0], why) && refined(joint, windup, DRIVE_STEPS, why);
}

/* Wind-up of the curve, torque and its derivatives up to an order (2 at most), at an argument: wind-up or
 * torque. */
static void look_up(const Joint *joint, const double *inputs, int order, double *x, double *y)
{
    double at, carried;
    int nearest = 0;
    argument(inputs, joint->c, &at);
    const double size = fabs(at);
    const double phi =
        ARGUMENT_IS_LOAD ? curve_inverse(&joint->curve, size, &nearest, &carried) : size;
    curve_at(&joint->curve, phi, order, y);
    *x = copysign(phi, at);
    y[0] = copysign(y[0], at);
    if (order == 2)
        y[2] = at < 0.0 ? -y[2] : y[2];
}

bool joint_evaluate(Joint *joint, const double *inputs, double *out, Text *why)
{
    double x[N_INPUTS + 3], y[2];
    (void)why;
    for (int i = 0; i < N_INPUTS; i++)
        x[i] = inputs[i];
    look_up(joint, inputs, 1, &x[N_INPUTS], y);
    x[N_INPUTS + 1] = y[0];
    x[N_INPUTS + 2] = y[1];
    outputs(x, joint->c, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *seed, double *result)
{
    enum { N = N_INPUTS + 3 };
    double x[2 * N], y[3], at[2 * N_INPUTS], rate;
    for (int i = 0; i < N_INPUTS; i++) {
        x[i] = at[i] = inputs[i];
        x[N + i] = at[N_INPUTS + i] = seed[i];
    }
    argument_seed(at, joint->c, &rate);
    look_up(joint, inputs, 2, &x[N_INPUTS], y);
    x[N_INPUTS + 1] = y[0];
    x[N_INPUTS + 2] = y[1];
    if (ARGUMENT_IS_LOAD)
        rate /= y[1];
    x[N + N_INPUTS] = rate;
    x[N + N_INPUTS + 1] = y[1] * rate;
    x[N + N_INPUTS + 2] = y[2] * rate;
    outputs_seed(x, joint->c, result);
}
