/* The list of variables, generated into variables.c for each FMU.
 *
 * Value references count the list: 0 is the time, then inputs, outputs and parameters in their order. */
#ifndef JOINTFMU_VARIABLES_H
#define JOINTFMU_VARIABLES_H

#include "data.h"  /* generated: what an FMU is beside its code */
#include "model.h" /* generated: N_INPUTS, N_OUTPUTS, N_PARAMETERS */

/* Systems define these two in model.h. */
#ifndef N_STATES
#define N_STATES 0 /* continuous states: the first outputs, positions of bodies, then their speeds; then the
                    * accelerations, so that the rate of each is the output N_BODIES after it */
#endif
#define N_BODIES (N_STATES / 2)
#ifndef MOVES
#define MOVES 0 /* 1: outputs change with time, while inputs rest */
#endif

/* Systems whose steps of co-simulation are implicit define it: implicit.c has them. */
#ifndef IMPLICIT
#define IMPLICIT 0
#endif

/* Joints that remember the path of their inputs define it too. */
#ifndef N_MEMORY
#define N_MEMORY 0 /* numbers */
#endif

/* Models that change with time define it where their course has corners. */
#ifndef N_EVENTS
#define N_EVENTS 0 /* times */
#endif

typedef struct {
    const char *name;
    const char *unit; /* SI; "" for a number without unit */
    const char *doc;
    const char *interval; /* allowed values as text, "(0, 1]" */
    double low, high;                /* allowed interval */
    unsigned char low_open, high_open; /* 1: the end itself is not allowed */
    unsigned char whole;             /* 1: whole numbers only */
    unsigned char boolean;           /* 1: a Boolean, 0 or 1 */
} Variable;

enum {
    FIRST_INPUT = 1,
    FIRST_OUTPUT = FIRST_INPUT + N_INPUTS,
    FIRST_PARAMETER = FIRST_OUTPUT + N_OUTPUTS,
    N_VALUES = FIRST_PARAMETER + N_PARAMETERS,
    FIRST_KNOWN = MOVES ? 0 : FIRST_INPUT, /* what a path goes along: inputs; of what moves, time and states too */
    N_PATH = FIRST_OUTPUT + N_STATES - FIRST_KNOWN
};

extern const Variable variables[N_VALUES]; /* by value reference; [0] is the time */

/* Outputs that depend on an input or state, and all on parameters: 1 or 0. */
extern const unsigned char depends[N_OUTPUTS][N_INPUTS + N_STATES];

#if N_STATES
extern const double nominals[N_STATES];
#endif

#endif
