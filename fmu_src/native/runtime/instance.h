/* An instance of the FMU, the same for FMI 2 and FMI 3: values, modes, checks and messages.
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
    SETTABLE = INSTANTIATED | CONFIGURATION | INITIALIZATION | EVENT | CONTINUOUS_TIME | STEP |
        RECONFIGURATION
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
    State kept;              /* to go back to where a step is refused */
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

/* NULL with a message if the host's name or token is wrong. */
Instance *instance_new(const char *function, unsigned version, unsigned kind, const char *name,
                       const char *token, bool logging_on, Reporter reporter);
/* Say why there is no new instance. */
void instance_not_made(const char *function, const char *name, Reporter reporter, const char *what);
void instance_free(Instance *m);
/* Back to the state after instantiation. */
void instance_reset(Instance *m);
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
/* Report "FUNCTION: what happened; what was expected" and give ERROR. */
Status instance_refuse(const Instance *m, const char *function, const char *what);

/* Checks; each reports what is wrong and gives false. */
bool instance_forbids(const Instance *m, const char *function, unsigned where);
static inline bool instance_allows(const Instance *m, const char *function, unsigned where)
{
    return (m && (m->now.mode & where) && (m->now.kind & where)) || instance_forbids(m, function, where);
}
bool instance_lacks(const Instance *m, const char *function, const char *what);
static inline bool instance_has(const Instance *m, const char *function, const char *what,
                                const void *pointer)
{
    return pointer || instance_lacks(m, function, what);
}
bool instance_counts(const Instance *m, const char *function, const char *what, size_t given,
                     size_t expected);

#endif
