#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cold.h"
#include "instance.h"

COLD

/* A state in the hands of the host, and its bytes: little endian, the same on every platform.
 *
 *   16  "jointfmu state 1"
 *    4  FMI version
 *    4  length of the token, then the token: states of another FMU or of other contents are refused
 *   ..  the members of State as `pass` lists them, each in the range that `is_possible` allows
 *    8  checksum (FNV-1a, 64 bits) of all before */

static const char magic[16 + 1] = "jointfmu state 1";

typedef struct {
    char magic[sizeof magic]; /* tells a state from another pointer */
    unsigned version;
    char token[sizeof data.token]; /* of the FMU that gave it: states of others have other sizes */
    State state;
} SavedState;

/* Bytes */

typedef struct {
    unsigned char *bytes;      /* to write; NULL to count or to read */
    const unsigned char *from; /* to read; NULL to count or to write */
    size_t at;
} Cursor;

/* Write, read or count the lowest `n` bytes of a number. */
static void pass_bytes(Cursor *c, uint64_t *number, unsigned n)
{
    uint64_t word = 0;
    for (unsigned i = 0; i < n; i++) {
        if (c->bytes)
            c->bytes[c->at + i] = (unsigned char)(*number >> 8 * i & 0xFF);
        if (c->from)
            word |= (uint64_t)c->from[c->at + i] << 8 * i;
    }
    if (c->from)
        *number = word;
    c->at += n;
}

static void pass_word(Cursor *c, unsigned *value)
{
    uint64_t number = *value;
    pass_bytes(c, &number, 4);
    *value = (unsigned)number;
}

static void pass_doubles(Cursor *c, double values[], size_t n)
{
    if (!c->bytes && !c->from) {
        c->at += 8 * n;
        return;
    }
    for (size_t i = 0; i < n; i++) {
        uint64_t number;
        memcpy(&number, &values[i], sizeof number);
        pass_bytes(c, &number, 8);
        memcpy(&values[i], &number, sizeof number);
    }
}

static void pass_text(Cursor *c, char text[], size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint64_t number = (unsigned char)text[i];
        pass_bytes(c, &number, 1);
        text[i] = (char)number;
    }
}

/* What stands before a state. */
typedef struct {
    char magic[sizeof magic], token[sizeof data.token];
    unsigned version, length; /* of FMI; of the token */
} Head;

/* The token is passed in the length that this FMU's has. */
static void pass_head(Cursor *c, Head *head)
{
    pass_text(c, head->magic, sizeof magic - 1);
    pass_word(c, &head->version);
    pass_word(c, &head->length);
    pass_text(c, head->token, strlen(data.token));
}

static Head head_of(unsigned version)
{
    Head head = {.version = version, .length = (unsigned)strlen(data.token)};
    memcpy(head.magic, magic, sizeof magic);
    memcpy(head.token, data.token, sizeof data.token);
    return head;
}

static void pass(Cursor *c, State *s)
{
    unsigned last_step = s->last_step;
    pass_word(c, &s->kind);
    pass_word(c, &s->mode);
    pass_word(c, &s->warned);
    pass_word(c, &s->logs);
    pass_word(c, &last_step);
    pass_doubles(c, &s->start, 1);
    pass_doubles(c, &s->stop, 1);
    pass_doubles(c, s->slopes, N_INPUTS);
    pass_doubles(c, s->values, FIRST_OUTPUT + N_STATES);
    pass_doubles(c, s->values + FIRST_PARAMETER, N_PARAMETERS);
    if (N_STATES) {
        pass_doubles(c, s->last_inputs, N_INPUTS);
        pass_doubles(c, &s->last_rate, 1);
        pass_doubles(c, &s->last_size, 1);
        pass_doubles(c, &s->tolerance, 1);
    }
    if (N_MEMORY) {
        pass_doubles(c, s->path.memory[0], N_MEMORY);
        pass_doubles(c, s->path.memory[1], N_MEMORY);
        pass_doubles(c, s->path.knowns, N_PATH);
        pass_word(c, &s->path.last);
        pass_word(c, &s->path.accepted);
    }
    s->last_step = (Status)last_step;
}

/* Bytes of a state; which one does not matter. */
static size_t full_size(const State *any)
{
    Cursor count = {NULL, NULL, 0};
    Head head = head_of(0);
    pass_head(&count, &head);
    pass(&count, (State *)any); /* nothing is written when bytes are counted */
    return count.at + 8;
}

static uint64_t checksum(const unsigned char bytes[], size_t n)
{
    uint64_t sum = 0xCBF29CE484222325u;
    for (size_t i = 0; i < n; i++)
        sum = (sum ^ bytes[i]) * 0x100000001B3u;
    return sum;
}

/* Checks */

static bool is_saved(const Instance *m, const char *function, const SavedState *saved)
{
    if (!instance_has(m, function, "the FMU state", saved))
        return false;
    if (memcmp(saved->magic, magic, sizeof magic) == 0 && saved->version == m->version &&
        memcmp(saved->token, data.token, sizeof data.token) == 0)
        return true;
    return instance_refuse(m, function, "this is not an FMU state of %s; expected one that it gave", data.name) == OK;
}

static Status refuse_bytes(const Instance *m, const char *function, const char *what)
{
    return instance_refuse(m, function, "the bytes are %s; expected a state that %s with the token %s serialized",
                           what, data.name, data.token);
}

/* Whether bytes begin as a state of this FMU does. */
static bool is_own(const Instance *m, const char *function, const void *bytes, size_t size)
{
    const Head own = head_of(m->version);
    Cursor count = {NULL, NULL, 0}, from = {NULL, bytes, 0};
    Head head = {.version = 0};
    pass_head(&count, &head);
    if (size < count.at)
        return instance_counts(m, function, "bytes", size, full_size(&m->now));
    pass_head(&from, &head);
    Text what = {0};
    if (strcmp(head.magic, own.magic) != 0)
        text_add(&what, "no state at all");
    else if (head.version != own.version)
        text_print(&what, "a state of FMI %zu, not %zu", (size_t)head.version, (size_t)own.version);
    else if (head.length != own.length || strcmp(head.token, own.token) != 0)
        text_print(&what, "a state of another FMU, with the token %q", head.token);
    return what.length == 0 || refuse_bytes(m, function, what.line) == OK;
}

/* Whether all flags and numbers of a state that was read are such as an instance can have: whole numbers index
 * arrays and select code, and a joint's history is not checked anywhere else. Inputs, continuous states and
 * parameters may have any value, as hosts can set any; they are checked where they are evaluated. */
static bool is_possible(const Instance *m, const char *function, const State *s)
{
    const struct {
        const char *name;
        size_t value;
        bool right;
        const char *allowed;
    } words[] = {
        {"kind", s->kind, s->kind == MODEL_EXCHANGE || s->kind == CO_SIMULATION, "256, 512"},
        {"mode", s->mode, instance_can_be_in(s->kind, m->version, s->mode), "one mode of that kind of instance"},
        {"logs", s->logs, s->logs <= (LOG_ERRORS | LOG_WARNINGS | LOG_EVENTS), "0 to 7"},
        {"last_step", (size_t)s->last_step, s->last_step == OK || s->last_step == ERROR, "0, 3"},
        {"path.last", s->path.last, s->path.last <= 1, "0, 1"},
        {"path.accepted", s->path.accepted, s->path.accepted <= 1, "0, 1"},
    };
    const struct {
        const char *name;
        const double *values;
        size_t count;
    } numbers[] = {
        {"time", s->values, 1},
        {"start", &s->start, 1},
        {"slopes", s->slopes, N_INPUTS},
        {"last_size", &s->last_size, 1},
        {"path.memory[0]", s->path.memory[0], N_MEMORY},
        {"path.memory[1]", s->path.memory[1], N_MEMORY},
    };
    Text what = {0};
    for (size_t i = 0; i < sizeof words / sizeof *words && !what.length; i++)
        if (!words[i].right)
            text_print(&what, "corrupt: %s is %zu, allowed: %s", words[i].name, words[i].value, words[i].allowed);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && !what.length; i++)
        for (size_t k = 0; k < numbers[i].count && !what.length; k++)
            if (!isfinite(numbers[i].values[k]))
                text_print(&what, "corrupt: %s, number %zu, is %g, allowed: finite numbers", numbers[i].name, k,
                           numbers[i].values[k]);
    if (!what.length && !(s->stop >= s->start))
        text_print(&what, "corrupt: stop is %g, allowed: from start = %g on", s->stop, s->start);
    return what.length == 0 || refuse_bytes(m, function, what.line) == OK;
}

/* A state of the same kind of instance. */
static bool fits(const Instance *m, const char *function, const State *s)
{
    const char *own = m->now.kind == MODEL_EXCHANGE ? "model exchange" : "co-simulation";
    const char *other = m->now.kind == MODEL_EXCHANGE ? "co-simulation" : "model exchange";
    return s->kind == m->now.kind ||
           instance_refuse(m, function, "the state is one of %s; expected one of %s", other, own) == OK;
}

/* Give a state to the host: in its own, if it gives one back. */
static Status hand_over(const Instance *m, const char *function, const State *state, void **saved)
{
    if (*saved && !is_saved(m, function, *saved))
        return ERROR;
    SavedState *to = *saved ? *saved : calloc(1, sizeof *to);
    if (!to)
        return instance_refuse(m, function, "out of memory; expected free memory for a state");
    memcpy(to->magic, magic, sizeof magic);
    to->version = m->version;
    memcpy(to->token, data.token, sizeof data.token);
    to->state = *state;
    *saved = to;
    return OK;
}

/* Entry points */

Status state_save(const Instance *m, const char *function, void **saved)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE) ||
        !instance_has(m, function, "the pointer to the FMU state", saved))
        return ERROR;
    return hand_over(m, function, &m->now, saved);
}

Status state_restore(Instance *m, const char *function, const void *saved)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE) || !is_saved(m, function, saved))
        return ERROR;
    const SavedState *from = saved;
    if (!fits(m, function, &from->state))
        return ERROR;
    m->now = from->state;
    m->dirty = m->parameters_changed = true;
    instance_report(m, OK, LOG_EVENTS, "FMU state restored");
    return OK;
}

Status state_free(const Instance *m, const char *function, void **saved)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE))
        return ERROR;
    if (!saved || !*saved)
        return OK; /* as the standard says */
    if (!is_saved(m, function, *saved))
        return ERROR;
    free(*saved);
    *saved = NULL;
    return OK;
}

Status state_size(const Instance *m, const char *function, const void *saved, size_t *size)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE) || !is_saved(m, function, saved) ||
        !instance_has(m, function, "the size", size))
        return ERROR;
    *size = full_size(&m->now);
    return OK;
}

Status state_write(const Instance *m, const char *function, const void *saved, void *bytes, size_t size)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE) || !is_saved(m, function, saved) ||
        !instance_has(m, function, "the array of bytes", bytes) ||
        !instance_counts(m, function, "bytes of room", size, full_size(&m->now)))
        return ERROR;
    Cursor to = {bytes, NULL, 0};
    Head head = head_of(m->version);
    pass_head(&to, &head);
    pass(&to, (State *)&((const SavedState *)saved)->state); /* only read when bytes are written */
    uint64_t sum = checksum(bytes, to.at);
    pass_bytes(&to, &sum, 8);
    return OK;
}

Status state_read(Instance *m, const char *function, const void *bytes, size_t size, void **saved)
{
    if (!instance_allows(m, function, BOTH | ANY_MODE) ||
        !instance_has(m, function, "the array of bytes", bytes) ||
        !instance_has(m, function, "the pointer to the FMU state", saved))
        return ERROR;
    if (!is_own(m, function, bytes, size) ||
        !instance_counts(m, function, "bytes", size, full_size(&m->now)))
        return ERROR;
    Cursor end = {NULL, bytes, size - 8}, from = {NULL, bytes, 0};
    uint64_t written = 0;
    pass_bytes(&end, &written, 8);
    if (written != checksum(bytes, size - 8))
        return refuse_bytes(m, function, "corrupt: their checksum is wrong");
    State *read = &m->kept; /* which is free between two calls */
    Head head = {.version = 0};
    memset(read, 0, sizeof *read);
    pass_head(&from, &head);
    pass(&from, read);
    return is_possible(m, function, read) && fits(m, function, read) ? hand_over(m, function, read, saved) : ERROR;
}

END_OF_COLD
