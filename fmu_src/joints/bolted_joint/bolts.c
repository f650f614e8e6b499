#include "bolts.h"

#include <math.h>

#include "tabulated_joint.h"

void bolts_tighten(Joint *joint, const double *inputs)
{
    JointModel *model = &joint->model;
    double left;
    working_preload(inputs + INPUT_PRELOAD, joint->constants, &left);
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double force = left + inputs[INPUT_MOMENT] * (data.bolts[b][BOLT_LEVER] / model->bolt_count);
        model->bolt_tightened[b] = fmax(force, 0.0);
        model->bolt_unloaded[b] = force < 0.0;
    }
}

void bolts_tighten_rates(Joint *joint, const double *inputs, const double *seed)
{
    JointModel *model = &joint->model;
    double left;
    working_preload_seed((const double[]){inputs[INPUT_PRELOAD], seed[INPUT_PRELOAD]}, joint->constants, &left);
    for (int b = 0; b < (int)data.n_bolts; b++)
        model->bolt_tightening[b] =
            model->bolt_unloaded[b] ? 0.0 : left + seed[INPUT_MOMENT] * (data.bolts[b][BOLT_LEVER] / model->bolt_count);
}

void bolt_elongate(JointModel *model, int b, double elongation)
{
    const double force = model->bolt_tightened[b] + model->bolt * elongation;
    const double lift_off = BOLT_LIFT_OFF_RATIO * model->approach.closing_end_pressure * model->area;
    model->bolt_gap[b] = model->bolt == 0.0 ? 0.0 : fmax(-force, 0.0) / model->bolt;
    model->bolt_force[b] = fmax(force, 0.0);
    model->bolt_pulls[b] = force > lift_off ? 1.0 : (force < -lift_off ? 0.0 : BOLT_AT_LIFT_OFF);
}

double bolt_gap_rate(const JointModel *model, int b, double rate)
{
    const double pulls = model->bolt_pulls[b];
    if (model->bolt == 0.0 || pulls == 1.0)
        return 0.0;
    /* at lift-off without motion the preload only grows, and leaves no gap */
    return -(1.0 - pulls) * rate - (pulls == 0.0 ? model->bolt_tightening[b] / model->bolt : 0.0);
}

static void add_gap(const double *bolt, double gap, double *x)
{
    x[SUM_STRETCH] += gap;
    x[SUM_STRETCH_X] += gap * bolt[BOLT_X];
    x[SUM_STRETCH_Y] += gap * bolt[BOLT_Y];
}

void bolts_sums(Joint *joint, const double *inputs, double *x)
{
    JointModel *model = &joint->model;
    double missing = 0.0, about_x = 0.0, about_y = 0.0;
    for (int b = 0; b < (int)data.n_bolts; b++) {
        const double *bolt = data.bolts[b];
        bolt_elongate(model, b, seat(b, inputs));
        add_gap(bolt, model->bolt_count * model->bolt_gap[b], x);
        const double lost = model->bolt_count * (model->bolt - model->bolt * model->bolt_pulls[b]);
        missing += lost;
        about_x += lost * (bolt[BOLT_Y] * bolt[BOLT_Y]);
        about_y += lost * (bolt[BOLT_X] * bolt[BOLT_X]);
    }
    x[SUM_NORMAL_STIFFNESS] -= missing / model->area;
    x[SUM_NORMAL_ABOUT_X] -= about_x / model->area;
    x[SUM_NORMAL_ABOUT_Y] -= about_y / model->area;
}

void bolts_sum_rates(const Joint *joint, const double *seed, double *dx)
{
    const JointModel *model = &joint->model;
    for (int b = 0; b < (int)data.n_bolts; b++)
        add_gap(data.bolts[b], model->bolt_count * bolt_gap_rate(model, b, seat(b, seed)), dx);
}
