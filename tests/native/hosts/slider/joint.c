#include "joint.h"

#include <math.h>

#include "variables.h"

enum { FORCE, PLACE, LOSS }; /* indices of the history variables */

struct Joint {
    double k, limit;
};

size_t joint_size(void)
{
    return sizeof(Joint);
}

void joint_free_tables(Joint *joint)
{
    (void)joint;
}

bool joint_tabulate(Joint *joint, const Data *joint_data, const double *parameters, Text *reason)
{
    (void)joint_data, (void)reason;
    *joint = (Joint){parameters[0], parameters[1]};
    return true;
}

/* Force and loss after the path to u; returns the stiffness there. */
static double move(const Joint *joint, double u, const double *history, double *force, double *loss)
{
    const double trial = history[FORCE] + joint->k * (u - history[PLACE]);
    const bool slips = fabs(trial) > joint->limit;
    *force = slips ? copysign(joint->limit, trial) : trial;
    *loss = history[LOSS] + *force * (trial - *force) / joint->k;
    return slips ? 0.0 : joint->k;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *outputs, Text *reason)
{
    (void)n_outputs, (void)reason;
    outputs[1] = move(joint, inputs[0], history, &outputs[0], &outputs[2]);
    history_end[FORCE] = outputs[0];
    history_end[LOSS] = outputs[2];
    history_end[PLACE] = inputs[0];
    outputs[0] += inputs[1];
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history_end, (void)n_outputs;
    double force, loss;
    const double stiffness = move(joint, inputs[0], history, &force, &loss);
    result[0] = stiffness * seed[0] + seed[1];
    result[1] = 0.0;
    result[2] = stiffness > 0.0 ? 0.0 : force * seed[0];
}

unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *outputs)
{
    (void)joint, (void)inputs, (void)outputs;
    return 0;
}

void joint_describe_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)joint, (void)inputs, (void)outputs, (void)bit, (void)text;
}
