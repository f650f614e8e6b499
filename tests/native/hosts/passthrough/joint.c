#include "joint.h"

#include "variables.h"

struct Joint {
    double gain;
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
    joint->gain = parameters[0];
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *outputs, Text *reason)
{
    (void)history, (void)history_end, (void)n_outputs, (void)reason;
    for (int i = 0; i < N_OUTPUTS; i++)
        outputs[i] = joint->gain * inputs[i % N_INPUTS];
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history_end;
    (void)history, (void)inputs, (void)n_outputs;
    for (int i = 0; i < N_OUTPUTS; i++)
        result[i] = joint->gain * seed[i % N_INPUTS];
}

unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *outputs)
{
    (void)joint;
    (void)inputs;
    (void)outputs;
    return 0;
}

void joint_describe_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)joint;
    (void)inputs;
    (void)outputs;
    (void)bit;
    (void)text;
}
