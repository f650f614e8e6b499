/* A model of equations, without tables: a partner of the joints in a system (inertia, mass, source), or a
 * joint that has none. The list of variables is one array, so that time, inputs and states stand in one row. */
#include <string.h>

#include "joint.h"
#include "law.h"
#include "variables.h"

enum { N_KNOWNS = FIRST_OUTPUT + N_STATES };

struct Joint {
    double c[N_CONSTANTS]; /* the parameters, those that are fixed, then what follows from them alone */
};

size_t joint_size(void)
{
    return sizeof(Joint);
}

bool joint_tabulate(Joint *joint, const double *parameters, Text *why)
{
    (void)why;
    memcpy(joint->c, parameters, N_PARAMETERS * sizeof(double));
    memcpy(joint->c + N_PARAMETERS, data.fixed, N_FIXED * sizeof(double));
    law_constants(joint->c, 0, joint->c + N_PARAMETERS + N_FIXED);
    return true;
}

bool joint_evaluate(Joint *joint, const double *inputs, const double *memory, double *after, double *out,
                    Text *why)
{
    double known[N_KNOWNS], found[N_OUTPUTS];
    (void)memory, (void)after, (void)why;
    memcpy(known, inputs - FIRST_INPUT, FIRST_OUTPUT * sizeof(double));
    memcpy(known + FIRST_OUTPUT, out, N_STATES * sizeof(double));
    outputs(known, joint->c, found);
    memcpy(out, found, sizeof found);
    return true;
}

void joint_derivative(Joint *joint, const double *inputs, const double *memory, const double *after,
                      const double *seed, double *result)
{
    (void)after;
    double x[2 * N_KNOWNS];
    (void)memory;
    memcpy(x, inputs - FIRST_INPUT, N_KNOWNS * sizeof(double));
    x[N_KNOWNS] = 0.0; /* the time stands still */
    memcpy(x + N_KNOWNS + 1, seed, (N_KNOWNS - 1) * sizeof(double));
    outputs_seed(x, joint->c, result);
}

#if N_EVENTS
void joint_events(Joint *joint, double *times)
{
    events(NULL, joint->c, times);
}
#endif

unsigned joint_outside(Joint *joint, const double *inputs, const double *out)
{
    (void)joint, (void)inputs, (void)out;
    return 0;
}

void joint_warning(Joint *joint, const double *inputs, const double *out, unsigned bit, Text *text)
{
    (void)joint, (void)inputs, (void)out, (void)bit, (void)text;
}
