/* Functions that the page of the laboratory calls, compiled with the C sources of an FMU to WebAssembly. `ref` is a
 * value reference of the FMU. Functions that return int return 0 without an error. */
#include "instance.h"
#include "token.h" /* generated: instantiation token of the FMU */

#define EXPORTED __attribute__((visibility("default")))

/* Messages logged since the last `lab_take_messages`: lines that begin with the status, 3: error, 1: warning, 0:
 * other. */
static Text messages;

static void log_message(const Logger *logger, const char *name, Status status, const char *category, const char *line)
{
    (void)logger, (void)name, (void)category;
    text_append(&messages, status >= DISCARD ? "3" : status == WARNING ? "1" : "0");
    text_append(&messages, line);
    text_append(&messages, "\n");
}

/* Return the messages and clear them. */
EXPORTED const char *lab_take_messages(void)
{
    static Text returned_messages;
    returned_messages = messages;
    text_clear(&messages);
    return returned_messages.line;
}

EXPORTED Instance *lab_create(void)
{
    const Logger logger = {log_message, NULL, NULL};
    return instance_create("lab_create", 3, CO_SIMULATION, "laboratory", TOKEN, false, logger);
}

/* Parameters that are no FMU variables. The page overwrites them with those of another parameter file before
 * `lab_create`. */
EXPORTED const double *lab_hidden_parameters(void)
{
    return data.hidden_parameters;
}

/* Set the state after `lab_create`; tables are kept if the parameters are then set to the same values. */
EXPORTED void lab_reset(Instance *m)
{
    instance_reset(m);
}

EXPORTED int lab_set(Instance *m, uint32_t ref, double value)
{
    if (ref >= N_VALUES || !variables[ref].is_boolean)
        return instance_set_values(m, "lab_set", &ref, 1, &value);
    const bool value_is_true = value != 0.0;
    return instance_set_booleans(m, "lab_set", &ref, 1, &value_is_true);
}

/* End the initialization: check parameters and inputs. Then steps are allowed. */
EXPORTED int lab_initialize(Instance *m)
{
    return instance_enter_mode(m, "lab_initialize", BOTH_INTERFACES | INSTANTIATED, INITIALIZATION) == OK
               ? (int)instance_initialize(m, "lab_initialize")
               : ERROR;
}

/* Communication step [s]: the present inputs are accepted as the end of a load step. */
EXPORTED int lab_step(Instance *m, double size)
{
    return instance_do_step(m, "lab_step", m->state.values[0], size);
}

EXPORTED double lab_get(Instance *m, uint32_t ref)
{
    double value = 0.0;
    instance_get_values(m, "lab_get", &ref, 1, &value);
    return value;
}

/* Derivative of an output with respect to an input. */
EXPORTED double lab_derivative(Instance *m, uint32_t output, uint32_t input)
{
    double seed = 1.0, result = 0.0;
    instance_directional_derivative(m, "lab_derivative", &output, 1, &input, 1, &seed, &result);
    return result;
}
