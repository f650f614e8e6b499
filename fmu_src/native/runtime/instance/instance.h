/* Instance of the FMU, common to FMI 2 and FMI 3: values, modes, checks, steps, FMU states and log messages.
 *
 * `function` is the name of the FMI function that the host called; error messages begin with it. `m` is the instance; a
 * NULL instance is an error. An array may be NULL only if it has no elements. */
#ifndef JOINTFMU_INSTANCE_H
#define JOINTFMU_INSTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "joint.h"
#include "text.h"
#include "variables.h"

/* The numbers are those of fmi2Status and fmi3Status. */
typedef enum { OK, WARNING, DISCARD, ERROR } Status;

/* Modes of an instance and the two interface types of FMI, one bit each. A set of them says where a call is allowed. */
enum {
    INSTANTIATED = 1u << 0,
    CONFIGURATION = 1u << 1,
    INITIALIZATION = 1u << 2,
    EVENT = 1u << 3,
    CONTINUOUS_TIME = 1u << 4,
    STEP = 1u << 5,
    RECONFIGURATION = 1u << 6,
    TERMINATED = 1u << 7,
    MODEL_EXCHANGE = 1u << 8,
    CO_SIMULATION = 1u << 9,

    BOTH_INTERFACES = MODEL_EXCHANGE | CO_SIMULATION,
    ANY_MODE = TERMINATED | (TERMINATED - 1u),
    READABLE = INITIALIZATION | EVENT | CONTINUOUS_TIME | STEP | TERMINATED,
    STATES_SETTABLE = INSTANTIATED | CONFIGURATION | INITIALIZATION | EVENT | CONTINUOUS_TIME,
    SETTABLE = STATES_SETTABLE | STEP | RECONFIGURATION
};

/* Log categories, one bit each. */
enum { LOG_ERRORS = 1u << 0, LOG_WARNINGS = 1u << 1, LOG_EVENTS = 1u << 2 };

/* Logger of the host: its callback, and the function that calls it with the signature of its FMI version. */
typedef struct Logger Logger;
struct Logger {
    void (*log_message)(const Logger *logger, const char *name, Status status, const char *category, const char *line);
    void (*callback)(void); /* the host's function, of the type that `log_message` knows */
    void *environment;      /* of the host, passed to the callback */
};

/* Last accepted load step of a joint with history: history variables at its start and end, arguments at its end. */
typedef struct {
    double history[2][N_HISTORY + 1];   /* [end_index] at the end, the other one at the start; C has no empty arrays */
    double variables[N_PATH_VARIABLES]; /* values from FIRST_PATH_VARIABLE on, at the end */
    unsigned end_index;                 /* 0 or 1 */
    unsigned has_accepted_inputs;       /* 0: the next load step starts at history[end_index], at any inputs */
} AcceptedPath;

/* FMU state that a host can save and restore; outputs and tables follow from it. */
typedef struct {
    double values[N_VALUES];            /* by value reference; [0] is the time */
    double input_derivatives[N_INPUTS]; /* time derivatives of the inputs in the next step (FMI 2) */
    double start_time, stop_time;       /* [s]; the stop time is infinite if the host defines none */
    double tolerance;                   /* relative, set by the host; 0: not set */
    double previous_inputs[N_INPUTS], previous_acceleration,
        previous_step_size; /* of the last step, with states only */
    unsigned interface_type, mode;
    unsigned reported_warnings; /* bits of `joint_find_warnings` that were logged */
    unsigned log_categories;    /* categories that the host wants */
    Status last_step_status;
    AcceptedPath path;
} InstanceState;

typedef struct {
    InstanceState state;
    double trial_history[N_HISTORY + 1]; /* history variables at the end of the last evaluation */
    double tabulated_parameters[N_PARAMETERS];                /* parameters for which the tables hold */
    double seed[N_INPUTS + N_STATES], sensitivity[N_OUTPUTS]; /* of a directional derivative */
    Joint *joint;
    InstanceState *backup; /* state before a step, restored if the step fails; NULL until a step changes the state */
    bool outputs_outdated;   /* an input, state or parameter changed since the last evaluation */
    bool parameters_changed; /* a parameter was set since the last evaluation, perhaps to the same value */
    bool tables_are_valid;   /* the tables are those of `tabulated_parameters` */
    bool logging_on;         /* as at instantiation */
    unsigned fmi_version;    /* 2 or 3 */
    Logger logger;
    char name[];
} Instance;

/* Life cycle: instance.c */

/* NULL, with a message, if the host's instance name or token is wrong. */
Instance *instance_create(const char *function, unsigned fmi_version, unsigned interface_type, const char *name,
                          const char *token, bool logging_on, Logger logger);
/* Log why no instance was created; returns NULL. */
Instance *instance_refuse_creation(const char *function, const char *name, Logger logger, const char *problem);
void instance_free(Instance *m);
/* Copy the state to `backup`; false: no memory is left for it, which is logged. */
bool instance_back_up_state(Instance *m, const char *function);
/* Set the state after instantiation: checks the mode first, or does not. */
Status instance_reset_if_allowed(Instance *m, const char *function);
void instance_reset(Instance *m);
/* Whether `mode` is a single mode that an interface type has in an FMI version. */
bool instance_mode_is_possible(unsigned interface_type, unsigned fmi_version, unsigned mode);
void instance_set_mode(Instance *m, unsigned mode);
/* Set the mode if the present one is among the allowed ones. */
Status instance_enter_mode(Instance *m, const char *function, unsigned allowed_modes, unsigned mode);
Status instance_set_time(Instance *m, const char *function, double time);
/* Set the tolerance (0: not given) and the times of the experiment, before initialization. */
Status instance_set_experiment(Instance *m, const char *function, double tolerance, double start, bool stop_defined,
                               double stop);
Status instance_set_log_categories(Instance *m, const char *function, bool on, size_t n,
                                   const char *const categories[]);
void instance_log(const Instance *m, Status status, unsigned category, const char *line);
/* Log the error "FUNCTION: what happened; what was expected", formatted by `text_append_format`; returns ERROR. */
Status instance_log_error(const Instance *m, const char *function, const char *format, ...);

/* Checks of calls: each logs what is wrong and returns false. */

/* Error message of `instance_check_mode`; returns false. */
bool instance_report_wrong_mode(const Instance *m, const char *function, unsigned allowed_modes);
static inline bool instance_check_mode(const Instance *m, const char *function, unsigned allowed_modes)
{
    return (m && (m->state.mode & allowed_modes) && (m->state.interface_type & allowed_modes)) ||
           instance_report_wrong_mode(m, function, allowed_modes);
}
static inline bool instance_check_pointer(const Instance *m, const char *function, const char *name,
                                          const void *pointer)
{
    return pointer || instance_log_error(m, function, "%s is NULL; expected a pointer", name) == OK;
}
static inline bool instance_check_count(const Instance *m, const char *function, const char *name, size_t count,
                                        size_t expected)
{
    return count == expected || instance_log_error(m, function, "%zu %s; expected %zu", count, name, expected) == OK;
}

/* Get and set variables: values.c */

Status instance_set_values(Instance *m, const char *function, const uint32_t refs[], size_t n, const double values[]);
Status instance_get_values(Instance *m, const char *function, const uint32_t refs[], size_t n, double values[]);
/* Values of Boolean variables: an array of int in FMI 2, of bool in FMI 3. */
Status instance_set_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n, const void *values);
Status instance_get_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n, void *values);
/* Set a parameter; if it changes, the next load step starts at the accepted inputs. */
void instance_set_parameter(Instance *m, uint32_t ref, double value);
/* Access to something that this FMU does not have: an error unless n = 0. `name` is its name in the message. */
#define UNSUPPORTED_TYPE "variables of a type that this FMU does not have"
Status instance_check_empty(const Instance *m, const char *function, unsigned allowed_modes, const char *name,
                            size_t n);
Status instance_set_input_derivatives(Instance *m, const char *function, const uint32_t refs[], size_t n,
                                      const int32_t orders[], const double values[]);
/* Directional derivative of the outputs `unknowns` along `seed`, given for the inputs and states `knowns`. */
Status instance_directional_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                                       const uint32_t knowns[], size_t n_knowns, const double seed[], double result[]);
/* Adjoint derivative: derivative of the sum of seed[i] * unknowns[i] with respect to each of `knowns`. */
Status instance_adjoint_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                                   const uint32_t knowns[], size_t n_knowns, const double seed[], double result[]);

/* Outputs, tables and the accepted path: evaluate.c */

/* Evaluate tables and outputs if they are outdated. Refused parameters are logged and give ERROR, refused inputs are
 * logged with the status `refusal`, which is returned. */
Status instance_evaluate(Instance *m, Status refusal);

/* Warn once of inputs that the host has set to 0, if their start values are not 0. */
void instance_warn_of_lost_start_values(Instance *m);

/* Status of a call that evaluates the present inputs without accepting them, if they are refused: DISCARD, where the
 * standard has it. A solver may then try other inputs. FMI 2 has it in model exchange, except for derivatives of
 * outputs. */
static inline Status trial_refusal(const Instance *m, bool is_derivative)
{
    const bool has_discard = m->fmi_version == 3 || (m->state.interface_type == MODEL_EXCHANGE && !is_derivative);
    return has_discard ? DISCARD : ERROR;
}

/* Joints with history variables (N_HISTORY > 0): their outputs depend on the path of the inputs.
 *
 * The path consists of straight load steps between accepted inputs. Inputs are accepted at the end of initialization,
 * of a communication step, of an integrator step and of an event. Between them the host may try any inputs: outputs
 * are functions of the present inputs and of the path up to the inputs accepted last. At the accepted inputs
 * themselves, the outputs remain those at the end of the load step to them until other inputs are accepted;
 * derivatives may be those of a further motion from there. */

/* Whether the present inputs are the accepted ones. */
static inline bool path_inputs_are_accepted(const Instance *m)
{
    const AcceptedPath *path = &m->state.path;
    bool is_equal = N_HISTORY && path->has_accepted_inputs;
    for (size_t i = 0; i < N_PATH_VARIABLES && is_equal; i++)
        is_equal = m->state.values[FIRST_PATH_VARIABLE + i] == path->variables[i];
    return is_equal;
}

/* History variables at the start of the load step to the present inputs. */
static inline const double *path_start_history(const Instance *m)
{
    const AcceptedPath *path = &m->state.path;
    return path->history[path_inputs_are_accepted(m) ? 1u - path->end_index : path->end_index];
}

/* History variables at the present inputs if these are accepted; else NULL. */
static inline const double *path_end_history(const Instance *m)
{
    return path_inputs_are_accepted(m) ? m->state.path.history[m->state.path.end_index] : NULL;
}

/* Accept the inputs of the last evaluation. */
void path_accept_inputs(Instance *m);
/* Start the next load step at the accepted inputs, even if it leads to the same inputs: a change of parameters does not
 * repeat the load step before. */
static inline void path_restart(Instance *m)
{
    m->state.path.has_accepted_inputs = 0;
}

/* Initialization and steps of co-simulation: step.c */

/* Check parameters and inputs, accept the inputs and leave initialization mode. */
Status instance_initialize(Instance *m, const char *function);
/* Evaluate the outputs and accept the inputs. */
Status instance_accept_inputs(Instance *m);
/* Accept the inputs at an event, where parameters may have changed; find the time of the next event, if there is
 * one. */
Status instance_update_discrete_states(Instance *m, bool *next_defined, double *next_time);
Status instance_do_step(Instance *m, const char *function, double time, double size);

/* Continuous states: continuous.c. Systems have their own `instance_integrate`, in implicit.c. */

/* Integrate the states over a communication step, from accepted inputs. The outputs are outdated after it. On ERROR,
 * which is logged, the state of the instance is undefined: the caller restores it. */
Status instance_integrate(Instance *m, double size);
Status instance_set_continuous_states(Instance *m, const char *function, const double x[], size_t n);
Status instance_get_continuous_states(Instance *m, const char *function, double x[], size_t n);
Status instance_get_state_derivatives(Instance *m, const char *function, double x[], size_t n);
Status instance_get_nominals(Instance *m, const char *function, unsigned allowed_modes, double x[], size_t n);

/* FMU states of the host, and their serialization: snapshot.c */

Status state_save(const Instance *m, const char *function, void **saved);
Status state_restore(Instance *m, const char *function, const void *saved);
Status state_free(const Instance *m, const char *function, void **saved);
Status state_serialized_size(const Instance *m, const char *function, const void *saved, size_t *size);
Status state_serialize(const Instance *m, const char *function, const void *saved, void *bytes, size_t size);
Status state_deserialize(Instance *m, const char *function, const void *bytes, size_t size, void **saved);

#endif
