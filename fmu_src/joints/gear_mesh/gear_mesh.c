/* Repeats `pair_curve` of the package, and its energy; the laws in it are generated. */
#include "gear_mesh.h"

#include <math.h>

#include "tabulated.h"

_Static_assert(N_LAW_STATE == 0, "the flanks' curve alone");
_Static_assert(PAIR_CLOSING_STEPS % 2 == 0, "the error of a curve is measured on pairs of segments");

static bool tabulate_flanks(Joint *joint, int steps, Text *why)
{
    Kind *kind = &joint->kind;
    return approach_tabulate(&kind->approach, &joint->curve, &kind->spots, joint->c, steps, why);
}

/* Node of a pair at an approach of its flanks; `bend` is that of their pressure. */
static Node pair_node(const Joint *joint, double approach, const double *pressure, double bend)
{
    const double x[4] = {approach, pressure[0], pressure[1], bend};
    double y[4];
    in_series(x, joint->c, y);
    return (Node){.x = y[0], .y = y[1], .s = y[2], .bend = y[3]};
}

/* A node of the pair's piece that ends with a node of the flanks, at a displacement of their table. */
static bool add_node(Joint *joint, double x, bool begins, int last)
{
    const Curve *flanks = &joint->kind.flanks;
    double pressure[3], below[3];
    curve_at(flanks, x, 2, pressure);
    curve_derivatives(flanks, last - 1, 1.0, 2, below); /* a regime may end there */
    const double bend = x == flanks->x[last] ? below[2] : pressure[2];
    const Node node = pair_node(joint, x - flanks->x[0], pressure, bend);
    if (!begins)
        return curve_add(&joint->curve, node);
    curve_piece(&joint->curve, node);
    return true;
}

/* While the contact closes, with steps that shrink towards first touch. */
static bool add_closing(Joint *joint, int parts)
{
    const Curve *flanks = &joint->kind.flanks;
    const int steps = PAIR_CLOSING_STEPS * parts;
    for (int i = 0; i <= steps; i++) {
        const double t = (double)i / steps;
        if (!add_node(joint, (1.0 - t * t) * flanks->x[0], i == 0, CLOSING_STEPS))
            return false;
    }
    return true;
}

/* From one node of the flanks to another, each of their steps in so many parts. */
static bool add_piece(Joint *joint, int first, int last, int parts)
{
    const double *x = joint->kind.flanks.x;
    bool begins = true;
    for (int i = first; i < last; i++)
        for (int part = 0; part < parts; part++) {
            if (!add_node(joint, x[i] + (x[i + 1] - x[i]) * part / parts, begins, last))
                return false;
            begins = false;
        }
    return add_node(joint, x[last], begins, last);
}

/* Node of the flanks that carries a pressure. */
static int node_of(const Curve *flanks, double pressure)
{
    int i = 0;
    while (i < flanks->n - 2 && 0.5 * (flanks->a[i][0] + flanks->a[i + 1][0]) < pressure)
        i++;
    return i;
}

/* Nodes of the flanks between which their bend does not jump, once closed: n + 1 of them. */
static int find_pieces(const Kind *kind, const double *c, int *nodes)
{
    const Spots *spots = &kind->spots;
    const double least = kind->flanks.a[CLOSING_STEPS][0], most = kind->flanks.end.y;
    int n = 0;
    nodes[0] = CLOSING_STEPS;
    for (int i = 0; i < spots->n_ends; i++) {
        double y[N_LAW_TABLE];
        spots_table(spots, c, spots->ends[i], y);
        const double pressure = y[0] / spots->area;
        const int node = node_of(&kind->flanks, pressure);
        if (pressure > least && pressure < most && node > nodes[n] && node < kind->flanks.n - 1)
            nodes[++n] = node;
    }
    nodes[++n] = kind->flanks.n - 1;
    return n;
}

static bool tabulate_pair(Joint *joint, int parts, Text *why)
{
    int nodes[N_LAW_ENDS + 2];
    const int pieces = find_pieces(&joint->kind, joint->c, nodes);
    (void)why;
    curve_begin(&joint->curve, joint->kind.flanks.error);
    if (!add_closing(joint, parts))
        return false;
    for (int i = 0; i < pieces; i++)
        if (!add_piece(joint, nodes[i], nodes[i + 1], parts))
            return false;
    curve_finish(&joint->curve);
    return true;
}

bool kind_tabulate(Joint *joint, Text *why)
{
    Kind *kind = &joint->kind;
    if (!spots_begin(&kind->spots, joint->c, why) || !refined(joint, tabulate_flanks, APPROACH_STEPS, why))
        return false;
    kind->flanks = joint->curve;
    const double closed[2] = {kind->approach.closed, 0.0};
    kind->closing = pair_node(joint, -kind->flanks.x[0], closed, 0.0).x;
    if (!refined(joint, tabulate_pair, 1, why))
        return false;
    energy_tabulate(&kind->energy, &joint->curve);
    return true;
}

/* A pair at a deflection: load, stiffness and energy x; load and its derivatives up to an order y. */
static void look_up(const Joint *joint, double deflection, int order, double *x, double *y)
{
    const Curve *curve = &joint->curve;
    const double inside = fmin(deflection, curve->end.x), beyond = fmax(deflection - inside, 0.0);
    const int i = curve_segment(curve, inside);
    const double t = (inside - curve->x[i]) * curve->per[i];
    curve_derivatives(curve, i, t, order, y);
    x[2] = energy_inside(&joint->kind.energy, curve, i, t) + beyond * (y[0] + 0.5 * beyond * y[1]);
    y[0] += beyond * y[1];
    for (int k = 2; k <= order && beyond > 0.0; k++)
        y[k] = 0.0;
    x[0] = y[0];
    x[1] = y[1];
}

enum { N_PAIR = 3, N_GIVEN = 1 + N_INPUTS + N_PAIR }; /* closing, inputs, what look_up finds */

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *out,
                    Text *why)
{
    double deflection, x[N_GIVEN], y[2];
    (void)memory, (void)after, (void)why;
    argument(inputs, joint->c, &deflection);
    x[0] = joint->kind.closing;
    for (int i = 0; i < N_INPUTS; i++)
        x[1 + i] = inputs[i];
    look_up(joint, deflection, 1, &x[1 + N_INPUTS], y);
    outputs(x, joint->c, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    (void)after;
    double deflection, rate, at[2 * N_INPUTS], x[2 * N_GIVEN - 1], y[3];
    double *moved = &x[N_GIVEN]; /* of all but the closing */
    (void)memory;
    for (int i = 0; i < N_INPUTS; i++) {
        x[1 + i] = at[i] = inputs[i];
        moved[i] = at[N_INPUTS + i] = seed[i];
    }
    x[0] = joint->kind.closing;
    argument(inputs, joint->c, &deflection);
    argument_seed(at, joint->c, &rate);
    look_up(joint, deflection, 2, &x[1 + N_INPUTS], y);
    moved[N_INPUTS] = y[1] * rate;
    moved[N_INPUTS + 1] = y[2] * rate;
    moved[N_INPUTS + 2] = y[0] * rate;
    outputs_seed(x, joint->c, result);
}
