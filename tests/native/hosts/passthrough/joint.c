#include "joint.h"

#include "variables.h"

struct Joint {
    double gain;
};

size_t joint_size(void)
{
    return sizeof(Joint);
}

bool joint_tabulate(Joint *joint, const double *parameters, Text *why)
{
    (void)why;
    joint->gain = parameters[0];
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *outputs,
                    Text *why)
{
    (void)memory, (void)after, (void)why;
    for (int i = 0; i < N_OUTPUTS; i++)
        outputs[i] = joint->gain * inputs[i % N_INPUTS];
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    (void)after;
    (void)memory, (void)inputs;
    for (int i = 0; i < N_OUTPUTS; i++)
        result[i] = joint->gain * seed[i % N_INPUTS];
}

unsigned joint_outside(Joint *joint, const double *inputs, const double *outputs)
{
    (void)joint;
    (void)inputs;
    (void)outputs;
    return 0;
}

void joint_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)joint;
    (void)inputs;
    (void)outputs;
    (void)bit;
    (void)text;
}
