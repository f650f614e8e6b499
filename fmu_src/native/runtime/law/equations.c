/* Joint functions of a model with explicit equations, without tables: a partner of the joints in a system (inertia,
 * mass, source), or a joint without tables. Time, inputs and outputs are consecutive in one array of values: the
 * arguments of `outputs` are read from it, from the time before the inputs to the states, which are the first
 * outputs. */
#include <string.h>

#include "joint.h"
#include "law.h"
#include "variables.h"

enum { N_ARGUMENTS = FIRST_OUTPUT + N_STATES };

struct Joint {
    double constants[N_CONSTANTS]; /* parameters, parameters that are no FMU variables, expressions of both */
#if HAS_JACOBIAN
    double results[N_OUTPUTS + N_WORKSPACE];
    double arguments[N_ARGUMENTS + N_BODIES]; /* time, inputs, states and accelerations of the factors below */
    double jacobian[N_JACOBIAN + N_ARGUMENTS + N_WORKSPACE]; /* factors of the derivatives; then a seed */
    bool jacobian_is_current;
#else
    double results[N_OUTPUTS];
#endif
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
    (void)reason;
    memcpy(joint->constants, parameters, N_PARAMETERS * sizeof(double));
    memcpy(joint->constants + N_PARAMETERS, joint_data->hidden_parameters, N_HIDDEN_PARAMETERS * sizeof(double));
    law_constants(joint->constants, 0, joint->constants + N_PARAMETERS + N_HIDDEN_PARAMETERS);
#if HAS_JACOBIAN
    joint->jacobian_is_current = false;
#endif
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                    double *out, Text *reason)
{
    double arguments[N_ARGUMENTS];
    (void)history, (void)history_end, (void)reason;
    memcpy(arguments, inputs - FIRST_INPUT, FIRST_OUTPUT * sizeof(double));
    memcpy(arguments + FIRST_OUTPUT, out, N_STATES * sizeof(double));
    outputs(arguments, joint->constants, n_outputs, joint->results);
    memcpy(out, joint->results, n_outputs * sizeof *out);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *history, const double *history_end,
                      const double *seed, size_t n_outputs, double *result)
{
    (void)history, (void)history_end;
#if HAS_JACOBIAN /* one evaluation for the seeds of all states */
    if (!joint->jacobian_is_current || memcmp(joint->arguments, inputs - FIRST_INPUT, sizeof joint->arguments) != 0) {
        memcpy(joint->arguments, inputs - FIRST_INPUT, sizeof joint->arguments);
        outputs_jacobian(joint->arguments, joint->constants, joint->jacobian);
        joint->jacobian_is_current = true;
    }
    memcpy(joint->jacobian + N_JACOBIAN, seed, (N_ARGUMENTS - 1) * sizeof *seed);
    outputs_jacobian_product(joint->jacobian, joint->constants, n_outputs, joint->results);
    memcpy(result, joint->results, n_outputs * sizeof *result);
#else
    double x[2 * N_ARGUMENTS];
    memcpy(x, inputs - FIRST_INPUT, N_ARGUMENTS * sizeof(double));
    x[N_ARGUMENTS] = 0.0; /* the derivative is at constant time */
    memcpy(x + N_ARGUMENTS + 1, seed, (N_ARGUMENTS - 1) * sizeof(double));
    outputs_seed(x, joint->constants, n_outputs, result);
#endif
}

#if N_TIME_EVENTS
void joint_event_times(Joint *joint, double *times)
{
    event_times(NULL, joint->constants, times);
}
#endif

unsigned joint_find_warnings(Joint *joint, const double *inputs, const double *out)
{
    (void)joint, (void)inputs, (void)out;
    return 0;
}

void joint_describe_warning(Joint *joint, const double *inputs, const double *out, unsigned bit, Text *text)
{
    (void)joint, (void)inputs, (void)out, (void)bit, (void)text;
}
