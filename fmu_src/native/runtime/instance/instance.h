/* An instance of the FMU, the same for FMI 2 and FMI 3: values, modes, checks, steps, states and messages.
 *
 * Every function that takes `function` reports under that name of the FMI function that was called, and
 * an instance that is NULL is an error. Arrays may be NULL only if they have no elements. */
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

/* Modes of an instance, and the two kinds of instances; a set of them says where a function is allowed. */
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

    BOTH = MODEL_EXCHANGE | CO_SIMULATION,
    ANY_MODE = TERMINATED | (TERMINATED - 1u),
    READABLE = INITIALIZATION | EVENT | CONTINUOUS_TIME | STEP | TERMINATED,
    STATES_SETTABLE = INSTANTIATED | CONFIGURATION | INITIALIZATION | EVENT | CONTINUOUS_TIME,
    SETTABLE = STATES_SETTABLE | STEP | RECONFIGURATION
};

/* Categories of messages. */
enum { LOG_ERRORS = 1u << 0, LOG_WARNINGS = 1u << 1, LOG_EVENTS = 1u << 2 };

/* How messages reach the host. */
typedef struct Reporter Reporter;
struct Reporter {
    void (*deliver)(const Reporter *to, const char *name, Status status, const char *category,
                    const char *line);
    void (*callback)(void); /* the host's function, of the type that `deliver` knows */
    void *environment;
};

/* What a joint with memory went through. */
typedef struct {
    double memory[2][N_MEMORY + 1]; /* before and after the way to the accepted inputs; one more, for C */
    double knowns[N_PATH];          /* accepted: values from FIRST_KNOWN on */
    unsigned last;                  /* 1: memory[1] is the one after, else memory[0] */
    unsigned accepted;              /* 0: no inputs are, and memory[last] is the only one */
} Path;

/* All that a host can save and restore; outputs and tables follow from it. */
typedef struct {
    double values[N_VALUES]; /* by value reference; [0] is the time */
    double slopes[N_INPUTS]; /* derivatives of the inputs in the next step (FMI 2) */
    double start, stop;      /* times; stop is infinite where the host defines none */
    double tolerance;        /* relative, of the host; 0: it states none */
    double last_inputs[N_INPUTS], last_rate, last_size; /* of the last step, if there are states */
    unsigned kind, mode;
    unsigned warned; /* bits of joint_outside that were reported */
    unsigned logs;   /* categories that are delivered */
    Status last_step;
    Path path;
} State;

typedef struct {
    State now;
    State kept;              /* to go back to where a step is refused; one that is read from bytes */
    double tried[N_MEMORY + 1]; /* memory after the way of the last evaluation */
    double tabulated[N_PARAMETERS]; /* parameters of the tables */
    double seed[N_INPUTS + N_STATES], change[N_OUTPUTS]; /* of a derivative */
    Joint *joint;
    bool dirty;              /* outputs are not those of the present inputs and parameters */
    bool parameters_changed; /* perhaps: a parameter was set since the last evaluation */
    bool tables_right;       /* the tables are those of `tabulated` */
    bool logging_on;         /* as at instantiation */
    unsigned version;        /* of FMI: 2 or 3 */
    Reporter reporter;
    char name[];
} Instance;

/* Life: instance.c */

/* NULL with a message if the host's name or token is wrong. */
Instance *instance_new(const char *function, unsigned version, unsigned kind, const char *name,
                       const char *token, bool logging_on, Reporter reporter);
/* Say why there is no new instance, and give NULL. */
Instance *instance_not_made(const char *function, const char *name, Reporter reporter, const char *what);
void instance_free(Instance *m);
/* Back to the state after instantiation, where that is allowed and without asking. */
Status instance_restart(Instance *m, const char *function);
void instance_reset(Instance *m);
/* Whether an instance of a kind and an FMI version can be in `mode`, which is exactly one. */
bool instance_can_be_in(unsigned kind, unsigned version, unsigned mode);
/* Change the mode. */
void instance_enter(Instance *m, unsigned mode);
/* The same for the functions that do no more, where they are allowed. */
Status instance_change(Instance *m, const char *function, unsigned where, unsigned mode);
Status instance_set_time(Instance *m, const char *function, double time);
/* Set tolerance (0: none is stated) and times of the experiment, before initialization. */
Status instance_set_experiment(Instance *m, const char *function, double tolerance, double start,
                               bool stop_defined, double stop);
Status instance_select_logs(Instance *m, const char *function, bool on, size_t n,
                            const char *const categories[]);
void instance_report(const Instance *m, Status status, unsigned category, const char *line);
/* Report "FUNCTION: what happened; what was expected" and give ERROR; a format of text_print. */
Status instance_refuse(const Instance *m, const char *function, const char *format, ...);

/* Checks; each reports what is wrong and gives false. */
bool instance_forbids(const Instance *m, const char *function, unsigned where);
static inline bool instance_allows(const Instance *m, const char *function, unsigned where)
{
    return (m && (m->now.mode & where) && (m->now.kind & where)) || instance_forbids(m, function, where);
}
static inline bool instance_has(const Instance *m, const char *function, const char *what,
                                const void *pointer)
{
    return pointer || instance_refuse(m, function, "%s is NULL; expected a pointer", what) == OK;
}
static inline bool instance_counts(const Instance *m, const char *function, const char *what, size_t given,
                                   size_t expected)
{
    return given == expected || instance_refuse(m, function, "%zu %s; expected %zu", given, what, expected) == OK;
}

/* Values as hosts set and read them: values.c */

Status instance_set(Instance *m, const char *function, const uint32_t refs[], size_t n,
                    const double values[]);
Status instance_get(Instance *m, const char *function, const uint32_t refs[], size_t n, double values[]);
/* Booleans: int in FMI 2, bool in FMI 3. */
Status instance_set_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n,
                             const void *values);
Status instance_get_booleans(Instance *m, const char *function, const uint32_t refs[], size_t n, void *values);
/* Give a parameter a value. */
void instance_put(Instance *m, uint32_t ref, double value);
/* What this FMU has none of: right with n = 0 only. */
#define NO_SUCH_TYPE "variables of a type that this FMU does not have"
Status instance_none(const Instance *m, const char *function, unsigned where, const char *what, size_t n);
Status instance_set_slopes(Instance *m, const char *function, const uint32_t refs[], size_t n,
                           const int32_t orders[], const double values[]);
/* Derivative of outputs `unknowns` along `seed` in inputs `knowns`. */
Status instance_derivative(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                           const uint32_t knowns[], size_t n_knowns, const double seed[], double result[]);
/* Its transpose: derivative of the sum of seed[i] * unknowns[i] by each of `knowns`. */
Status instance_adjoint(Instance *m, const char *function, const uint32_t unknowns[], size_t n_unknowns,
                        const uint32_t knowns[], size_t n_knowns, const double seed[], double result[]);

/* Outputs, tables for their parameters, the path: evaluate.c */

/* Make the outputs right for the present inputs and parameters; reports a refusal and gives ERROR. */
Status instance_evaluate(Instance *m);

/* A joint whose outputs depend on the path of its inputs has a memory; N_MEMORY is 0 for all others.
 *
 * Inputs may be tried at will: outputs are functions of them and of the path up to the inputs that were
 * accepted last. Accepted are those at the end of initialization, of a step, of an integrator step, of an
 * event, and the path goes straight from one to the next. At accepted inputs the outputs stay those of the way
 * that led there, until others are accepted; joint_derivative may go on from there. */

/* Whether the present inputs are the accepted ones. */
static inline bool memory_rests(const Instance *m)
{
    const Path *path = &m->now.path;
    bool rests = N_MEMORY && path->accepted;
    for (size_t i = 0; i < N_PATH && rests; i++)
        rests = m->now.values[FIRST_KNOWN + i] == path->knowns[i];
    return rests;
}

/* The memory from which the path goes on to the present inputs. */
static inline const double *memory_of(const Instance *m)
{
    const Path *path = &m->now.path;
    return path->memory[memory_rests(m) ? 1u - path->last : path->last];
}

/* The memory at the present inputs, if they are accepted; else NULL. */
static inline const double *memory_after(const Instance *m)
{
    return memory_rests(m) ? m->now.path.memory[m->now.path.last] : NULL;
}

/* Accept the inputs of the last evaluation. */
void memory_accept(Instance *m);
/* Let the path begin at the accepted inputs: what changes from now on does not change the way that led there. */
static inline void memory_settle(Instance *m)
{
    m->now.path.accepted = 0;
}

/* Initialization and steps of co-simulation: step.c */

/* Check parameters and inputs and leave initialization mode. */
Status instance_initialize(Instance *m, const char *function);
/* Evaluate, and accept the inputs: the path of a joint with memory goes on from them. */
Status instance_accept(Instance *m);
/* The same in an event, with parameters that were changed in it; and the time of the next one, if there is any. */
Status instance_update_event(Instance *m, bool *defined, double *next);
Status instance_step(Instance *m, const char *function, double time, double size);

/* Continuous states: continuous.c; of a system implicit.c has the first */

/* Move the states over a step of co-simulation, from a state that is accepted; outputs are to be evaluated after
 * it. A refusal is reported and may leave anything: the caller goes back. */
Status instance_advance(Instance *m, double size);
Status instance_set_states(Instance *m, const char *function, const double x[], size_t n);
Status instance_get_states(Instance *m, const char *function, double x[], size_t n);
Status instance_get_rates(Instance *m, const char *function, double x[], size_t n);
Status instance_get_nominals(Instance *m, const char *function, unsigned where, double x[], size_t n);

/* States of the FMU outside of an instance, and as bytes: snapshot.c */

Status state_save(const Instance *m, const char *function, void **saved);
Status state_restore(Instance *m, const char *function, const void *saved);
Status state_free(const Instance *m, const char *function, void **saved);
Status state_size(const Instance *m, const char *function, const void *saved, size_t *size);
Status state_write(const Instance *m, const char *function, const void *saved, void *bytes, size_t size);
Status state_read(Instance *m, const char *function, const void *bytes, size_t size, void **saved);

#endif
