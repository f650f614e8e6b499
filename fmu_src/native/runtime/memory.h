/* Memory of a joint whose outputs depend on the path of its inputs; N_MEMORY is 0 for all others.
 *
 * Inputs may be tried at will: outputs are functions of them and of the path up to the inputs that were
 * accepted last. Accepted are those at the end of initialization, of a step, of an integrator step, of an
 * event, and the path goes straight from one to the next. At accepted inputs the outputs stay those of the way
 * that led there, until others are accepted; joint_derivative may go on from there. */
#ifndef JOINTFMU_MEMORY_H
#define JOINTFMU_MEMORY_H

#include "instance.h"

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
void memory_settle(Instance *m);

#endif
