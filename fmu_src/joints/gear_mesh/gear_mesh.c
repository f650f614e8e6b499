/* Repeats `tabulate_tooth_pair` of the package, and the energy of a tooth pair; the functions of the law are
 * generated. */
#include "gear_mesh.h"

#include <math.h>
#include <string.h>

#include "tabulated_joint.h"

_Static_assert(N_LAW_STATE == 0, "the mesh needs the curve of the flanks only");
_Static_assert(TOOTH_PAIR_CLOSING_STEPS % 2 == 0, "the error of a curve is measured on pairs of segments");

static bool tabulate_flanks(Joint *joint, int steps, Text *reason)
{
    JointModel *model = &joint->model;
    return tabulate_approach(&model->approach, &joint->curve, &model->spots, joint->constants, steps, reason);
}

/* Node of a tooth pair at an approach of its flanks: pressure[0], its derivative pressure[1] and second derivative
 * `pressure_curvature` there. */
static Node pair_node(const Joint *joint, double approach, const double *pressure, double pressure_curvature)
{
    const double x[4] = {approach, pressure[0], pressure[1], pressure_curvature};
    double y[4];
    combine_flanks_and_teeth(x, joint->constants, y);
    return (Node){.x = y[0], .y = y[1], .stiffness = y[2], .stiffness_slope = y[3]};
}

/* Add the node of the pair at a displacement x of the flanks' table, in the piece that ends with its node
 * `last_node`. */
static bool add_node(Joint *joint, double x, bool is_first, int last_node)
{
    const Curve *flanks = &joint->model.flanks;
    double pressure[3], below[3];
    curve_evaluate(flanks, x, 2, pressure);
    segment_derivatives(flanks, last_node - 1, 1.0, 2, below); /* a regime may end there: derivatives from below */
    const double pressure_curvature = x == flanks->segments[last_node].x ? below[2] : pressure[2];
    const Node node = pair_node(joint, x - flanks->segments[0].x, pressure, pressure_curvature);
    if (!is_first)
        return curve_add_node(&joint->curve, node);
    curve_begin_piece(&joint->curve, node);
    return true;
}

/* Add the closing of the contact, with steps that shrink towards first contact. */
static bool tabulate_closing(Joint *joint, int divisions)
{
    const Curve *flanks = &joint->model.flanks;
    const int steps = TOOTH_PAIR_CLOSING_STEPS * divisions;
    for (int i = 0; i <= steps; i++) {
        const double t = (double)i / steps;
        if (!add_node(joint, (1.0 - t * t) * flanks->segments[0].x, i == 0, CONTACT_CLOSING_STEPS))
            return false;
    }
    return true;
}

/* Add the piece from node `first_node` to `last_node` of the flanks; each of their steps is divided into
 * `divisions`. */
static bool add_piece(Joint *joint, int first_node, int last_node, int divisions)
{
    const Segment *segments = joint->model.flanks.segments;
    bool is_first = true;
    for (int i = first_node; i < last_node; i++) {
        const double x = segments[i].x, length = segments[i + 1].x - x;
        for (int division = 0; division < divisions; division++) {
            if (!add_node(joint, x + length * division / divisions, is_first, last_node))
                return false;
            is_first = false;
        }
    }
    return add_node(joint, segments[last_node].x, is_first, last_node);
}

/* Node of the flanks at a pressure. */
static int find_pressure_node(const Curve *flanks, double pressure)
{
    int i = 0;
    while (i < flanks->n - 2 &&
           0.5 * (flanks->segments[i].coefficients[0] + flanks->segments[i + 1].coefficients[0]) < pressure)
        i++;
    return i;
}

/* End nodes of the n pieces of the flanks' table beyond the closing; in between, the derivative of the stiffness is
 * continuous. Returns n; `nodes` has n + 1 nodes. */
static int find_pieces(const JointModel *model, const double *c, int *nodes)
{
    const SpotDistribution *spots = &model->spots;
    const double min_pressure = model->flanks.segments[CONTACT_CLOSING_STEPS].coefficients[0];
    const double max_pressure = model->flanks.end.y;
    int n = 0;
    nodes[0] = CONTACT_CLOSING_STEPS;
    for (int i = 0; i < spots->n_regime_ends; i++) {
        double y[N_LAW_TOTALS];
        spot_totals(spots, c, spots->regime_ends[i], y);
        const double pressure = y[0] / spots->nominal_area;
        const int node = find_pressure_node(&model->flanks, pressure);
        if (pressure > min_pressure && pressure < max_pressure && node > nodes[n] && node < model->flanks.n - 1)
            nodes[++n] = node;
    }
    nodes[++n] = model->flanks.n - 1;
    return n;
}

static bool tabulate_pair(Joint *joint, int divisions, Text *reason)
{
    int nodes[N_LAW_REGIME_ENDS + 2];
    const int n_pieces = find_pieces(&joint->model, joint->constants, nodes);
    const int n_segments = TOOTH_PAIR_CLOSING_STEPS + nodes[n_pieces] - nodes[0]; /* before they are divided */
    if (!curve_begin(&joint->curve, n_segments * divisions + 1, 0, joint->model.flanks.error, reason) ||
        !tabulate_closing(joint, divisions))
        return false;
    for (int i = 0; i < n_pieces; i++)
        if (!add_piece(joint, nodes[i], nodes[i + 1], divisions))
            return false;
    curve_finish(&joint->curve);
    return true;
}

bool tabulate_model(Joint *joint, Text *reason)
{
    JointModel *model = &joint->model;
    if (!set_spot_distribution(&model->spots, joint->constants, reason) ||
        !refine_curve(joint, tabulate_flanks, APPROACH_STEPS, reason))
        return false;
    const double closed[2] = {model->approach.closing_end_pressure, 0.0};
    model->flanks = joint->curve;
    memset(&joint->curve, 0, sizeof joint->curve);
    model->closing_end_deflection = pair_node(joint, -model->flanks.segments[0].x, closed, 0.0).x;
    const bool is_accurate = refine_curve(joint, tabulate_pair, 1, reason);
    curve_free(&model->flanks);
    if (is_accurate)
        tabulate_energy(&joint->curve);
    return is_accurate;
}

/* Tooth pair at a deflection: load, stiffness and energy x; load and its derivatives y up to `order`. */
static void evaluate_pair(const Joint *joint, double deflection, int order, double *x, double *y)
{
    x[2] = curve_energy(&joint->curve, deflection, order, y);
    x[0] = y[0];
    x[1] = y[1];
}

enum {
    N_PAIR_RESULTS = 3,
    N_OUTPUT_ARGUMENTS = 1 + N_INPUTS + N_PAIR_RESULTS
}; /* arguments of `outputs`: closing_end_deflection, inputs, results of `evaluate_pair` */

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *out, Text *reason)
{
    double deflection, x[N_OUTPUT_ARGUMENTS], y[2];
    (void)history, (void)history_end, (void)n_outputs, (void)reason;
    curve_argument(inputs, joint->constants, &deflection);
    x[0] = joint->model.closing_end_deflection;
    for (int i = 0; i < N_INPUTS; i++)
        x[1 + i] = inputs[i];
    evaluate_pair(joint, deflection, 1, &x[1 + N_INPUTS], y);
    outputs(x, joint->constants, out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history_end;
    double deflection, rate, inputs_and_seed[2 * N_INPUTS], x[2 * N_OUTPUT_ARGUMENTS - 1], y[3];
    double *x_rate = &x[N_OUTPUT_ARGUMENTS]; /* rates of all arguments except closing_end_deflection */
    (void)history, (void)n_outputs;
    for (int i = 0; i < N_INPUTS; i++) {
        x[1 + i] = inputs_and_seed[i] = inputs[i];
        x_rate[i] = inputs_and_seed[N_INPUTS + i] = seed[i];
    }
    x[0] = joint->model.closing_end_deflection;
    curve_argument(inputs, joint->constants, &deflection);
    curve_argument_seed(inputs_and_seed, joint->constants, &rate);
    evaluate_pair(joint, deflection, 2, &x[1 + N_INPUTS], y);
    x_rate[N_INPUTS] = y[1] * rate;
    x_rate[N_INPUTS + 1] = y[2] * rate;
    x_rate[N_INPUTS + 2] = y[0] * rate;
    outputs_seed(x, joint->constants, result);
}
