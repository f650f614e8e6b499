/* What the functions of FMI-LS-WASM are made of: the canonical ABI of WebAssembly components in C.
 *
 * Lists and strings come as pointer and length. What is returned beside a status lies in memory, laid out as C
 * lays out a struct; the host copies it and calls `cabi_post`. */
#ifndef JOINTFMU_COMPONENT_H
#define JOINTFMU_COMPONENT_H

#include "fmi3Functions.h"

#include "instance.h"

#ifndef __wasm32__
#error "this layer is for wasm32 alone"
#endif

#define EXPORT(name) __attribute__((export_name(name), used))
#define IMPORT(name) __attribute__((import_module("component"), import_name(name)))

/* What stands behind the host's handle of an instance. */
typedef struct {
    fmi3Instance instance;
    char name[];
} Handle;

typedef const uint32_t *References;

/* A list or string. */
typedef struct {
    const void *content;
    size_t n;
} List;

/* Memory until the end of the call. */
void *room(size_t size);
/* A string with the zero that C wants at its end, until then. */
char *text(const char *content, size_t n);

/* result<TYPE, status>: a warning goes to the log alone. */
#define RESULT(Name, Type)                                                                                   \
    typedef struct {                                                                                         \
        uint8_t failed;                                                                                      \
        union {                                                                                              \
            Type value;                                                                                      \
            uint8_t status;                                                                                  \
        };                                                                                                   \
    } Name;                                                                                                  \
    static inline Name *result_##Name(fmi3Status status, Type value)                                         \
    {                                                                                                        \
        Name *result = room(sizeof *result);                                                                 \
        if (status == fmi3OK || status == fmi3Warning)                                                       \
            *result = (Name){.failed = 0, .value = value};                                                   \
        else                                                                                                 \
            *result = (Name){.failed = 1, .status = (uint8_t)status};                                        \
        return result;                                                                                       \
    }

RESULT(ListResult, List)
RESULT(CountResult, uint64_t)

static inline ListResult *list(fmi3Status status, const void *content, size_t n)
{
    return result_ListResult(status, (List){content, n});
}

#endif
