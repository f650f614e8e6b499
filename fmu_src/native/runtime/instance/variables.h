/* Variables of the FMU, generated into variables.c.
 *
 * The value reference of a variable is its index: 0 is the time, then inputs, outputs and parameters in their order. */
#ifndef JOINTFMU_VARIABLES_H
#define JOINTFMU_VARIABLES_H

#include "data.h"  /* generated: data of the FMU, separate from its code */
#include "model.h" /* generated: N_INPUTS, N_OUTPUTS, N_PARAMETERS */

/* Systems and bodies define these two in model.h. */
#ifndef N_STATES
#define N_STATES \
    0 /* continuous states: the first outputs, positions of bodies, then their speeds; the accelerations
                    * follow, so that the derivative of a state is the output N_BODIES after it */
#endif
#define N_BODIES (N_STATES / 2)
#ifndef IS_TIME_DEPENDENT
#define IS_TIME_DEPENDENT 0 /* 1: outputs change with time at constant inputs */
#endif

/* 1: steps of co-simulation are implicit, see implicit.c; systems define it. */
#ifndef HAS_IMPLICIT_STEP
#define HAS_IMPLICIT_STEP 0
#endif

/* Number of history variables; joints whose outputs depend on the path of the inputs define it. */
#ifndef N_HISTORY
#define N_HISTORY 0
#endif

/* Number of time events; models whose outputs over time have corners define it. */
#ifndef N_TIME_EVENTS
#define N_TIME_EVENTS 0
#endif

typedef struct {
    const char *name;
    const char *unit; /* SI; "" for a number without unit */
    const char *doc;
    const char *interval;              /* allowed values as text, such as "(0, 1]" */
    double low, high;                  /* bounds of the allowed values */
    double margin;                     /* of an input: at most this much below `low` counts as `low` */
    unsigned char low_open, high_open; /* 1: the bound itself is not allowed */
    unsigned char is_integer;          /* 1: only integers are allowed */
    unsigned char is_boolean;          /* 1: Boolean, 0 or 1 */
} Variable;

enum {
    FIRST_INPUT = 1,
    FIRST_OUTPUT = FIRST_INPUT + N_INPUTS,
    FIRST_PARAMETER = FIRST_OUTPUT + N_OUTPUTS,
    N_VALUES = FIRST_PARAMETER + N_PARAMETERS,
    FIRST_PATH_VARIABLE = IS_TIME_DEPENDENT
        ? 0
        : FIRST_INPUT, /* variables of a load step: inputs; of a time-dependent model also time and states */
    N_PATH_VARIABLES = FIRST_OUTPUT + N_STATES - FIRST_PATH_VARIABLE
};

extern const Variable variables[N_VALUES]; /* by value reference; [0] is the time */

/* 1: the output depends on the input or state, else 0. All outputs depend on the parameters. */
extern const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS + N_STATES];

#if N_STATES
extern const double state_nominals[N_STATES];
#endif

#endif
