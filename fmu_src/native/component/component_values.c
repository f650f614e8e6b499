/* The functions of FMI-LS-WASM over those of FMI 3.0: variables, derivatives, continuous time. */
#include "component.h"

/* Variables; a type that no variable has takes and gives empty lists alone */

#define VALUES(name, Type)                                                                                   \
    EXPORT("get-" name) ListResult *get_##Type(Handle *self, References refs, size_t n)                      \
    {                                                                                                        \
        fmi3##Type *values = room(n * sizeof *values);                                                       \
        return list(fmi3Get##Type(self->instance, refs, n, values, n), values, n);                           \
    }                                                                                                        \
    EXPORT("set-" name)                                                                                      \
    unsigned set_##Type(Handle *self, References refs, size_t n, const fmi3##Type *values, size_t n_values)  \
    {                                                                                                        \
        return fmi3Set##Type(self->instance, refs, n, values, n_values);                                     \
    }

VALUES("float32", Float32)
VALUES("float64", Float64)
VALUES("int8", Int8)
VALUES("int16", Int16)
VALUES("int32", Int32)
VALUES("int64", Int64)
VALUES("uint8", UInt8)
VALUES("uint16", UInt16)
VALUES("uint32", UInt32)
VALUES("uint64", UInt64)
VALUES("boolean", Boolean)

EXPORT("get-string") ListResult *get_string(Handle *self, References refs, size_t n)
{
    return list(fmi3GetString(self->instance, refs, n, NULL, n), NULL, 0);
}

EXPORT("set-string")
unsigned set_string(Handle *self, References refs, size_t n, const List *values, size_t n_values)
{
    (void)values;
    return fmi3SetString(self->instance, refs, n, NULL, n_values);
}

EXPORT("get-binary") ListResult *get_binary(Handle *self, References refs, size_t n)
{
    return list(fmi3GetBinary(self->instance, refs, n, NULL, NULL, n), NULL, 0);
}

EXPORT("set-binary")
unsigned set_binary(Handle *self, References refs, size_t n, const List *values, size_t n_values)
{
    (void)values;
    return fmi3SetBinary(self->instance, refs, n, NULL, NULL, n_values);
}

/* Clocks: there are none, so nothing but an empty list goes through */

#define GET_CLOCKS(name, Function, ...)                                                                      \
    EXPORT("get-" name) ListResult *Get##Function(Handle *self, References refs, size_t n)                   \
    {                                                                                                        \
        return list(fmi3Get##Function(self->instance, refs, n, __VA_ARGS__), NULL, 0);                       \
    }
#define SET_CLOCKS(name, Function, ...)                                                                      \
    EXPORT("set-" name)                                                                                      \
    unsigned Set##Function(Handle *self, References refs, size_t n, const void *values, size_t n_values)     \
    {                                                                                                        \
        (void)values;                                                                                        \
        if (!instance_counts(self->instance, "fmi3Set" #Function, "values", n_values, n))                    \
            return fmi3Error;                                                                                \
        return fmi3Set##Function(self->instance, refs, n, __VA_ARGS__);                                      \
    }

GET_CLOCKS("clock", Clock, NULL)
SET_CLOCKS("clock", Clock, NULL)
GET_CLOCKS("interval-decimal", IntervalDecimal, NULL, NULL)
SET_CLOCKS("interval-decimal", IntervalDecimal, NULL)
GET_CLOCKS("interval-fraction", IntervalFraction, NULL, NULL, NULL)
SET_CLOCKS("interval-fraction", IntervalFraction, NULL, NULL)
GET_CLOCKS("shift-decimal", ShiftDecimal, NULL)
SET_CLOCKS("shift-decimal", ShiftDecimal, NULL)
GET_CLOCKS("shift-fraction", ShiftFraction, NULL, NULL)
SET_CLOCKS("shift-fraction", ShiftFraction, NULL, NULL)

/* Dependencies */

typedef struct {
    uint32_t dependent, element_of_dependent, independent, element_of_independent;
    uint8_t kind;
} Dependency;

EXPORT("get-number-of-variable-dependencies") CountResult *count_dependencies(Handle *self, uint32_t ref)
{
    size_t n = 0;
    const fmi3Status status = fmi3GetNumberOfVariableDependencies(self->instance, ref, &n);
    return result_CountResult(status, n);
}

EXPORT("get-variable-dependencies") ListResult *get_dependencies(Handle *self, uint32_t ref)
{
    size_t n = 0;
    fmi3Status status = fmi3GetNumberOfVariableDependencies(self->instance, ref, &n);
    if (status != fmi3OK)
        return list(status, NULL, 0);
    size_t *elements = room(2 * n * sizeof *elements);
    uint32_t *others = room(n * sizeof *others);
    fmi3DependencyKind *kinds = room(n * sizeof *kinds);
    Dependency *found = room(n * sizeof *found);
    status = fmi3GetVariableDependencies(self->instance, ref, elements, others, elements + n, kinds, n);
    for (size_t i = 0; status == fmi3OK && i < n; i++)
        found[i] = (Dependency){ref, elements[i], others[i], elements[n + i],
                                kinds[i] == fmi3Dependent ? 0 : (uint8_t)kinds[i]};
    return list(status, found, n);
}

/* Derivatives */

#define DERIVATIVE(name, Function, count)                                                                    \
    EXPORT(name)                                                                                             \
    ListResult *Function(Handle *self, References unknowns, size_t n_unknowns, References knowns,            \
                         size_t n_knowns, const double *seed, size_t n_seed)                                 \
    {                                                                                                        \
        double *found = room(count * sizeof *found);                                                         \
        const fmi3Status status = fmi3##Function(self->instance, unknowns, n_unknowns, knowns, n_knowns,     \
                                                 seed, n_seed, found, count);                                \
        return list(status, found, count);                                                                   \
    }

DERIVATIVE("get-directional-derivative", GetDirectionalDerivative, n_unknowns)
DERIVATIVE("get-adjoint-derivative", GetAdjointDerivative, n_knowns)

typedef struct {
    uint32_t ref, order;
} Request;

EXPORT("get-output-derivatives")
ListResult *get_output_derivatives(Handle *self, const Request *requests, size_t n)
{
    uint32_t *refs = room(n * sizeof *refs);
    fmi3Int32 *orders = room(n * sizeof *orders);
    double *values = room(n * sizeof *values);
    for (size_t i = 0; i < n; i++) {
        refs[i] = requests[i].ref;
        orders[i] = (fmi3Int32)requests[i].order;
    }
    return list(fmi3GetOutputDerivatives(self->instance, refs, n, orders, values, n), values, n);
}

/* FMI 3.0 has no such function. */
EXPORT("set-input-derivatives")
unsigned set_input_derivatives(Handle *self, const Request *requests, size_t n, const double *values,
                               size_t n_values)
{
    (void)requests, (void)values;
    return instance_counts(self->instance, "set-input-derivatives", "derivatives of inputs", n | n_values, 0)
               ? fmi3OK
               : fmi3Error;
}

/* Continuous time */

EXPORT("set-time") unsigned set_time(Handle *self, double time)
{
    return fmi3SetTime(self->instance, time);
}

EXPORT("set-continuous-states") unsigned set_states(Handle *self, const double *states, size_t n)
{
    return fmi3SetContinuousStates(self->instance, states, n);
}

#define STATES(name, Function, count)                                                                        \
    EXPORT(name) ListResult *Function(Handle *self)                                                          \
    {                                                                                                        \
        double *values = room((count) * sizeof *values);                                                     \
        return list(fmi3##Function(self->instance, values, count), values, count);                           \
    }

STATES("get-continuous-states", GetContinuousStates, N_STATES)
STATES("get-continuous-state-derivatives", GetContinuousStateDerivatives, N_STATES)
STATES("get-nominals-of-continuous-states", GetNominalsOfContinuousStates, N_STATES)
STATES("get-event-indicators", GetEventIndicators, 0)

#define COUNT(name, Function)                                                                                \
    EXPORT(name) CountResult *Function(Handle *self)                                                         \
    {                                                                                                        \
        size_t n = 0;                                                                                        \
        const fmi3Status status = fmi3##Function(self->instance, &n);                                        \
        return result_CountResult(status, n);                                                                \
    }

COUNT("get-number-of-continuous-states", GetNumberOfContinuousStates)
COUNT("get-number-of-event-indicators", GetNumberOfEventIndicators)
