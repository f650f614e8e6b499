#include "joint.h"

#include <math.h>

#include "variables.h"

struct Joint {
    double k, n;
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
    (void)joint_data;
    joint->k = NAN; /* nothing is right until all is */
    if (parameters[0] > 1.9 && parameters[2] > 100.0) {
        text_append(reason, "D = ");
        text_append_number(reason, parameters[0], 10);
        text_append(reason, " is too rough for n = ");
        text_append_number(reason, parameters[2], 10);
        text_append(reason, ", allowed is D <= 1.9");
        return false;
    }
    joint->k = parameters[1] * (parameters[3] != 0.0 ? 2.0 : 1.0);
    joint->n = parameters[2];
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *outputs, Text *reason)
{
    const double preload = inputs[0], phi = inputs[1];
    (void)history, (void)history_end, (void)n_outputs;
    if (phi == 42.0) {
        text_append(reason, "phi = 42 rad is not possible, allowed is any other angle");
        return false;
    }
    outputs[0] = joint->k * (phi + phi * phi * phi) + preload;
    outputs[1] = preload * preload;
    outputs[2] = joint->n * joint->k;
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history_end;
    (void)history, (void)n_outputs;
    result[0] = joint->k * (1.0 + 3.0 * inputs[1] * inputs[1]) * seed[1] + seed[0];
    result[1] = 2.0 * inputs[0] * seed[0];
    result[2] = 0.0;
}

unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *outputs)
{
    (void)joint;
    (void)outputs;
    return (inputs[1] > 10.0 ? 1u : 0u) | (inputs[0] > 1e6 ? 4u : 0u);
}

void joint_describe_warning(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text)
{
    (void)joint;
    (void)outputs;
    text_append(text, bit == 1 ? "phi = " : "preload = ");
    text_append_number(text, bit == 1 ? inputs[1] : inputs[0], 6);
    text_append(text, " is beyond the tabulated law");
}
