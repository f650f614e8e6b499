#include "joint.h"

#include <math.h>

#include "variables.h"

enum { FORCE, PLACE, LOSS }; /* of the memory */

struct Joint {
    double k, limit;
};

size_t joint_size(void)
{
    return sizeof(Joint);
}

bool joint_tabulate(Joint *joint, const double *parameters, Text *why)
{
    (void)why;
    *joint = (Joint){parameters[0], parameters[1]};
    return true;
}

/* Force and loss after the way to u; the stiffness there. */
static double move(const Joint *joint, double u, const double *memory, double *force, double *loss)
{
    const double trial = memory[FORCE] + joint->k * (u - memory[PLACE]);
    const bool slips = fabs(trial) > joint->limit;
    *force = slips ? copysign(joint->limit, trial) : trial;
    *loss = memory[LOSS] + *force * (trial - *force) / joint->k;
    return slips ? 0.0 : joint->k;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *outputs,
                    Text *why)
{
    (void)why;
    outputs[1] = move(joint, inputs[0], memory, &outputs[0], &outputs[2]);
    after[FORCE] = outputs[0];
    after[LOSS] = outputs[2];
    after[PLACE] = inputs[0];
    outputs[0] += inputs[1];
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    (void)after;
    double force, loss;
    const double stiffness = move(joint, inputs[0], memory, &force, &loss);
    result[0] = stiffness * seed[0] + seed[1];
    result[1] = 0.0;
    result[2] = stiffness > 0.0 ? 0.0 : force * seed[0];
}

unsigned joint_outside(Joint *joint, const double *inputs, const double *outputs)
{
    (void)joint, (void)inputs, (void)outputs;
    return 0;
}

void joint_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)joint, (void)inputs, (void)outputs, (void)bit, (void)text;
}
