/* A system as one model: components (loads over time, joints, bodies) and the connections between them.
 *
 * Each component has its own functions (joint.h) and an array of values: time, inputs, outputs. An input has the value
 * of a variable of the system, or is zero. */
#ifndef JOINTFMU_SYSTEM_H
#define JOINTFMU_SYSTEM_H

#include "joint.h"
#include "variables.h"

typedef struct {
    const char *name;
    const Data *data;
    size_t (*size)(void);
    void (*free_tables)(Joint *joint);
    bool (*tabulate)(Joint *joint, const Data *joint_data, const double *parameters, Text *reason);
    bool (*evaluate)(Joint *joint, const double *inputs, const double *history, double *history_end, size_t n_outputs,
                     double *outputs, Text *reason);
    void (*derivative)(Joint *joint, const double *inputs, const double *history, const double *history_end,
                       const double *seed, size_t n_outputs, double *result);
    unsigned (*find_warnings)(Joint *joint, const double *inputs, const double *outputs);
    void (*describe_warning)(Joint *joint, const double *inputs, const double *outputs, unsigned bit, Text *text);
    void (*event_times)(Joint *joint, double *times); /* NULL: no time events */
    unsigned n_inputs, n_outputs, n_states, n_events;
    unsigned n_motion_outputs;  /* number of its leading outputs on which the motion of the system depends */
    unsigned first_parameter;   /* index of its first parameter among those of the system */
    unsigned first_history;     /* index of its first history variable among those of the system */
    unsigned first_value;       /* index of its values in `Joint.values`: time, inputs, outputs */
    unsigned first_connection;  /* index of its inputs, then its outputs, in `connections` */
    unsigned first_warning_bit; /* number of the bit of its first warning */
} Component;

/* Components in the order of evaluation. Bodies are last; the states of the system are those of the bodies in this
 * order. */
extern const Component components[N_COMPONENTS];
/* Number of leading outputs of the system that implicit steps need: positions, speeds and accelerations. */
enum { N_MOTION_OUTPUTS = 3 * N_BODIES };
/* Value references in the system: of each input of a component the source (0: zero), of each output the variable. */
extern const unsigned short connections[N_CONNECTIONS];

/* Work arrays of an implicit step (implicit.c); on the heap, because their size grows with the system. */
typedef struct {
    double stage_values[2][FIRST_PARAMETER]; /* values of the system at middle and end of a step */
    double seed[N_INPUTS + N_STATES], sensitivity[N_OUTPUTS];
    double acceleration_tangents[N_STATES][N_BODIES]; /* derivatives with respect to each position, each speed */
    double frequency[N_BODIES];                       /* natural frequency of each body if the others rest [rad/s] */
    bool tangents_are_current;
    double correction_ratio; /* size of the last correction of Newton's method over the one before */
    double matrix[2][N_BODIES][N_BODIES], residual[N_STATES]; /* complex linear system of Newton's method */
    double factorized_size; /* size of the half step whose matrix is factorized; 0: none */
    unsigned short pivot[N_BODIES];
    double speed_scale[N_BODIES];          /* speed that the tolerance refers to [m/s, rad/s] */
    double tolerance;                      /* relative tolerance of the speeds */
    double states[3][N_STATES + N_BODIES]; /* positions, speeds and accelerations at the ends of half steps */
    double nodes[5][N_BODIES];             /* accelerations at start, middle and end of both half steps */
    double history[3][N_HISTORY + 1];
    double times[N_TIME_EVENTS + 1];
    Text refusal; /* reason why a joint refused the last evaluation, or empty */
} StepWork;

struct Joint {
    Joint *component[N_COMPONENTS];
    double values[N_COMPONENT_VALUES]; /* of all components, in the last evaluation */
    /* Derivatives along a seed: of time (0), inputs and outputs of the system; of inputs and states of one component,
     * which are its seed, then of its outputs. */
    double variable_rates[FIRST_PARAMETER], component_rates[N_COMPONENT_VALUES + N_STATES];
    StepWork work;
    double component_joints[]; /* memory of the components' joints */
};

#endif
