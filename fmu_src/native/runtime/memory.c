#include "memory.h"

#include <string.h>

#if N_MEMORY
void memory_accept(Instance *m)
{
    Path *path = &m->now.path;
    const double *inputs = m->now.values + FIRST_INPUT, *before = memory_of(m);
    if (before != path->memory[path->last])
        return; /* they are accepted already */
    path->last = 1u - path->last;
    joint_accept(m->joint, inputs, before, path->memory[path->last]);
    memcpy(path->inputs, inputs, sizeof path->inputs);
    path->accepted = 1;
}

void memory_settle(Instance *m)
{
    m->now.path.accepted = 0;
}
#else
void memory_accept(Instance *m)
{
    (void)m;
}

void memory_settle(Instance *m)
{
    (void)m;
}
#endif
