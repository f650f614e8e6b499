#include "memory.h"

#include <string.h>

#if N_MEMORY
void memory_accept(Instance *m)
{
    Path *path = &m->now.path;
    if (memory_of(m) != path->memory[path->last])
        return; /* they are accepted already */
    path->last = 1u - path->last;
    memcpy(path->memory[path->last], m->tried, sizeof m->tried);
    memcpy(path->knowns, m->now.values + FIRST_KNOWN, sizeof path->knowns);
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
