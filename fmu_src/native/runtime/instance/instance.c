#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cold.h"

COLD

static const char *const categories_known[] = {"logStatusError", "logStatusWarning", "logEvents"};
enum { N_CATEGORIES = sizeof categories_known / sizeof *categories_known };

static const char *const mode_names[] = {
    "instantiated state",   "configuration mode", "initialization mode",  "event mode",
    "continuous-time mode", "step mode",          "reconfiguration mode", "terminated state",
};
enum { N_MODES = sizeof mode_names / sizeof *mode_names };

/* Modes in which an instance of a kind can be. */
static const unsigned modes_of_model_exchange = ANY_MODE & ~(unsigned)STEP;
static const unsigned modes_of_co_simulation = ANY_MODE & ~(unsigned)(EVENT | CONTINUOUS_TIME);

bool instance_can_be_in(unsigned kind, unsigned version, unsigned mode)
{
    unsigned modes = kind == MODEL_EXCHANGE ? modes_of_model_exchange : modes_of_co_simulation;
    if (version == 2)
        modes &= ~(unsigned)(CONFIGURATION | RECONFIGURATION);
    const bool one = mode && (mode & (mode - 1u)) == 0;
    return one && (mode & ~modes) == 0;
}

/* Messages */

void instance_report(const Instance *m, Status status, unsigned category, const char *line)
{
    if (!m || !(m->now.logs & category))
        return;
    unsigned i = 0;
    while (category >> (i + 1))
        i++;
    m->reporter.deliver(&m->reporter, m->name, status, categories_known[i], line);
}

Status instance_refuse(const Instance *m, const char *function, const char *format, ...)
{
    Text text = {0};
    text_print(&text, "%s: ", function);
    va_list values;
    va_start(values, format);
    text_print_list(&text, format, values);
    va_end(values);
    instance_report(m, ERROR, LOG_ERRORS, text.line);
    return ERROR;
}

Instance *instance_not_made(const char *function, const char *name, Reporter reporter, const char *what)
{
    Text text = {0};
    text_print(&text, "%s: %s", function, what);
    reporter.deliver(&reporter, name ? name : "", ERROR, categories_known[0], text.line);
    return NULL;
}

/* false: unknown. */
static bool add_category(unsigned *logs, const char *category)
{
    for (unsigned i = 0; category && i < N_CATEGORIES; i++)
        if (strcmp(category, categories_known[i]) == 0) {
            *logs |= 1u << i;
            return true;
        }
    return false;
}

Status instance_select_logs(Instance *m, const char *function, bool on, size_t n,
                            const char *const categories[])
{
    if (!instance_allows(m, function, BOTH | ANY_MODE) ||
        (n && !instance_has(m, function, "categories", categories)))
        return ERROR;
    unsigned logs = 0;
    for (size_t i = 0; i < n; i++)
        if (!add_category(&logs, categories[i]))
            return instance_refuse(m, function,
                                   "category %q is unknown; expected logStatusError, logStatusWarning, logEvents",
                                   categories[i]);
    if (!on)
        logs = LOG_ERRORS | LOG_WARNINGS;
    else if (n == 0)
        logs = LOG_ERRORS | LOG_WARNINGS | LOG_EVENTS;
    m->now.logs = logs;
    return OK;
}

/* Checks */

static void add_modes(Text *text, unsigned modes)
{
    const char *between = "";
    for (unsigned i = 0; i < N_MODES; i++)
        if (modes & 1u << i) {
            text_add(text, between);
            text_add(text, mode_names[i]);
            between = ", ";
        }
}

bool instance_forbids(const Instance *m, const char *function, unsigned where)
{
    if (!m)
        return false;
    const bool exchange = m->now.kind == MODEL_EXCHANGE;
    if (!(m->now.kind & where))
        return instance_refuse(m, function, "called for %s; expected %s", exchange ? "model exchange" : "co-simulation",
                               exchange ? "co-simulation" : "model exchange") == OK;
    Text text = {0};
    text_add(&text, "called in ");
    add_modes(&text, m->now.mode);
    text_add(&text, "; expected ");
    const unsigned modes = where & (exchange ? modes_of_model_exchange : modes_of_co_simulation);
    if (modes)
        add_modes(&text, modes);
    else
        text_add(&text, "no such call: this FMU has no event mode in co-simulation");
    return instance_refuse(m, function, "%s", text.line) == OK;
}

/* Life */

Instance *instance_new(const char *function, unsigned version, unsigned kind, const char *name,
                       const char *token, bool logging_on, Reporter reporter)
{
    Text text = {0};
    if (!name || !name[0])
        text_add(&text, "the instance name is empty; expected a name");
    else if (!token || strcmp(token, data.token) != 0)
        text_print(&text, "the token is %q; expected '%s', that of %s", token, data.token, data.name);
    if (text.length > 0)
        return instance_not_made(function, name, reporter, text.line);
    const size_t name_size = strlen(name) + 1;
    Instance *m = calloc(1, sizeof *m + name_size);
    Joint *joint = calloc(1, joint_size());
    if (!m || !joint) {
        free(m);
        free(joint);
        return instance_not_made(function, name, reporter, "no memory is left; expected some for a new instance");
    }
    m->joint = joint;
    m->version = version;
    m->now.kind = kind;
    m->logging_on = logging_on;
    m->reporter = reporter;
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
    State *now = &m->now;
    const unsigned kind = now->kind;
    memset(now, 0, sizeof *now);
    now->kind = kind;
    memcpy(now->values, data.start, sizeof now->values);
    now->values[0] = 0.0;
    now->stop = INFINITY;
    now->logs = LOG_ERRORS | LOG_WARNINGS | (m->logging_on ? LOG_EVENTS : 0u);
    m->dirty = m->parameters_changed = true;
    instance_enter(m, INSTANTIATED);
}

Status instance_restart(Instance *m, const char *function)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE))
        return ERROR;
    instance_reset(m);
    return OK;
}

void instance_enter(Instance *m, unsigned mode)
{
    m->now.mode = mode;
    Text text = {0};
    text_add(&text, "now in ");
    add_modes(&text, mode);
    instance_report(m, OK, LOG_EVENTS, text.line);
}

Status instance_set_experiment(Instance *m, const char *function, double tolerance, double start,
                               bool stop_defined, double stop)
{
    if (!instance_allows(m, function, BOTH | INSTANTIATED))
        return ERROR;
    if (!isfinite(start) || (stop_defined && !(stop >= start))) {
        Text text = {0};
        text_print(&text, "start time %.16g", start);
        if (stop_defined)
            text_print(&text, " and stop time %.16g", stop);
        return instance_refuse(m, function, "%s; expected a finite start time, and a stop time not before it",
                               text.line);
    }
    m->now.values[0] = m->now.start = start;
    m->dirty = true;
    m->now.stop = stop_defined ? stop : INFINITY;
    m->now.tolerance = tolerance;
    return OK;
}

Status instance_change(Instance *m, const char *function, unsigned where, unsigned mode)
{
    if (!instance_allows(m, function, where))
        return ERROR;
    instance_enter(m, mode);
    return OK;
}

Status instance_set_time(Instance *m, const char *function, double time)
{
    if (!instance_allows(m, function, MODEL_EXCHANGE | EVENT | CONTINUOUS_TIME))
        return ERROR;
    if (!isfinite(time))
        return instance_refuse(m, function, "the time is not finite; expected a finite one");
    m->now.values[0] = time;
    m->dirty |= MOVES;
    return OK;
}

END_OF_COLD
