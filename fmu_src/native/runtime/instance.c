#include "instance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static void explain(Text *text, const char *function, const char *what)
{
    text_clear(text);
    text_add(text, function);
    text_add(text, ": ");
    text_add(text, what);
}

Status instance_refuse(const Instance *m, const char *function, const char *what)
{
    Text text;
    explain(&text, function, what);
    instance_report(m, ERROR, LOG_ERRORS, text.line);
    return ERROR;
}

void instance_not_made(const char *function, const char *name, Reporter reporter, const char *what)
{
    Text text;
    explain(&text, function, what);
    reporter.deliver(&reporter, name ? name : "", ERROR, categories_known[0], text.line);
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
        if (!add_category(&logs, categories[i])) {
            Text text;
            text_clear(&text);
            text_add(&text, "category ");
            text_quote(&text, categories[i]);
            text_add(&text, " is unknown; expected logStatusError, logStatusWarning, logEvents");
            return instance_refuse(m, function, text.line);
        }
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
    Text text;
    text_clear(&text);
    const bool exchange = m->now.kind == MODEL_EXCHANGE;
    if (m->now.kind & where) {
        text_add(&text, "called in ");
        add_modes(&text, m->now.mode);
        text_add(&text, "; expected ");
        const unsigned modes = where & (exchange ? modes_of_model_exchange : modes_of_co_simulation);
        if (modes)
            add_modes(&text, modes);
        else
            text_add(&text, "no such call: this FMU has no event mode in co-simulation");
    } else {
        text_add(&text, exchange ? "called for model exchange" : "called for co-simulation");
        text_add(&text, exchange ? "; expected co-simulation" : "; expected model exchange");
    }
    instance_refuse(m, function, text.line);
    return false;
}

bool instance_lacks(const Instance *m, const char *function, const char *what)
{
    Text text;
    text_clear(&text);
    text_add(&text, what);
    text_add(&text, " is NULL; expected a pointer");
    instance_refuse(m, function, text.line);
    return false;
}

bool instance_counts(const Instance *m, const char *function, const char *what, size_t given, size_t expected)
{
    if (given == expected)
        return true;
    Text text;
    text_clear(&text);
    text_count(&text, given);
    text_add(&text, " ");
    text_add(&text, what);
    text_add(&text, "; expected ");
    text_count(&text, expected);
    instance_refuse(m, function, text.line);
    return false;
}

/* Life */

static bool refused_name_or_token(Text *text, const char *name, const char *token)
{
    text_clear(text);
    if (!name || !name[0])
        text_add(text, "the instance name is empty; expected a name");
    else if (!token || strcmp(token, data.token) != 0) {
        text_add(text, "the token is ");
        text_quote(text, token);
        text_add(text, "; expected '");
        text_add(text, data.token);
        text_add(text, "', that of ");
        text_add(text, data.name);
    }
    return text->length > 0;
}

Instance *instance_new(const char *function, unsigned version, unsigned kind, const char *name,
                       const char *token, bool logging_on, Reporter reporter)
{
    Text text;
    if (refused_name_or_token(&text, name, token)) {
        instance_not_made(function, name, reporter, text.line);
        return NULL;
    }
    const size_t name_size = strlen(name) + 1;
    Instance *m = calloc(1, sizeof *m + name_size);
    Joint *joint = calloc(1, joint_size());
    if (!m || !joint) {
        free(m);
        free(joint);
        instance_not_made(function, name, reporter, "no memory is left; expected some for a new instance");
        return NULL;
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
    for (size_t i = 0; i < N_VALUES; i++)
        now->values[i] = data.start[i];
    memset(now->slopes, 0, sizeof now->slopes);
    memset(now->last_inputs, 0, sizeof now->last_inputs);
    now->last_rate = now->last_size = 0.0;
    now->values[0] = now->start = 0.0;
    now->stop = INFINITY;
    now->warned = 0;
    now->logs = LOG_ERRORS | LOG_WARNINGS | (m->logging_on ? LOG_EVENTS : 0u);
    now->last_step = OK;
    memset(&now->path, 0, sizeof now->path);
    m->dirty = m->parameters_changed = true;
    instance_enter(m, INSTANTIATED);
}

void instance_enter(Instance *m, unsigned mode)
{
    m->now.mode = mode;
    Text text;
    text_clear(&text);
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
        Text text;
        text_clear(&text);
        text_add(&text, "start time ");
        text_number(&text, start, 16);
        if (stop_defined) {
            text_add(&text, " and stop time ");
            text_number(&text, stop, 16);
        }
        text_add(&text, "; expected a finite start and a stop that is not before it");
        return instance_refuse(m, function, text.line);
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
