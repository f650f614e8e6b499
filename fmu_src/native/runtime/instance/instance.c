#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "optimize_for_size.h"

OPTIMIZE_FOR_SIZE

static const char *const category_names[] = {"logStatusError", "logStatusWarning", "logEvents"};
enum { N_CATEGORIES = sizeof category_names / sizeof *category_names };

static const char *const mode_names[] = {
    "instantiated state",   "configuration mode", "initialization mode",  "event mode",
    "continuous-time mode", "step mode",          "reconfiguration mode", "terminated state",
};
enum { N_MODES = sizeof mode_names / sizeof *mode_names };

/* Modes that the interface types have. */
static const unsigned modes_of_model_exchange = ANY_MODE & ~(unsigned)STEP;
static const unsigned modes_of_co_simulation = ANY_MODE & ~(unsigned)(EVENT | CONTINUOUS_TIME);

bool instance_mode_is_possible(unsigned interface_type, unsigned fmi_version, unsigned mode)
{
    unsigned modes = interface_type == MODEL_EXCHANGE ? modes_of_model_exchange : modes_of_co_simulation;
    if (fmi_version == 2)
        modes &= ~(unsigned)(CONFIGURATION | RECONFIGURATION);
    const bool is_single = mode && (mode & (mode - 1u)) == 0;
    return is_single && (mode & ~modes) == 0;
}

/* Log messages */

void instance_log(const Instance *m, Status status, unsigned category, const char *line)
{
    if (!m || !(m->state.log_categories & category))
        return;
    unsigned i = 0;
    while (category >> (i + 1))
        i++;
    m->logger.log_message(&m->logger, m->name, status, category_names[i], line);
}

Status instance_log_error(const Instance *m, const char *function, const char *format, ...)
{
    Text text = {0};
    text_append_format(&text, "%s: ", function);
    va_list values;
    va_start(values, format);
    text_append_format_list(&text, format, values);
    va_end(values);
    instance_log(m, ERROR, LOG_ERRORS, text.line);
    return ERROR;
}

Instance *instance_refuse_creation(const char *function, const char *name, Logger logger, const char *problem)
{
    Text text = {0};
    text_append_format(&text, "%s: %s", function, problem);
    logger.log_message(&logger, name ? name : "", ERROR, category_names[0], text.line);
    return NULL;
}

/* Add a category to a set; false: it is unknown. */
static bool set_category_bit(unsigned *log_categories, const char *category)
{
    for (unsigned i = 0; category && i < N_CATEGORIES; i++)
        if (strcmp(category, category_names[i]) == 0) {
            *log_categories |= 1u << i;
            return true;
        }
    return false;
}

Status instance_set_log_categories(Instance *m, const char *function, bool on, size_t n, const char *const categories[])
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE) ||
        (n && !instance_check_pointer(m, function, "categories", categories)))
        return ERROR;
    unsigned log_categories = 0;
    for (size_t i = 0; i < n; i++)
        if (!set_category_bit(&log_categories, categories[i]))
            return instance_log_error(m, function,
                                      "category %q is unknown; expected logStatusError, logStatusWarning, logEvents",
                                      categories[i]);
    if (!on)
        log_categories = LOG_ERRORS | LOG_WARNINGS;
    else if (n == 0)
        log_categories = LOG_ERRORS | LOG_WARNINGS | LOG_EVENTS;
    m->state.log_categories = log_categories;
    return OK;
}

/* Checks of calls */

/* Append the names of a set of modes. */
static void append_modes(Text *text, unsigned modes)
{
    const char *separator = "";
    for (unsigned i = 0; i < N_MODES; i++)
        if (modes & 1u << i) {
            text_append(text, separator);
            text_append(text, mode_names[i]);
            separator = ", ";
        }
}

bool instance_report_wrong_mode(const Instance *m, const char *function, unsigned allowed_modes)
{
    if (!m)
        return false;
    const bool is_model_exchange = m->state.interface_type == MODEL_EXCHANGE;
    if (!(m->state.interface_type & allowed_modes))
        return instance_log_error(m, function, "called for %s; expected %s",
                                  is_model_exchange ? "model exchange" : "co-simulation",
                                  is_model_exchange ? "co-simulation" : "model exchange") == OK;
    Text text = {0};
    text_append(&text, "called in ");
    append_modes(&text, m->state.mode);
    text_append(&text, "; expected ");
    const unsigned modes = allowed_modes & (is_model_exchange ? modes_of_model_exchange : modes_of_co_simulation);
    if (modes)
        append_modes(&text, modes);
    else
        text_append(&text, "no such call: this FMU has no event mode in co-simulation");
    return instance_log_error(m, function, "%s", text.line) == OK;
}

/* Life cycle */

Instance *instance_create(const char *function, unsigned fmi_version, unsigned interface_type, const char *name,
                          const char *token, bool logging_on, Logger logger)
{
    Text text = {0};
    if (!name || !name[0])
        text_append(&text, "the instance name is empty; expected a name");
    else if (!token || strcmp(token, data.token) != 0)
        text_append_format(&text, "the token is %q; expected '%s', that of %s", token, data.token, data.name);
    if (text.length > 0)
        return instance_refuse_creation(function, name, logger, text.line);
    const size_t name_size = strlen(name) + 1;
    Instance *m = calloc(1, sizeof *m + name_size);
    Joint *joint = calloc(1, joint_size());
    if (!m || !joint) {
        free(m);
        free(joint);
        return instance_refuse_creation(function, name, logger, "no memory is left; expected some for a new instance");
    }
    m->joint = joint;
    m->fmi_version = fmi_version;
    m->state.interface_type = interface_type;
    m->logging_on = logging_on;
    m->logger = logger;
    memcpy(m->name, name, name_size);
    instance_reset(m);
    return m;
}

void instance_free(Instance *m)
{
    if (m)
        free(m->joint);
    free(m);
}

void instance_reset(Instance *m)
{
    InstanceState *state = &m->state;
    const unsigned interface_type = state->interface_type;
    memset(state, 0, sizeof *state);
    state->interface_type = interface_type;
    memcpy(state->values, data.start, sizeof state->values);
    state->values[0] = 0.0;
    state->stop_time = INFINITY;
    state->log_categories = LOG_ERRORS | LOG_WARNINGS | (m->logging_on ? LOG_EVENTS : 0u);
    m->outputs_outdated = m->parameters_changed = true;
    instance_set_mode(m, INSTANTIATED);
}

Status instance_reset_if_allowed(Instance *m, const char *function)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE))
        return ERROR;
    instance_reset(m);
    return OK;
}

void instance_set_mode(Instance *m, unsigned mode)
{
    m->state.mode = mode;
    Text text = {0};
    text_append(&text, "now in ");
    append_modes(&text, mode);
    instance_log(m, OK, LOG_EVENTS, text.line);
}

Status instance_set_experiment(Instance *m, const char *function, double tolerance, double start, bool stop_defined,
                               double stop)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | INSTANTIATED))
        return ERROR;
    if (!isfinite(start) || (stop_defined && !(stop >= start))) {
        Text text = {0};
        text_append_format(&text, "start time %.16g", start);
        if (stop_defined)
            text_append_format(&text, " and stop time %.16g", stop);
        return instance_log_error(m, function, "%s; expected a finite start time, and a stop time not before it",
                                  text.line);
    }
    m->state.values[0] = m->state.start_time = start;
    m->outputs_outdated = true;
    m->state.stop_time = stop_defined ? stop : INFINITY;
    m->state.tolerance = tolerance;
    return OK;
}

Status instance_enter_mode(Instance *m, const char *function, unsigned allowed_modes, unsigned mode)
{
    if (!instance_check_mode(m, function, allowed_modes))
        return ERROR;
    instance_set_mode(m, mode);
    return OK;
}

Status instance_set_time(Instance *m, const char *function, double time)
{
    if (!instance_check_mode(m, function, MODEL_EXCHANGE | EVENT | CONTINUOUS_TIME))
        return ERROR;
    if (!isfinite(time))
        return instance_log_error(m, function, "the time is not finite; expected a finite one");
    m->state.values[0] = time;
    m->outputs_outdated |= IS_TIME_DEPENDENT;
    return OK;
}

END_OPTIMIZE_FOR_SIZE
