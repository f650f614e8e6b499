/* What the laboratory's page calls, over the functions that stand behind FMI 2 and 3 alike. Variables have the
 * value references of the FMU; results other than numbers are 0 where all went well. */
#include "instance.h"
#include "token.h" /* generated: that of the FMU */

#define SHOWN __attribute__((visibility("default")))

/* What the instances said since `lab_said`, a line each with its status in front. */
static Text said;

static void deliver(const Reporter *to, const char *name, Status status, const char *category, const char *line)
{
    (void)to, (void)name, (void)category;
    text_add(&said, status == ERROR ? "3" : status == WARNING ? "1" : "0");
    text_add(&said, line);
    text_add(&said, "\n");
}

SHOWN const char *lab_said(void)
{
    static Text told;
    told = said;
    text_clear(&said);
    return told.line;
}

SHOWN Instance *lab_new(void)
{
    const Reporter reporter = {deliver, NULL, NULL};
    return instance_new("lab_new", 3, CO_SIMULATION, "laboratory", TOKEN, false, reporter);
}

/* Numbers of the data that are no variables; the page writes those of another file before `lab_new`. */
SHOWN const double *lab_fixed(void)
{
    return data.fixed;
}

/* Back to the state after `lab_new`; tables stay as long as the parameters come back as they were. */
SHOWN void lab_reset(Instance *m)
{
    instance_reset(m);
}

SHOWN int lab_set(Instance *m, uint32_t ref, double value)
{
    if (ref >= N_VALUES || !variables[ref].boolean)
        return instance_set(m, "lab_set", &ref, 1, &value);
    const bool boolean = value != 0.0;
    return instance_set_booleans(m, "lab_set", &ref, 1, &boolean);
}

/* Check parameters and inputs; from here on steps are allowed. */
SHOWN int lab_begin(Instance *m)
{
    return instance_change(m, "lab_begin", BOTH | INSTANTIATED, INITIALIZATION) == OK
               ? (int)instance_initialize(m, "lab_begin")
               : ERROR;
}

/* A step: the path of a joint with memory goes on to the present inputs. */
SHOWN int lab_step(Instance *m, double size)
{
    return instance_step(m, "lab_step", m->now.values[0], size);
}

SHOWN double lab_get(Instance *m, uint32_t ref)
{
    double value = 0.0;
    instance_get(m, "lab_get", &ref, 1, &value);
    return value;
}

/* Derivative of an output by an input. */
SHOWN double lab_derivative(Instance *m, uint32_t output, uint32_t input)
{
    double seed = 1.0, result = 0.0;
    instance_derivative(m, "lab_derivative", &output, 1, &input, 1, &seed, &result);
    return result;
}
