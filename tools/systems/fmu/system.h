/* A system of components as one model: loads over time, joints, bodies, and the wires between them.
 *
 * A component is a model with functions of its own (joint.h). It looks at a row of values, its time, inputs and
 * outputs side by side; each input is fed by a value of the system, or is zero. */
#ifndef JOINTFMU_SYSTEM_H
#define JOINTFMU_SYSTEM_H

#include "joint.h"
#include "variables.h"

typedef struct {
    const char *name;
    size_t (*size)(void);
    bool (*tabulate)(Joint *joint, const double *parameters, Text *why);
    bool (*evaluate)(Joint *joint, const double *inputs, const double *memory, double *after, double *outputs,
                     Text *why);
    void (*derivative)(Joint *joint, const double *inputs, const double *memory, const double *after,
                       const double *seed, double *result);
    unsigned (*outside)(Joint *joint, const double *inputs, const double *outputs);
    void (*warning)(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text);
    void (*events)(Joint *joint, double *times); /* NULL: there are none */
    unsigned n_inputs, n_outputs, n_states, n_events;
    unsigned parameters; /* number of the first one in the system's */
    unsigned memory;     /* place of its own in the system's */
    unsigned row;        /* place of its values: time, inputs, outputs */
    unsigned wire;       /* place of its inputs, then its outputs, in `wires` */
    unsigned warnings;   /* bit of its first warning */
} Component;

/* In the order in which they are evaluated; bodies come last and have the states of their own number. */
extern const Component components[N_COMPONENTS];
/* What feeds each input: value reference, 0 for nothing; and where each output goes. */
extern const unsigned short wires[N_WIRES];

/* What an implicit step needs (implicit.c); in the heap, as it grows with the system. */
typedef struct {
    double at[2][FIRST_PARAMETER]; /* values at the middle and at the end of a step */
    double seed[N_INPUTS + N_STATES], change[N_OUTPUTS];
    double tangents[N_BODIES][N_STATES]; /* of accelerations by places and speeds */
    bool tangents_known;
    double shrinks; /* by which a correction of Newton's method was smaller than the one before */
    double matrix[N_STATES][N_STATES], rest[N_STATES]; /* of Newton's method */
    unsigned short pivot[N_STATES];
    double scale[N_BODIES]; /* of the speeds */
    double tolerance;       /* of them, relative */
    double states[4][N_STATES + N_BODIES];
    double accelerations[2 * N_BODIES], known[2 * N_BODIES]; /* at the middle and the end of a step */
    double memory[4][N_MEMORY + 1];
    double times[N_EVENTS + 1];
    size_t worst; /* number of the acceleration that Newton's method changed most */
    Text why;     /* of the last evaluation, if it was refused */
} Work;

struct Joint {
    Joint *part[N_COMPONENTS];
    double rows[N_ROWS];   /* values of all components, as the last evaluation left them */
    double slopes[N_ROWS]; /* their derivatives along a seed */
    Work work;
    double room[]; /* of the components' own joints */
};

#endif
