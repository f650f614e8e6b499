#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "optimize_for_size.h"
#include "instance.h"

OPTIMIZE_FOR_SIZE

/* FMU states that the host holds, and their serialization: little endian, the same bytes on every platform.
 *
 *   16  "jointfmu state 1"
 *    4  FMI version
 *    4  length of the token, then the token: states of another FMU, or of other contents, are an error
 *   ..  the members of InstanceState in the order of `transfer_state`, each in the range that `check_values` allows
 *    8  checksum (FNV-1a, 64 bits) of all bytes before */

static const char magic[16 + 1] = "jointfmu state 1";

typedef struct {
    char magic[sizeof magic]; /* distinguishes an FMU state from any other pointer */
    unsigned fmi_version;
    char token[sizeof data.token]; /* of the FMU that saved it: states of other FMUs have other sizes */
    InstanceState state;
} SavedState;

/* Serialization: the same functions write, read and count bytes */

typedef struct {
    unsigned char *bytes;      /* to write; NULL to count or to read */
    const unsigned char *from; /* to read; NULL to count or to write */
    size_t position;
} Cursor;

/* Write, read or count the `n` lowest bytes of a number. */
static void transfer_bytes(Cursor *c, uint64_t *number, unsigned n)
{
    uint64_t word = 0;
    for (unsigned i = 0; i < n; i++) {
        if (c->bytes)
            c->bytes[c->position + i] = (unsigned char)(*number >> 8 * i & 0xFF);
        if (c->from)
            word |= (uint64_t)c->from[c->position + i] << 8 * i;
    }
    if (c->from)
        *number = word;
    c->position += n;
}

static void transfer_word(Cursor *c, unsigned *value)
{
    uint64_t number = *value;
    transfer_bytes(c, &number, 4);
    *value = (unsigned)number;
}

static void transfer_doubles(Cursor *c, double values[], size_t n)
{
    if (!c->bytes && !c->from) {
        c->position += 8 * n;
        return;
    }
    for (size_t i = 0; i < n; i++) {
        uint64_t number;
        memcpy(&number, &values[i], sizeof number);
        transfer_bytes(c, &number, 8);
        memcpy(&values[i], &number, sizeof number);
    }
}

static void transfer_text(Cursor *c, char text[], size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint64_t number = (unsigned char)text[i];
        transfer_bytes(c, &number, 1);
        text[i] = (char)number;
    }
}

/* Serialized data before the state. */
typedef struct {
    char magic[sizeof magic], token[sizeof data.token];
    unsigned fmi_version, length; /* version of FMI; length of the token */
} Header;

/* Transfer a header. The token has the length of this FMU's token. */
static void transfer_header(Cursor *c, Header *header)
{
    transfer_text(c, header->magic, sizeof magic - 1);
    transfer_word(c, &header->fmi_version);
    transfer_word(c, &header->length);
    transfer_text(c, header->token, strlen(data.token));
}

static Header make_header(unsigned fmi_version)
{
    Header header = {.fmi_version = fmi_version, .length = (unsigned)strlen(data.token)};
    memcpy(header.magic, magic, sizeof magic);
    memcpy(header.token, data.token, sizeof data.token);
    return header;
}

/* Transfer the members of a state. */
static void transfer_state(Cursor *c, InstanceState *s)
{
    unsigned last_step_status = s->last_step_status;
    transfer_word(c, &s->interface_type);
    transfer_word(c, &s->mode);
    transfer_word(c, &s->reported_warnings);
    transfer_word(c, &s->log_categories);
    transfer_word(c, &last_step_status);
    transfer_doubles(c, &s->start_time, 1);
    transfer_doubles(c, &s->stop_time, 1);
    transfer_doubles(c, s->input_derivatives, N_INPUTS);
    transfer_doubles(c, s->values, FIRST_OUTPUT + N_STATES);
    transfer_doubles(c, s->values + FIRST_PARAMETER, N_PARAMETERS);
    if (N_STATES) {
        transfer_doubles(c, s->previous_inputs, N_INPUTS);
        transfer_doubles(c, &s->previous_acceleration, 1);
        transfer_doubles(c, &s->previous_step_size, 1);
        transfer_doubles(c, &s->tolerance, 1);
    }
    if (N_HISTORY) {
        transfer_doubles(c, s->path.history[0], N_HISTORY);
        transfer_doubles(c, s->path.history[1], N_HISTORY);
        transfer_doubles(c, s->path.variables, N_PATH_VARIABLES);
        transfer_word(c, &s->path.end_index);
        transfer_word(c, &s->path.has_accepted_inputs);
    }
    s->last_step_status = (Status)last_step_status;
}

/* Number of bytes of a serialized state; it is the same for all states. */
static size_t serialized_size(const InstanceState *any)
{
    Cursor count = {NULL, NULL, 0};
    Header header = make_header(0);
    transfer_header(&count, &header);
    transfer_state(&count, (InstanceState *)any); /* nothing is written when bytes are counted */
    return count.position + 8;
}

static uint64_t checksum(const unsigned char bytes[], size_t n)
{
    uint64_t sum = 0xCBF29CE484222325u;
    for (size_t i = 0; i < n; i++)
        sum = (sum ^ bytes[i]) * 0x100000001B3u;
    return sum;
}

/* Checks */

/* Whether a pointer of the host is an FMU state of this FMU. */
static bool check_saved_state(const Instance *m, const char *function, const SavedState *saved)
{
    if (!instance_check_pointer(m, function, "the FMU state", saved))
        return false;
    if (memcmp(saved->magic, magic, sizeof magic) == 0 && saved->fmi_version == m->fmi_version &&
        memcmp(saved->token, data.token, sizeof data.token) == 0)
        return true;
    return instance_log_error(m, function, "the FMU state was not made by %s; expected one that this FMU returned",
                              data.name) == OK;
}

static Status refuse_bytes(const Instance *m, const char *function, const char *problem)
{
    return instance_log_error(m, function, "the bytes are %s; expected a state serialized by %s with the token %s",
                              problem, data.name, data.token);
}

/* Whether bytes of the host begin with the header of a state of this FMU. */
static bool check_header(const Instance *m, const char *function, const void *bytes, size_t size)
{
    const Header own = make_header(m->fmi_version);
    Cursor count = {NULL, NULL, 0}, from = {NULL, bytes, 0};
    Header header = {.fmi_version = 0};
    transfer_header(&count, &header);
    if (size < count.position)
        return instance_check_count(m, function, "bytes", size, serialized_size(&m->state));
    transfer_header(&from, &header);
    Text problem = {0};
    if (strcmp(header.magic, own.magic) != 0)
        text_append(&problem, "no FMU state");
    else if (header.fmi_version != own.fmi_version)
        text_append_format(&problem, "a state of FMI %zu, not %zu", (size_t)header.fmi_version,
                           (size_t)own.fmi_version);
    else if (header.length != own.length || strcmp(header.token, own.token) != 0)
        text_append_format(&problem, "a state of another FMU, with the token %q", header.token);
    return problem.length == 0 || refuse_bytes(m, function, problem.line) == OK;
}

/* Whether the flags and numbers of a state that was read are possible in an instance. Integers index arrays and select
 * code, and history variables are not checked anywhere else. Inputs, continuous states and parameters may have any
 * value, because a host can set any; they are checked when they are evaluated. */
static bool check_values(const Instance *m, const char *function, const InstanceState *s)
{
    const struct {
        const char *name;
        size_t value;
        bool is_valid;
        const char *allowed;
    } flags[] = {
        {"interface type", s->interface_type, s->interface_type == MODEL_EXCHANGE || s->interface_type == CO_SIMULATION,
         "256, 512"},
        {"mode", s->mode, instance_mode_is_possible(s->interface_type, m->fmi_version, s->mode),
         "one mode of that interface type"},
        {"log categories", s->log_categories, s->log_categories <= (LOG_ERRORS | LOG_WARNINGS | LOG_EVENTS), "0 to 7"},
        {"status of the last step", (size_t)s->last_step_status,
         s->last_step_status == OK || s->last_step_status == ERROR, "0, 3"},
        {"end index of the path", s->path.end_index, s->path.end_index <= 1, "0, 1"},
        {"flag of accepted inputs", s->path.has_accepted_inputs, s->path.has_accepted_inputs <= 1, "0, 1"},
    };
    const struct {
        const char *name;
        const double *values;
        size_t count;
    } numbers[] = {
        {"time", s->values, 1},
        {"start time", &s->start_time, 1},
        {"input derivatives", s->input_derivatives, N_INPUTS},
        {"previous step size", &s->previous_step_size, 1},
        {"history 0", s->path.history[0], N_HISTORY},
        {"history 1", s->path.history[1], N_HISTORY},
    };
    Text problem = {0};
    for (size_t i = 0; i < sizeof flags / sizeof *flags && !problem.length; i++)
        if (!flags[i].is_valid)
            text_append_format(&problem, "corrupt: %s is %zu, allowed: %s", flags[i].name, flags[i].value,
                               flags[i].allowed);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && !problem.length; i++)
        for (size_t k = 0; k < numbers[i].count && !problem.length; k++)
            if (!isfinite(numbers[i].values[k]))
                text_append_format(&problem, "corrupt: %s, number %zu, is %g, allowed: finite numbers", numbers[i].name,
                                   k, numbers[i].values[k]);
    if (!problem.length && !(s->stop_time >= s->start_time))
        text_append_format(&problem, "corrupt: stop is %g, allowed: from start = %g on", s->stop_time, s->start_time);
    return problem.length == 0 || refuse_bytes(m, function, problem.line) == OK;
}

/* Whether a state is of the same interface type as the instance. */
static bool check_interface_type(const Instance *m, const char *function, const InstanceState *s)
{
    const char *own = m->state.interface_type == MODEL_EXCHANGE ? "model exchange" : "co-simulation";
    const char *other = m->state.interface_type == MODEL_EXCHANGE ? "co-simulation" : "model exchange";
    return s->interface_type == m->state.interface_type ||
           instance_log_error(m, function, "the state is one of %s; expected one of %s", other, own) == OK;
}

/* New FMU state; NULL, with an error, if no memory is left. */
static SavedState *new_saved_state(const Instance *m, const char *function)
{
    SavedState *saved = calloc(1, sizeof *saved);
    if (!saved) {
        instance_log_error(m, function, "out of memory; expected free memory for a state");
        return NULL;
    }
    memcpy(saved->magic, magic, sizeof magic);
    saved->fmi_version = m->fmi_version;
    memcpy(saved->token, data.token, sizeof data.token);
    return saved;
}

/* Copy a state for the host: into the FMU state that it passes, or into a new one if that is NULL. */
static Status copy_to_host(const Instance *m, const char *function, const InstanceState *state, void **saved)
{
    if (*saved && !check_saved_state(m, function, *saved))
        return ERROR;
    SavedState *to = *saved ? *saved : new_saved_state(m, function);
    if (!to)
        return ERROR;
    to->state = *state;
    *saved = to;
    return OK;
}

/* Functions of instance.h */

Status state_save(const Instance *m, const char *function, void **saved)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE) ||
        !instance_check_pointer(m, function, "the pointer to the FMU state", saved))
        return ERROR;
    return copy_to_host(m, function, &m->state, saved);
}

Status state_restore(Instance *m, const char *function, const void *saved)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE) || !check_saved_state(m, function, saved))
        return ERROR;
    const SavedState *from = saved;
    if (!check_interface_type(m, function, &from->state))
        return ERROR;
    m->state = from->state;
    m->outputs_outdated = m->parameters_changed = true;
    instance_log(m, OK, LOG_EVENTS, "FMU state restored");
    return OK;
}

Status state_free(const Instance *m, const char *function, void **saved)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE))
        return ERROR;
    if (!saved || !*saved)
        return OK; /* as the standard says */
    if (!check_saved_state(m, function, *saved))
        return ERROR;
    free(*saved);
    *saved = NULL;
    return OK;
}

Status state_serialized_size(const Instance *m, const char *function, const void *saved, size_t *size)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE) || !check_saved_state(m, function, saved) ||
        !instance_check_pointer(m, function, "the size", size))
        return ERROR;
    *size = serialized_size(&m->state);
    return OK;
}

Status state_serialize(const Instance *m, const char *function, const void *saved, void *bytes, size_t size)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE) || !check_saved_state(m, function, saved) ||
        !instance_check_pointer(m, function, "the array of bytes", bytes) ||
        !instance_check_count(m, function, "bytes of room", size, serialized_size(&m->state)))
        return ERROR;
    Cursor to = {bytes, NULL, 0};
    Header header = make_header(m->fmi_version);
    transfer_header(&to, &header);
    transfer_state(&to, (InstanceState *)&((const SavedState *)saved)->state); /* not changed when bytes are written */
    uint64_t sum = checksum(bytes, to.position);
    transfer_bytes(&to, &sum, 8);
    return OK;
}

Status state_deserialize(Instance *m, const char *function, const void *bytes, size_t size, void **saved)
{
    if (!instance_check_mode(m, function, BOTH_INTERFACES | ANY_MODE) ||
        !instance_check_pointer(m, function, "the array of bytes", bytes) ||
        !instance_check_pointer(m, function, "the pointer to the FMU state", saved))
        return ERROR;
    if (!check_header(m, function, bytes, size) ||
        !instance_check_count(m, function, "bytes", size, serialized_size(&m->state)))
        return ERROR;
    Cursor end = {NULL, bytes, size - 8}, from = {NULL, bytes, 0};
    uint64_t written = 0;
    transfer_bytes(&end, &written, 8);
    if (written != checksum(bytes, size - 8))
        return refuse_bytes(m, function, "corrupt: their checksum is wrong");
    Header header = {.fmi_version = 0};
    SavedState *new_saved = new_saved_state(m, function); /* of its own: a refusal leaves that of the host as it is */
    if (!new_saved)
        return ERROR;
    transfer_header(&from, &header);
    transfer_state(&from, &new_saved->state);
    const InstanceState *state = &new_saved->state;
    const bool is_accepted = check_values(m, function, state) && check_interface_type(m, function, state);
    const Status status = is_accepted ? copy_to_host(m, function, state, saved) : ERROR;
    free(new_saved);
    return status;
}

END_OPTIMIZE_FOR_SIZE
