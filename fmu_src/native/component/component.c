/* The functions of FMI-LS-WASM over those of FMI 3.0: instances, modes, steps, states.
 *
 * Both kinds of instances share what they have in common, as FMI's functions do; which kind a function is for,
 * those know. The component around it (wrap.py) gives each kind its own names. */
#include "component.h"

#include <stdlib.h>
#include <string.h>

/* Memory of a call: what the host passes, and what it gets back */

typedef struct Block Block;
struct Block {
    Block *next;
    max_align_t content[];
};

static Block *blocks;

void *room(size_t size)
{
    Block *block = malloc(sizeof *block + size);
    if (!block)
        __builtin_trap();
    block->next = blocks;
    blocks = block;
    return block->content;
}

EXPORT("cabi_realloc") void *cabi_realloc(void *old, size_t old_size, size_t align, size_t size)
{
    (void)align; /* a block suits everything */
    void *new = room(size);
    if (old)
        memcpy(new, old, old_size < size ? old_size : size);
    return new;
}

/* Every function returns one number: a status, or where its result is. */
EXPORT("cabi_post") void cabi_post(unsigned result)
{
    (void)result;
    while (blocks) {
        Block *next = blocks->next;
        free(blocks);
        blocks = next;
    }
}

char *text(const char *content, size_t n)
{
    char *copy = room(n + 1);
    memcpy(copy, content, n);
    copy[n] = '\0';
    return copy;
}

/* Instances */

IMPORT("log-message")
void log_message(const char *name, size_t n_name, unsigned status, const char *category, size_t n_category,
                 const char *message, size_t n_message);

static void tell(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                 fmi3String message)
{
    const Handle *handle = environment;
    log_message(handle->name, strlen(handle->name), status, category, strlen(category), message,
                strlen(message));
}

static Handle *handle_new(const char *name, size_t n)
{
    Handle *handle = malloc(sizeof *handle + n + 1);
    if (!handle)
        __builtin_trap();
    memcpy(handle->name, name, n);
    handle->name[n] = '\0';
    return handle;
}

EXPORT("drop") void drop(Handle *handle)
{
    fmi3FreeInstance(handle->instance);
    free(handle);
}

typedef struct {
    uint8_t some;
    int handle; /* by which the host knows it */
} Optional;

IMPORT("new-model-exchange-instance") int new_model_exchange(Handle *handle);
IMPORT("new-co-simulation-instance") int new_co_simulation(Handle *handle);

static Optional *optional(Handle *handle, int (*new)(Handle *))
{
    Optional *result = room(sizeof *result);
    *result = (Optional){handle->instance != NULL, 0};
    if (handle->instance)
        result->handle = new (handle);
    else
        free(handle);
    return result;
}

EXPORT("instantiate-model-exchange")
Optional *instantiate_model_exchange(const char *name, size_t n_name, const char *token, size_t n_token,
                                     bool visible, bool logging_on)
{
    Handle *handle = handle_new(name, n_name);
    handle->instance = fmi3InstantiateModelExchange(handle->name, text(token, n_token), NULL, visible,
                                                    logging_on, handle, tell);
    return optional(handle, new_model_exchange);
}

EXPORT("instantiate-co-simulation")
Optional *instantiate_co_simulation(const char *name, size_t n_name, const char *token, size_t n_token,
                                    bool visible, bool logging_on, bool event_mode_used,
                                    bool early_return_allowed, const uint32_t *intermediate,
                                    size_t n_intermediate)
{
    Handle *handle = handle_new(name, n_name);
    handle->instance = fmi3InstantiateCoSimulation(
        handle->name, text(token, n_token), NULL, visible, logging_on, event_mode_used, early_return_allowed,
        intermediate, n_intermediate, handle, tell, NULL);
    return optional(handle, new_co_simulation);
}

EXPORT("get-version") List *get_version(void)
{
    List *result = room(sizeof *result);
    *result = (List){fmi3GetVersion(), strlen(fmi3GetVersion())};
    return result;
}

/* Functions that only change the mode */

#define CHANGE(name, Function)                                                                               \
    EXPORT(name) unsigned Function(Handle *self)                                                             \
    {                                                                                                        \
        return fmi3##Function(self->instance);                                                               \
    }

CHANGE("exit-initialization-mode", ExitInitializationMode)
CHANGE("enter-event-mode", EnterEventMode)
CHANGE("enter-step-mode", EnterStepMode)
CHANGE("enter-continuous-time-mode", EnterContinuousTimeMode)
CHANGE("enter-configuration-mode", EnterConfigurationMode)
CHANGE("exit-configuration-mode", ExitConfigurationMode)
CHANGE("evaluate-discrete-states", EvaluateDiscreteStates)
CHANGE("terminate", Terminate)
CHANGE("reset", Reset)

EXPORT("enter-initialization-mode")
unsigned enter_initialization(Handle *self, bool has_tolerance, double tolerance, double start, bool has_stop,
                              double stop)
{
    return fmi3EnterInitializationMode(self->instance, has_tolerance, tolerance, start, has_stop, stop);
}

EXPORT("set-debug-logging")
unsigned set_debug_logging(Handle *self, bool on, const List *categories, size_t n)
{
    fmi3String *names = room(n * sizeof *names);
    for (size_t i = 0; i < n; i++)
        names[i] = text(categories[i].content, categories[i].n);
    return fmi3SetDebugLogging(self->instance, on, n, names);
}

/* State: always as bytes */

EXPORT("get-fmu-state") ListResult *get_state(Handle *self)
{
    fmi3FMUState state = NULL;
    size_t n = 0;
    fmi3Byte *bytes = NULL;
    fmi3Status status = fmi3GetFMUState(self->instance, &state);
    if (status == fmi3OK)
        status = fmi3SerializedFMUStateSize(self->instance, state, &n);
    if (status == fmi3OK) {
        bytes = room(n);
        status = fmi3SerializeFMUState(self->instance, state, bytes, n);
    }
    if (state)
        fmi3FreeFMUState(self->instance, &state);
    return list(status, bytes, n);
}

EXPORT("set-fmu-state") unsigned set_state(Handle *self, const uint8_t *bytes, size_t n)
{
    fmi3FMUState state = NULL;
    fmi3Status status = fmi3DeserializeFMUState(self->instance, bytes, n, &state);
    if (status == fmi3OK)
        status = fmi3SetFMUState(self->instance, state);
    if (state)
        fmi3FreeFMUState(self->instance, &state);
    return status;
}

/* Events and steps */

typedef struct {
    bool needed, terminate, nominals_changed, values_changed, next_defined;
    double next;
} Discrete;

typedef struct {
    bool enter_event_mode, terminate;
} Completed;

typedef struct {
    double time;
    bool event_needed, terminate, early_return;
} Stepped;

RESULT(DiscreteResult, Discrete)
RESULT(CompletedResult, Completed)
RESULT(SteppedResult, Stepped)

EXPORT("update-discrete-states") DiscreteResult *update(Handle *self)
{
    Discrete d = {0};
    const fmi3Status status =
        fmi3UpdateDiscreteStates(self->instance, &d.needed, &d.terminate, &d.nominals_changed,
                                 &d.values_changed, &d.next_defined, &d.next);
    return result_DiscreteResult(status, d);
}

EXPORT("do-step") SteppedResult *do_step(Handle *self, double time, double size, bool no_set_state)
{
    Stepped s = {0};
    const fmi3Status status = fmi3DoStep(self->instance, time, size, no_set_state, &s.event_needed,
                                         &s.terminate, &s.early_return, &s.time);
    return result_SteppedResult(status, s);
}

EXPORT("completed-integrator-step") CompletedResult *completed(Handle *self, bool no_set_state)
{
    Completed c = {0};
    const fmi3Status status =
        fmi3CompletedIntegratorStep(self->instance, no_set_state, &c.enter_event_mode, &c.terminate);
    return result_CompletedResult(status, c);
}
