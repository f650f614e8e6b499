/* Repeats `BoltedJointSpring.motion` of the package: the sums over the nodes; the laws in it are generated. */
#include "bolted_joint.h"

#include <math.h>
#include <string.h>

#include "tabulated.h"

enum { PRELOAD, MOMENT, S_REL, V_REL = S_REL + 3 }; /* places of the inputs */
_Static_assert(MOMENT == PRELOAD + 1, "the arguments of bolt_pressures");
enum { X_S_REL = N_SUMS, X_P_MAX = N_SUMS + 6, N_X };  /* of the arguments of `outputs` */
_Static_assert(N_INPUTS == V_REL + 3, "preload, moment, displacement and its rate");
_Static_assert(N_LAW_STATE == 2, "plastic and elastic work");
_Static_assert(SUM_ELASTIC == SUM_PLASTIC + 1, "in the order of the law's state");

/* Beyond so many cells from rest the displacement is so large that nodes are taken one by one. */
static const double FAR = 1e9;

static bool tabulate(Joint *joint, int steps, Text *why)
{
    Kind *kind = &joint->kind;
    return approach_tabulate(&kind->approach, &joint->curve, &kind->spots, joint->c, steps, why);
}

bool kind_tabulate(Joint *joint, Text *why)
{
    Kind *kind = &joint->kind;
    const Curve *curve = &joint->curve;
    kind->tight = false;
    if (!spots_begin(&kind->spots, joint->c, why) || !refined(joint, tabulate, APPROACH_STEPS, why))
        return false;
    const double segment = (curve->end.x - curve->first.x) / (curve->n - 1);
    kind->width = segment * fmin(1.0, (double)PASSING / N_NODES);
    return true;
}

/* Approach of the nodes at tightening; kept while preload and moment stay. */
static void tighten(Joint *joint, const double *inputs)
{
    Kind *kind = &joint->kind;
    if (kind->tight && kind->preload == inputs[PRELOAD] && kind->moment == inputs[MOMENT])
        return;
    const bool even = inputs[MOMENT] == 0.0;
    kind->nodes = even ? EVEN_NODES : NODES;
    kind->n_nodes = even ? N_EVEN_NODES : N_NODES;
    double bolts[2], tightened = 0.0, largest = -1.0;
    int segment = 0;
    bolt_pressures(inputs + PRELOAD, joint->c, bolts);
    for (int i = 0; i < kind->n_nodes; i++) {
        const double *node = kind->nodes[i], x[4] = {node[EQUAL], node[TILT], bolts[0], bolts[1]};
        double pressure, carried;
        shaped_pressure(x, joint->c, &pressure);
        kind->start[i] = curve_inverse(&joint->curve, pressure, &segment, &carried);
        tightened += node[SHARE] * carried;
        if (pressure > largest) {
            largest = pressure;
            kind->tightest = i;
        }
    }
    kind->tightened = tightened;
    kind->preload = inputs[PRELOAD];
    kind->moment = inputs[MOMENT];
    kind->tight = true;
    kind->tightening++;
    kind->listed = 0;
}

/* Cells */

/* y[m] += factor^m times the sum over k of a[k] (k over m) t[k - m]: what nodes with these powers of t on a
 * segment give as a polynomial of `factor` times its argument. */
static inline void add_polynomial(double *y, const double *a, int degree, const double *t, double factor)
{
    static const double binomial[6][6] = {{1.0},
                                          {1.0, 1.0},
                                          {1.0, 2.0, 1.0},
                                          {1.0, 3.0, 3.0, 1.0},
                                          {1.0, 4.0, 6.0, 4.0, 1.0},
                                          {1.0, 5.0, 10.0, 10.0, 5.0, 1.0}};
    double scale = 1.0;
    for (int m = 0; m <= degree; m++, scale *= factor) {
        double sum = 0.0;
        for (int k = m; k <= degree; k++)
            sum += a[k] * binomial[k][m] * t[k - m];
        y[m] += scale * sum;
    }
}

/* Add the nodes of a slot to a cell and empty it. */
static void empty_slot(const Joint *joint, Moments *slot, Polynomials *sum)
{
    const Kind *kind = &joint->kind;
    const int segment = slot->segment - 1;
    if (segment < 0)
        return;
    const double *a = joint->curve.a[segment], per = joint->curve.per[segment];
    const double factor = 0.5 * kind->width * per;
    double stiffness[5];
    for (int k = 0; k < 5; k++)
        stiffness[k] = (k + 1) * a[k + 1] * per;
    add_polynomial(sum->pressure, a, 5, slot->share, factor);
    add_polynomial(sum->about_x, stiffness, 4, slot->y2, factor);
    add_polynomial(sum->about_y, stiffness, 4, slot->x2, factor);
    for (int q = 0; q < N_LAW_STATE; q++)
        add_polynomial(sum->works[q], kind->approach.state[segment][q], 5, slot->share, factor);
    *slot = (Moments){.segment = 0};
}

static inline void add_moments(Moments *slot, const double *node, double t)
{
    const double square = t * t, fourth = square * square;
    const double power[6] = {1.0, t, square, t * square, fourth, t * fourth};
    for (int k = 0; k < 5; k++) {
        slot->share[k] += node[SHARE] * power[k];
        slot->x2[k] += node[SHARE_X2] * power[k];
        slot->y2[k] += node[SHARE_Y2] * power[k];
    }
    slot->share[5] += node[SHARE] * power[5];
}

static double inside(const Curve *curve, double x)
{
    return x < curve->first.x ? curve->first.x : (x > curve->end.x ? curve->end.x : x);
}

/* Add a node to a cell in whose middle its approach is x: to the sum if it is open or on one segment in all
 * of the cell, else to the list. The search begins at a segment and leaves the one that was found. */
static inline void add_to_cell(Joint *joint, int i, double x, int *nearest, Polynomials *sum)
{
    const double *node = joint->kind.nodes[i];
    const Curve *curve = &joint->curve;
    Kind *kind = &joint->kind;
    const double low = x - 0.51 * kind->width, high = x + 0.51 * kind->width; /* half, and round-off */
    if (high < curve->first.x) { /* open: no pressure, and the works of the closing's end */
        for (int q = 0; q < N_LAW_STATE; q++)
            sum->works[q][0] += node[SHARE] * kind->approach.state[0][q][0];
        return;
    }
    int segment = *nearest;
    if (!(low >= curve->x[segment] && low < curve->x[segment + 1]))
        *nearest = segment = curve_segment(curve, inside(curve, low));
    if (!(low >= curve->first.x && high < curve->x[segment + 1])) {
        kind->list[kind->listed++] = (Passing){(unsigned short)i, (unsigned short)segment};
        return;
    }
    Moments *slot = &kind->slots[segment % SLOTS];
    if (slot->segment != segment + 1) {
        empty_slot(joint, slot, sum);
        slot->segment = segment + 1;
    }
    add_moments(slot, node, (x - curve->x[segment]) * curve->per[segment]);
}

static void make_cell(Joint *joint, Cell *cell, double place)
{
    Kind *kind = &joint->kind;
    const double middle = (place + 0.5) * kind->width;
    if (kind->listed + N_NODES > LIST) { /* no room: the other cells are forgotten */
        kind->listed = 0;
        kind->tightening++;
    }
    *cell = (Cell){.place = place, .tightening = kind->tightening, .first = kind->listed};
    int nearest = 0;
    for (int i = 0; i < kind->n_nodes; i++)
        add_to_cell(joint, i, kind->start[i] - middle, &nearest, &cell->sum);
    for (int k = 0; k < SLOTS; k++)
        empty_slot(joint, &kind->slots[k], &cell->sum);
    cell->passing = kind->listed - cell->first;
}

/* The cell of a displacement. */
static const Cell *cell_at(Joint *joint, double apart)
{
    Kind *kind = &joint->kind;
    const double place = floor(apart / kind->width);
    Cell *cell = &kind->cells[(unsigned)(int)place % CELLS];
    if (cell->tightening != kind->tightening || cell->place != place)
        make_cell(joint, cell, place);
    return cell;
}

/* Sums */

/* What nodes give together, each with its derivatives in the approach. */
typedef struct {
    double pressure[5];
    double about_x[2], about_y[2];
    double works[N_LAW_STATE][2];
} Sums;

/* Outside the table: the law continues with its last tangent, and an open node has nothing. */
static bool add_outside(const Joint *joint, double x, double *curve, double *works, double *slopes, Text *why)
{
    const Kind *kind = &joint->kind;
    curve_at(&joint->curve, x, 4, curve);
    if (x >= joint->curve.end.x) {
        if (!approach_exact(&kind->spots, joint->c, curve[0], kind->approach.last, works, slopes, why))
            return false;
        for (int q = 0; q < N_LAW_STATE; q++)
            slopes[q] *= curve[1];
        return true;
    }
    for (int q = 0; q < N_LAW_STATE; q++) {
        works[q] = kind->approach.state[0][q][0];
        slopes[q] = 0.0;
    }
    return true;
}

/* Add a node at an approach, times `weight`; the search begins at a segment that is not behind its own. With
 * `order` 0 the last derivative of each sum is left out. */
static inline bool add_node(const Joint *joint, const double *node, int segment, double x, double weight, int order,
                            Sums *sums, Text *why)
{
    const Curve *c = &joint->curve;
    double curve[5], works[N_LAW_STATE], slopes[N_LAW_STATE];
    if (x >= c->first.x && x < c->end.x) {
        segment += x >= c->x[segment + 1]; /* mostly the only one, so without a branch */
        while (x >= c->x[segment + 1])
            segment++;
        const double t = (x - c->x[segment]) * c->per[segment];
        curve_derivatives(c, segment, t, 3 + order, curve);
        approach_state(&joint->kind.approach, c, segment, t, works, slopes);
    } else if (!add_outside(joint, x, curve, works, slopes, why)) {
        return false;
    }
    const double share = weight * node[SHARE], x2 = weight * node[SHARE_X2], y2 = weight * node[SHARE_Y2];
    for (int k = 0; k < 4 + order; k++)
        sums->pressure[k] += share * curve[k];
    for (int k = 0; k < 1 + order; k++) {
        sums->about_x[k] += y2 * curve[1 + k];
        sums->about_y[k] += x2 * curve[1 + k];
    }
    for (int q = 0; q < N_LAW_STATE; q++) {
        sums->works[q][0] += share * works[q];
        if (order)
            sums->works[q][1] += share * slopes[q];
    }
    return true;
}

/* Add a node that may be anywhere. */
static bool add_any(const Joint *joint, const double *node, double x, double weight, Sums *sums, Text *why)
{
    const int segment = curve_segment(&joint->curve, inside(&joint->curve, x));
    return add_node(joint, node, segment, x, weight, 1, sums, why);
}

/* A polynomial at z and its first derivatives in the approach; `per` is that of z. */
static inline void expand(const double *a, int degree, double z, double per, int order, double *y)
{
    double b[6], scale = 1.0;
    memcpy(b, a, (size_t)(degree + 1) * sizeof *b);
    for (int m = 0; m <= order; m++) {
        for (int k = degree - 1; k >= m; k--)
            b[k] += z * b[k + 1];
        y[m] = scale * b[m];
        scale *= (m + 1) * per;
    }
}

/* The sums over all nodes at a displacement; with `order` 0 without the last derivative of each. */
static inline bool press(Joint *joint, double apart, int order, Sums *sums, Text *why)
{
    Kind *kind = &joint->kind;
    *sums = (Sums){.pressure = {0.0}};
    if (!(fabs(apart) < FAR * kind->width)) {
        for (int i = 0; i < kind->n_nodes; i++)
            if (!add_any(joint, kind->nodes[i], kind->start[i] - apart, 1.0, sums, why))
                return false;
        return true;
    }
    const Cell *cell = cell_at(joint, apart);
    const double per = 2.0 / kind->width, z = ((cell->place + 0.5) * kind->width - apart) * per;
    expand(cell->sum.pressure, 5, z, per, 3 + order, sums->pressure);
    expand(cell->sum.about_x, 4, z, per, order, sums->about_x);
    expand(cell->sum.about_y, 4, z, per, order, sums->about_y);
    for (int q = 0; q < N_LAW_STATE; q++)
        expand(cell->sum.works[q], 5, z, per, order, sums->works[q]);
    for (int k = 0; k < cell->passing; k++) {
        const Passing *passing = &kind->list[cell->first + k];
        const double x = kind->start[passing->node] - apart;
        if (!add_node(joint, kind->nodes[passing->node], passing->segment, x, 1.0, order, sums, why))
            return false;
    }
    return true;
}

/* Outputs */

/* Arguments of `outputs` from the sums, or their rates from those; `order` 0 or 1 says which. */
static void fill(const Sums *sums, int order, double factor, double *x)
{
    for (int k = 0; k < 4; k++)
        x[SUM_PRESSURE + k] += factor * sums->pressure[order + k];
    x[SUM_ABOUT_X] += factor * sums->about_x[order];
    x[SUM_ABOUT_Y] += factor * sums->about_y[order];
    for (int q = 0; q < N_LAW_STATE; q++)
        x[SUM_PLASTIC + q] += factor * sums->works[q][order];
}
_Static_assert(SUM_TWIST == SUM_PRESSURE + 3, "the pressure and its derivatives in their order");

bool joint_evaluate(Joint *joint, const double *inputs, double *out, Text *why)
{
    const Kind *kind = &joint->kind;
    const double apart = inputs[S_REL + 2];
    double x[N_X] = {0.0}, largest[2];
    Sums sums;
    tighten(joint, inputs);
    if (!press(joint, apart, 0, &sums, why))
        return false;
    fill(&sums, 0, 1.0, x);
    x[SUM_TIGHTENED] = kind->tightened;
    if (apart == 0.0)
        x[SUM_PRESSURE] = kind->tightened; /* the same sum, without the round-off of another order */
    memcpy(x + X_S_REL, inputs + S_REL, 6 * sizeof *x);
    curve_at(&joint->curve, kind->start[kind->tightest] - apart, 1, largest);
    x[X_P_MAX] = largest[0];
    outputs(x, joint->c, out);
    return true;
}

/* Add the rates of all arguments of `outputs` by what a seed changes at tightening, of all nodes: a moment
 * that is none yet may become one. An open node stays open. */
static bool add_tightening(const Joint *joint, const double *inputs, const double *seed, double *rates,
                           Text *why)
{
    const Curve *curve = &joint->curve;
    const double at[4] = {inputs[PRELOAD], inputs[MOMENT], seed[PRELOAD], seed[MOMENT]};
    double x[6], y[2], carried, pressure, rate, largest = -1.0;
    int segment = 0;
    Sums sums = {.pressure = {0.0}};
    bolt_pressures(at, joint->c, x + 2);
    bolt_pressures_seed(at, joint->c, x + 4);
    for (int i = 0; i < N_NODES; i++) {
        x[0] = NODES[i][EQUAL];
        x[1] = NODES[i][TILT];
        shaped_pressure(x, joint->c, &pressure);
        shaped_pressure_seed(x, joint->c, &rate);
        const double start = joint->kind.nodes == NODES
                                 ? joint->kind.start[i]
                                 : curve_inverse(curve, pressure, &segment, &carried);
        curve_at(curve, start, 1, y);
        const double approach = y[1] > 0.0 ? rate / y[1] : 0.0;
        rates[SUM_TIGHTENED] += NODES[i][SHARE] * approach * y[1];
        if (!add_any(joint, NODES[i], start - inputs[S_REL + 2], approach, &sums, why))
            return false;
        if (pressure > largest) {
            largest = pressure;
            curve_at(curve, start - inputs[S_REL + 2], 1, y);
            rates[X_P_MAX] = y[1] * approach;
        }
    }
    fill(&sums, 1, 1.0, rates);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *seed, double *result)
{
    const Kind *kind = &joint->kind;
    const double apart = inputs[S_REL + 2];
    double x[2 * N_X] = {0.0}, *rates = x + N_X, largest[2];
    Sums sums;
    Text ignored;
    text_clear(&ignored);
    tighten(joint, inputs);
    if (!press(joint, apart, 1, &sums, &ignored))
        return;
    fill(&sums, 0, 1.0, x);
    fill(&sums, 1, -seed[S_REL + 2], rates);
    if ((seed[PRELOAD] != 0.0 || seed[MOMENT] != 0.0) && !add_tightening(joint, inputs, seed, rates, &ignored))
        return;
    x[SUM_TIGHTENED] = kind->tightened;
    memcpy(x + X_S_REL, inputs + S_REL, 6 * sizeof *x);
    memcpy(rates + X_S_REL, seed + S_REL, 6 * sizeof *x);
    curve_at(&joint->curve, kind->start[kind->tightest] - apart, 1, largest);
    x[X_P_MAX] = largest[0];
    rates[X_P_MAX] -= largest[1] * seed[S_REL + 2];
    outputs_seed(x, joint->c, result);
}
