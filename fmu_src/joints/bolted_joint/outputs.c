#include "outputs.h"

#include <math.h>
#include <string.h>

#include "optimize_for_size.h"

_Static_assert(SUM_NORMAL_X == SUM_NORMAL + 1 && SUM_NORMAL_Y == SUM_NORMAL + 2, "as the sums of PreloadState");
_Static_assert(SUM_SHEAR_STIFFNESS_Y == SUM_SHEAR_STIFFNESS_X + 1 &&
                   SUM_TORSIONAL_STIFFNESS == SUM_SHEAR_STIFFNESS_X + 2,
               "in this order");
_Static_assert(N_LAW_STATE == 2 && SUM_ELASTIC == SUM_PLASTIC + 1, "plastic and elastic work");

/* Points */

void sum_points(OutputSums *sums, const Contact *contact)
{
    double force[3] = {0.0}, stiffness[6] = {0.0}, work[N_LAW_STATE] = {0.0}, largest = 0.0, *x = sums->points;
    for (int i = 0; i < n_points(); i++) {
        const double *weight = contact->weight[i], p = contact->pressure[i], k = contact->stiffness[i];
        for (int d = 0; d < 3; d++)
            force[d] += weight[d] * p;
        for (int d = 0; d < 6; d++)
            stiffness[d] += weight[d] * k;
        for (int w = 0; w < N_LAW_STATE; w++)
            work[w] += weight[0] * contact->work[i][w];
        largest = p > largest ? p : largest;
    }
    sums->p_max = largest;
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
    memcpy(sums->x, x, sizeof sums->points);
}

bool evaluate_point_sums(OutputSums *sums, Contact *contact, const Bodies *bodies, const double *q, Text *reason)
{
    const double *opening = q + S_Z;
    if (sums->points_are_current && memcmp(sums->opening, opening, sizeof sums->opening) == 0) {
        memcpy(sums->x, sums->points, sizeof sums->points);
        return true;
    }
    sums->points_are_current = false;
    if (!evaluate_points(contact, bodies->state.opening, q, true, reason))
        return false;
    sum_points(sums, contact);
    memcpy(sums->opening, opening, sizeof sums->opening);
    sums->points_are_current = true;
    return true;
}

/* Add a point to the normal sums: pressure and stiffness, and what shear adds to them. */
static inline void add_normal(double *x, const double *point, double p, double k, double added_pressure,
                              double added_stiffness)
{
    const double share = point[SHARE], px = point[POSITION_X], py = point[POSITION_Y];
    const double pressure = share * p, stiffness = share * k, all = share * (p + added_pressure);
    const double normal = share * (k + added_stiffness);
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
    const double share = point[SHARE], px = point[POSITION_X], py = point[POSITION_Y];
    x[SUM_TRACTION_X] += share * traction[0];
    x[SUM_TRACTION_Y] += share * traction[1];
    x[SUM_TORSION] += share * (px * traction[1] - py * traction[0]);
}

/* Arguments and results of `elastic_shear`. */
enum { E_LIMIT, E_DERIVATIVES, E_DISPLACEMENT = E_DERIVATIVES + 4, N_E = E_DISPLACEMENT + 2 };
enum { E_TRACTION, E_TANGENT = 2, E_ADDED_PRESSURE = 5, E_ADDED_STIFFNESS, N_ELASTIC };

/* Add the shear of a point without history, or its rate. */
static inline void add_elastic_shear(double *x, const double *point, const double shear[N_ELASTIC])
{
    double stiffness[3];
    add_traction(x, point, shear + E_TRACTION);
    point_stiffness(point, shear + E_TANGENT, stiffness);
    for (int d = 0; d < 3; d++)
        x[SUM_SHEAR_STIFFNESS_X + d] += stiffness[d];
}

static inline void set_shear_arguments(double limit, const double *derivatives, const double *point, const double *q,
                                       double *x)
{
    x[E_LIMIT] = limit;
    memcpy(x + E_DERIVATIVES, derivatives, 4 * sizeof *x);
    x[E_DISPLACEMENT] = tangential_x(point, q);
    x[E_DISPLACEMENT + 1] = tangential_y(point, q);
}

bool evaluate_elastic_shear(OutputSums *sums, const Contact *contact, double mu, const double *q, Text *reason)
{
    double y[4], works[N_LAW_STATE], slopes[N_LAW_STATE], arguments[N_E], shear[N_ELASTIC], *x = sums->x;
    sums->p_max = 0.0;
    for (int i = 0; i < n_points(); i++) {
        const double *point = data.points[i];
        const double approach = contact->preload.approach[i] - opening_at(point, q);
        if (!point_state(contact, approach, 3, y, works, slopes, reason))
            return false;
        set_shear_arguments(mu * contact->preload.pressure[i], y, point, q, arguments);
        elastic_shear(arguments, contact->c, shear);
        add_normal(x, point, y[0], y[1], shear[E_ADDED_PRESSURE], shear[E_ADDED_STIFFNESS]);
        add_elastic_shear(x, point, shear);
        for (int w = 0; w < N_LAW_STATE; w++)
            x[SUM_PLASTIC + w] += point[SHARE] * works[w];
        sums->p_max = y[0] > sums->p_max ? y[0] : sums->p_max;
    }
    return true;
}

void use_preload_sums(OutputSums *sums, const Contact *contact)
{
    memcpy(sums->x + SUM_NORMAL, contact->preload.sums, sizeof contact->preload.sums);
    sums->x[SUM_PRESSURE] = contact->preload.sums[0];
}

/* Patches */

/* Add the traction of a patch, including the traction around its centre; or its rate. */
static inline void add_patch(double *x, const double *patch, const double traction[3])
{
    add_traction(x, patch, traction);
    x[SUM_TORSION] += patch[SHARE] * (patch[RADIUS] * traction[2]);
}

void sum_patches(OutputSums *sums, Friction *friction, const double *after, double area)
{
    for (int j = 0; j < n_patches() && friction->has_history; j++)
        add_patch(sums->x, data.patches[j], friction->update[j].traction);
    if (friction->has_history && !ELASTIC)
        continued_motion_stiffness(friction, sums->x + SUM_SHEAR_STIFFNESS_X);
    sums->x[SUM_LOSS] = after[HISTORY_LOSS] / area;
}

/* Energy of the curve at an approach, and its load there: as `curve_energy`, but faster inside the table. */
static inline double energy_and_load(const Contact *contact, double approach, double *load)
{
    const Curve *curve = contact->curve;
    double y[2];
    if (!(approach >= curve->start.x && approach < curve->end.x)) {
        const double energy = curve_energy(curve, approach, 1, y);
        *load = y[0];
        return energy;
    }
    const int segment = curve_find_segment(curve, approach);
    const double t = segment_parameter(curve, segment, approach);
    *load = polynomial_value(curve->segments[segment].coefficients, t);
    return segment_energy(curve, segment, t);
}

/* Arguments of `cycle_energies` and `small_cycle_energies`; seeds have rates of the arguments from L_AMPLITUDE on. */
enum {
    L_MU, L_RATIO, L_AMPLITUDE, L_LOAD, L_SLIPPED_LOAD, L_ENERGY, N_CYCLE,
    L_UPPER = L_LOAD, L_LOWER = L_UPPER + 3, N_SMALL_CYCLE = L_LOWER + 3
};

/* Repeats `is_small_amplitude` of the package. */
static inline bool is_small_amplitude(const PatchState *state, double reach)
{
    return reach * state->y[1] < SMALL_CYCLE_FORCE_OVER_LOAD * state->y[0];
}

/* Load with four derivatives at the approach of a patch, and at the height of the springs that slip last. */
static inline void cycle_ends(const Contact *contact, const PatchState *state, double reach, double upper[5],
                              double lower[5])
{
    curve_evaluate(contact->curve, state->approach, 4, upper);
    curve_evaluate(contact->curve, state->approach - reach, 4, lower);
}

static inline double patch_displacement(const Bodies *bodies, int j, const double *q, double u[3])
{
    tangential_displacement(data.patches[j], q, u);
    for (int d = 0; d < 3; d++)
        u[d] += bodies->state.patch_displacement[j][d];
    return sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
}

void sum_cycles(OutputSums *sums, const Friction *friction, const Contact *contact, const Bodies *bodies,
                const double *q)
{
    const double mu = friction->mu, ratio = friction->stiffness_ratio, per_reach = ratio / mu;
    double losses = 0.0, energies = 0.0;
    for (int j = 0; j < n_patches(); j++) {
        const PatchState *state = &friction->end[j];
        double u[3], y[2];
        const double amplitude = patch_displacement(bodies, j, q, u), reach = amplitude * per_reach;
        if (is_small_amplitude(state, reach)) {
            double upper[5], lower[5];
            cycle_ends(contact, state, reach, upper, lower);
            const double x[N_SMALL_CYCLE] = {mu, ratio, amplitude, upper[1], upper[2], upper[3],
                                             lower[1], lower[2], lower[3]};
            small_cycle_energies(x, NULL, y);
        } else {
            double slipped_load;
            const double energy = state->energy - energy_and_load(contact, state->approach - reach, &slipped_load);
            const double x[N_CYCLE] = {mu, ratio, amplitude, state->y[0], slipped_load, energy};
            cycle_energies(x, NULL, y);
        }
        losses += data.patches[j][SHARE] * y[0];
        energies += data.patches[j][SHARE] * y[1];
    }
    sums->x[SUM_LOOP_WORK] = losses;
    sums->x[SUM_LOOP_ENERGY] = energies;
}

/* Bolts between rigid members */

static void add_elongation(const double *bolt, double elongation, double *x)
{
    x[SUM_STRETCH] += elongation;
    x[SUM_STRETCH_X] += elongation * bolt[BOLT_X];
    x[SUM_STRETCH_Y] += elongation * bolt[BOLT_Y];
}

void sum_gaps(OutputSums *sums, Bolts *bolts, double area, const double *q)
{
    double inactive_sum = 0.0, about_x = 0.0, about_y = 0.0, *x = sums->x;
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double *bolt = data.bolts[b];
        elongate_bolt(bolts, b, rigid_elongation(b, q));
        add_elongation(bolt, bolts->bolts_per_position * bolts->gap[b], x);
        const double inactive_stiffness =
            bolts->bolts_per_position * (bolts->stiffness - bolts->stiffness * bolts->active_fraction[b]);
        inactive_sum += inactive_stiffness;
        about_x += inactive_stiffness * (bolt[BOLT_Y] * bolt[BOLT_Y]);
        about_y += inactive_stiffness * (bolt[BOLT_X] * bolt[BOLT_X]);
    }
    x[SUM_NORMAL_STIFFNESS] -= inactive_sum / area;
    x[SUM_NORMAL_ABOUT_X] -= about_x / area;
    x[SUM_NORMAL_ABOUT_Y] -= about_y / area;
}

void set_output_arguments(OutputSums *sums, const Contact *contact, const double *inputs)
{
    double *x = sums->x;
    memcpy(x + SUM_TIGHTENED, contact->preload.sums, sizeof contact->preload.sums);
    memcpy(x + X_S_REL, inputs + INPUT_S_REL_X, 3 * sizeof *x);
    memcpy(x + X_THETA, inputs + INPUT_THETA_X, 3 * sizeof *x);
    memcpy(x + X_RATES, inputs + INPUT_V_REL_X, 3 * sizeof *x);
    memcpy(x + X_RATES + 3, inputs + INPUT_OMEGA_X, 3 * sizeof *x);
    x[X_P_MAX] = sums->p_max;
}

OPTIMIZE_FOR_SIZE

/* Elastic members */

/* Stiffness of the joint over the area, or its rate, without the stiffness of bolts between rigid members. */
static void set_condensed(const Equilibrium *e, const double stiffness[N_DISPLACEMENTS], double bolt_stiffness,
                          double *x)
{
    static const int sums[N_DISPLACEMENTS] = {SUM_SHEAR_STIFFNESS_X, SUM_SHEAR_STIFFNESS_Y, SUM_NORMAL_STIFFNESS,
                                              SUM_NORMAL_ABOUT_X, SUM_NORMAL_ABOUT_Y, SUM_TORSIONAL_STIFFNESS};
    double bolts[N_DISPLACEMENTS] = {0.0};
    for (int b = 0; b < (int)data.n_bolt_elongation; b++) {
        bolts[S_Z] += bolt_stiffness;
        bolts[THETA_X] += bolt_stiffness * data.bolts[b][BOLT_Y] * data.bolts[b][BOLT_Y];
        bolts[THETA_Y] += bolt_stiffness * data.bolts[b][BOLT_X] * data.bolts[b][BOLT_X];
    }
    for (int d = 0; d < N_DISPLACEMENTS; d++)
        x[sums[d]] = (stiffness[d] - bolts[d]) / e->assembly.contact->area;
}

void elastic_member_sums(OutputSums *sums, const Equilibrium *e, const double *q)
{
    if (!ELASTIC)
        return;
    const Bodies *bodies = e->assembly.bodies;
    const Bolts *bolts = e->assembly.bolts;
    const double *a = bodies->state.modal_coordinates;
    double energy = 0.0;
    set_condensed(e, e->condensed, bolts->stiffness, sums->x);
    for (int b = 0; b < (int)data.n_bolt_elongation; b++)
        add_elongation(data.bolts[b], dense_dot(bodies->full_elongation_jacobian[b], a) + bolts->gap[b], sums->x);
    for (int k = 0; k < MODES; k++)
        energy += bodies->stiffness[k] * a[k] * a[k];
    for (int b = 0; b < (int)data.n_bolt_elongation; b++) {
        const double elongation = bolt_elongation(bodies, b, q, a), gap = bolts->gap[b];
        energy += bolts->stiffness * elongation * elongation - bolts->stiffness * gap * gap;
    }
    sums->x[SUM_LOOP_ENERGY] += 0.5 * energy / e->assembly.contact->area;
}

/* Rates
 *
 * Functions of rates add to dx. At a corner each side has rates of its own. */

static const double SAME_PRESSURE = 1e-11; /* relative difference of equal pressures: round-off and residual [1] */

void add_point_rates(const Contact *contact, const Friction *friction, const double *q, const double *q_rate,
                     double *dx)
{
    for (int i = 0; i < n_points(); i++) {
        const PointRate *point_rate = &contact->rate[i];
        const double *point = data.points[i], *y = point_rate->derivatives, rate = point_rate->approach;
        double shear[N_ELASTIC] = {0.0};
        if (!friction->has_history) {
            double x[2 * N_E], slopes[4];
            for (int d = 0; d < 4; d++)
                slopes[d] = y[d + 1] * rate;
            set_shear_arguments(friction->mu * contact->preload.pressure[i], y, point, q, x);
            set_shear_arguments(friction->mu * point_rate->preload_stiffness * point_rate->preload_approach, slopes,
                                point, q_rate, x + N_E);
            elastic_shear_seed(x, contact->c, shear);
            add_elastic_shear(dx, point, shear);
        }
        add_normal(dx, point, y[1] * rate, y[2] * rate, shear[E_ADDED_PRESSURE], shear[E_ADDED_STIFFNESS]);
        for (int w = 0; w < N_LAW_STATE; w++)
            dx[SUM_PLASTIC + w] += point[SHARE] * point_rate->work_slope[w] * rate;
        const double force = point[SHARE] * point_rate->preload_stiffness * point_rate->preload_approach;
        dx[SUM_TIGHTENED] += force;
        dx[SUM_TIGHTENED_X] += force * point[POSITION_X];
        dx[SUM_TIGHTENED_Y] += force * point[POSITION_Y];
    }
}

bool max_pressure_rate(const OutputSums *sums, const Contact *contact, double side, double *rate)
{
    double first = 0.0;
    bool is_known = false, is_corner = false;
    for (int i = 0; i < n_points(); i++) {
        const double *y = contact->rate[i].derivatives, pressure_rate = y[1] * contact->rate[i].approach;
        if (y[0] < (1.0 - SAME_PRESSURE) * sums->p_max)
            continue;
        if (!is_known) /* of equal pressures, take the one that increases most; on the other side, least */
            first = *rate = pressure_rate;
        is_known = true;
        is_corner = is_corner || pressure_rate != first;
        *rate = side * fmax(side * *rate, side * pressure_rate);
    }
    return is_corner;
}

void add_patch_rates(const Friction *friction, const IncrementRate *rates, double *dx)
{
    for (int j = 0; j < n_patches(); j++) {
        add_patch(dx, data.patches[j], friction->rate[j].traction);
        dx[SUM_LOSS] += data.patches[j][SHARE] * friction->rate[j].loss;
    }
    continued_motion_stiffness_rate(friction, rates, dx + SUM_SHEAR_STIFFNESS_X);
}

/* Add the rates of the cycle of a patch. */
static void add_cycle_rate(const Friction *friction, const Contact *contact, const Bodies *bodies, int j,
                           const double *q, const IncrementRate *rates, double *dx)
{
    const PatchState *state = &friction->end[j];
    const double *u_rate = rates->displacement, approach_rate = rates->ends[1];
    double u[3];
    const double amplitude = patch_displacement(bodies, j, q, u);
    if (amplitude == 0.0)
        return;
    const double mu = friction->mu, ratio = friction->stiffness_ratio, reach = mu / ratio;
    const double amplitude_rate = (u[0] * u_rate[0] + u[1] * u_rate[1] + u[2] * u_rate[2]) / amplitude;
    const double lower_rate = approach_rate - amplitude_rate / reach;
    double upper[5], lower[5], y[2], x[2 * N_SMALL_CYCLE - L_AMPLITUDE] = {mu, ratio, amplitude};
    cycle_ends(contact, state, amplitude / reach, upper, lower);
    if (is_small_amplitude(state, amplitude / reach)) {
        double *rate = x + N_SMALL_CYCLE;
        rate[0] = amplitude_rate;
        for (int d = 0; d < 3; d++) {
            x[L_UPPER + d] = upper[1 + d];
            x[L_LOWER + d] = lower[1 + d];
            rate[1 + d] = upper[2 + d] * approach_rate;
            rate[4 + d] = lower[2 + d] * lower_rate;
        }
        small_cycle_energies_seed(x, NULL, y);
    } else {
        double load[2];
        const double slipped_energy = curve_energy(contact->curve, state->approach - amplitude / reach, 1, load);
        const double energy = state->energy - slipped_energy;
        const double rate[N_CYCLE - L_AMPLITUDE] = {amplitude_rate, upper[1] * approach_rate, lower[1] * lower_rate,
                                                    upper[0] * approach_rate - lower[0] * lower_rate};
        x[L_LOAD] = upper[0];
        x[L_SLIPPED_LOAD] = lower[0];
        x[L_ENERGY] = energy;
        memcpy(x + N_CYCLE, rate, sizeof rate);
        cycle_energies_seed(x, NULL, y);
    }
    dx[SUM_LOOP_WORK] += data.patches[j][SHARE] * y[0];
    dx[SUM_LOOP_ENERGY] += data.patches[j][SHARE] * y[1];
}

void add_cycle_rates(const Friction *friction, const Contact *contact, const Bodies *bodies, const double *q,
                     const IncrementRate *rates, double *dx)
{
    for (int j = 0; j < n_patches(); j++)
        add_cycle_rate(friction, contact, bodies, j, q, &rates[j], dx);
}

void add_gap_rates(const Bolts *bolts, const double *q_rate, double *dx)
{
    for (int b = 0; b < (int)data.n_bolts; b++)
        add_elongation(data.bolts[b],
                       bolts->bolts_per_position * bolt_gap_rate(bolts, b, rigid_elongation(b, q_rate)), dx);
}

/* Rates of the condensed stiffness. It is stationary in the modal rates, so only changes of the tangents matter. */
static void condensed_rates(const Equilibrium *e, double rates[N_DISPLACEMENTS])
{
    const Bodies *bodies = e->assembly.bodies;
    for (int d = 0; d < N_DISPLACEMENTS; d++) {
        const double *z = e->end.modal_rates[d];
        double q[N_DISPLACEMENTS] = {0.0}, sum = 0.0;
        q[d] = 1.0;
        for (int i = 0; i < n_points(); i++) {
            const PointRate *rate = &e->assembly.contact->rate[i];
            const double u = opening_at(data.points[i], q) + dense_dot(bodies->full_opening_jacobian[i], z);
            sum += data.points[i][SHARE] * (rate->derivatives[2] * rate->approach) * u * u;
        }
        for (int j = 0; j < n_patches(); j++) {
            const double *t = e->assembly.friction->rate[j].tangent;
            double rigid[3];
            tangential_displacement(data.patches[j], q, rigid);
            const double u = rigid[0] + dense_dot(bodies->full_tangential_jacobian[0][j], z);
            const double v = rigid[1] + dense_dot(bodies->full_tangential_jacobian[1][j], z);
            const double w = rigid[2] + dense_dot(bodies->full_tangential_jacobian[2][j], z);
            sum += data.patches[j][SHARE] * (t[0] * u * u + t[2] * v * v + t[5] * w * w +
                                             2.0 * (t[1] * u * v + t[3] * u * w + t[4] * v * w));
        }
        rates[d] = e->assembly.contact->area * sum;
    }
}

void add_elastic_member_rates(const Equilibrium *e, const double *q, const double *q_rate, double *dx)
{
    if (!ELASTIC)
        return;
    const Bodies *bodies = e->assembly.bodies;
    const Bolts *bolts = e->assembly.bolts;
    const double *a = bodies->state.modal_coordinates, *a_rate = bodies->rate.modal_coordinates;
    double rates[N_DISPLACEMENTS], gap_rates[MAX_BOLT_ELONGATION], energy = 0.0;
    condensed_rates(e, rates);
    set_condensed(e, rates, 0.0, dx);
    for (int b = 0; b < (int)data.n_bolt_elongation; b++)
        gap_rates[b] = bolt_gap_rate(bolts, b, bolt_elongation(bodies, b, q_rate, a_rate));
    for (int b = 0; b < (int)data.n_bolt_elongation; b++)
        add_elongation(data.bolts[b], dense_dot(bodies->full_elongation_jacobian[b], a_rate) + gap_rates[b], dx);
    for (int k = 0; k < MODES; k++)
        energy += bodies->stiffness[k] * a[k] * a_rate[k];
    for (int b = 0; b < (int)data.n_bolt_elongation; b++)
        energy += bolts->stiffness * bolt_elongation(bodies, b, q, a) * bolt_elongation(bodies, b, q_rate, a_rate) -
                  bolts->stiffness * bolts->gap[b] * gap_rates[b];
    dx[SUM_LOOP_ENERGY] += energy / e->assembly.contact->area;
}

void bolt_force_rates(const Equilibrium *e, const double *q_rate, double *rates)
{
    const Bodies *bodies = e->assembly.bodies;
    const Bolts *bolts = e->assembly.bolts;
    for (int b = 0; b < (int)data.n_bolt_elongation && ELASTIC; b++) {
        const double rate = bolt_elongation(bodies, b, q_rate, bodies->rate.modal_coordinates);
        rates[b] = bolts->preload_rate[b] + bolts->stiffness * (rate + bolt_gap_rate(bolts, b, rate));
    }
}

END_OPTIMIZE_FOR_SIZE
