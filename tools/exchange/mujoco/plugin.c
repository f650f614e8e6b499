/* MuJoCo plugin: a joint between two flanges (first inputs phi1, w1, phi2, w2; first outputs tau1, tau2) as passive
 * force and sensor. Further inputs keep their start values.
 *
 * The plugin is compiled with the C sources of an FMU. Each plugin instance has an instance of the FMU. Its accepted
 * path is stored in MuJoCo's plugin state (history at start and end, inputs at the end, flag of accepted inputs), so
 * mjData can be copied, saved and set. History variables that the parameters leave unused, such as those of a
 * hysteresis that is switched off, are not stored. */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

enum { PHI1, W1, PHI2, W2 };
enum { MAX_PLUGIN_STATE = N_HISTORY ? 2 * N_HISTORY + N_PATH_VARIABLES + 1 : 0 }; /* numbers, at most */
_Static_assert(N_INPUTS > W2 && N_OUTPUTS >= 2 && !IS_TIME_DEPENDENT, "a joint between two flanges");

typedef struct {
    Instance *instance;
    int joints[2];
    int n_unused_history; /* number of history variables, the first ones, that stay zero */
    bool is_current;      /* the FMU instance holds the evaluation that started from `plugin_state` */
    mjtNum plugin_state[MAX_PLUGIN_STATE + 1];   /* C has no empty arrays */
    char error_message[sizeof((Text *)0)->line]; /* last error of the FMU */
} Coupling;

/* Log messages: warnings go to MuJoCo; the last error is kept for the MuJoCo error that follows */

static void log_message(const Logger *logger, const char *name, Status status, const char *category, const char *line)
{
    (void)category;
    Coupling *c = logger->environment;
    if (status == ERROR)
        snprintf(c->error_message, sizeof c->error_message, "%s", line);
    else
        mju_warning("%s: %s", name, line);
}

/* Configuration: joints for phi1 and phi2, and parameters by name */

static bool find_joint(Coupling *c, const mjModel *m, int instance, const char *key, bool allow_slide, int *joint)
{
    const char *name = mj_getPluginConfig(m, instance, key);
    *joint = name && *name ? mj_name2id(m, mjOBJ_JOINT, name) : -1;
    if (*joint >= 0 && (m->jnt_type[*joint] == mjJNT_HINGE || (allow_slide && m->jnt_type[*joint] == mjJNT_SLIDE)))
        return true;
    snprintf(c->error_message, sizeof c->error_message, "%s = '%.80s' is not a hinge joint; expected the name of one",
             key, name ? name : "");
    return false;
}

static bool set_parameter(Coupling *c, const char *text, uint32_t ref)
{
    const Variable *v = &variables[ref];
    char *end;
    double value = strtod(text, &end);
    bool is_valid = *end == '\0' && end != text;
    if (v->is_boolean) {
        value = strcmp(text, "true") == 0;
        is_valid = value || strcmp(text, "false") == 0;
    }
    if (is_valid)
        instance_set_parameter(c->instance, ref, value);
    else
        snprintf(c->error_message, sizeof c->error_message, "%s = '%.80s' is not a %s", v->name, text,
                 v->is_boolean ? "Boolean; expected true or false" : "number; expected one");
    return is_valid;
}

static bool set_parameters(Coupling *c, const mjModel *m, int instance)
{
    for (uint32_t ref = FIRST_PARAMETER; ref < N_VALUES; ref++) {
        const char *text = mj_getPluginConfig(m, instance, variables[ref].name);
        if (text && *text && !set_parameter(c, text, ref))
            return false;
    }
    c->instance->outputs_outdated = c->instance->parameters_changed = true;
    return instance_set_experiment(c->instance, "init", 0.0, 0.0, false, 0.0) == OK &&
           instance_enter_mode(c->instance, "init", BOTH_INTERFACES | INSTANTIATED, INITIALIZATION) == OK &&
           instance_initialize(c->instance, "init") == OK;
}

static void free_coupling(Coupling *c)
{
    if (c)
        instance_free(c->instance);
    free(c);
}

static Coupling *new_coupling(const char *name)
{
    Coupling *c = calloc(1, sizeof *c);
    if (!c)
        return NULL;
    const Logger logger = {log_message, NULL, c};
    c->instance = instance_create("init", 3, MODEL_EXCHANGE, name, data.token, false, logger);
    return c;
}

static int init(const mjModel *m, mjData *d, int instance)
{
    const char *own_name = mj_id2name(m, mjOBJ_PLUGIN, instance), *name = own_name && *own_name ? own_name : data.name;
    Coupling *c = new_coupling(name);
    if (!c)
        return -1;
    if (!c->instance || !find_joint(c, m, instance, "phi1", true, &c->joints[0]) ||
        !find_joint(c, m, instance, "phi2", false, &c->joints[1]) || !set_parameters(c, m, instance)) {
        char error_message[sizeof c->error_message];
        memcpy(error_message, c->error_message, sizeof error_message);
        free_coupling(c);
        mju_error("%s: %s", name, error_message);
        return -1;
    }
    c->n_unused_history = (MAX_PLUGIN_STATE - m->plugin_statenum[instance]) / 2;
    d->plugin_data[instance] = (uintptr_t)c;
    return 0;
}

static void destroy(mjData *d, int instance)
{
    free_coupling((Coupling *)d->plugin_data[instance]);
    d->plugin_data[instance] = 0;
}

/* Accepted path of the inputs */

/* Number of first history variables that a small first motion leaves zero: the features that they belong to are
 * switched off. Parameters that are refused here are reported when MuJoCo makes its data. */
static int count_unused_history(Coupling *c, const mjModel *m, int instance)
{
    int n = 0;
    if (!c->instance || !set_parameters(c, m, instance))
        return 0;
    c->instance->state.values[FIRST_INPUT + PHI1] = 1e-6;
    c->instance->outputs_outdated = true;
    if (instance_evaluate(c->instance, ERROR) != OK)
        return 0;
    while (n < N_HISTORY && c->instance->trial_history[n] == 0.0)
        n++;
    return n;
}

static int nstate(const mjModel *m, int instance)
{
    Coupling *c = MAX_PLUGIN_STATE ? new_coupling(data.name) : NULL;
    const int n = c ? MAX_PLUGIN_STATE - 2 * count_unused_history(c, m, instance) : MAX_PLUGIN_STATE;
    free_coupling(c);
    return n;
}

static void reset(const mjModel *m, mjtNum *state, void *coupling, int instance)
{
    (void)coupling;
    for (int i = 0; i < m->plugin_statenum[instance]; i++)
        state[i] = 0.0;
}

#if N_HISTORY
static void read_path(const Coupling *c, const mjtNum *state)
{
    AcceptedPath *path = &c->instance->state.path;
    const size_t n = N_HISTORY - c->n_unused_history;
    memcpy(path->history[0] + c->n_unused_history, state, n * sizeof *state);
    memcpy(path->history[1] + c->n_unused_history, state + n, n * sizeof *state);
    memcpy(path->variables, state + 2 * n, sizeof path->variables);
    path->has_accepted_inputs = state[2 * n + N_PATH_VARIABLES] != 0.0;
    path->end_index = 1;
}

static void write_path(const Coupling *c, mjtNum *state)
{
    const AcceptedPath *path = &c->instance->state.path;
    const size_t n = N_HISTORY - c->n_unused_history;
    memcpy(state, path->history[1u - path->end_index] + c->n_unused_history, n * sizeof *state);
    memcpy(state + n, path->history[path->end_index] + c->n_unused_history, n * sizeof *state);
    memcpy(state + 2 * n, path->variables, sizeof path->variables);
    state[2 * n + N_PATH_VARIABLES] = path->has_accepted_inputs;
}
#endif

/* Outputs at the present angles and speeds, after the path in the plugin state. If `accept`, the inputs are accepted as
 * the end of a load step. The first evaluation after a reset starts the path, as the initialization of an FMU does. An
 * evaluation with the same inputs and path as the last one is not repeated: MuJoCo asks twice, at the end of a step and
 * at the start of the next. */
static const double *evaluate(const mjModel *m, mjData *d, int instance, bool accept)
{
    Coupling *c = (Coupling *)d->plugin_data[instance];
    Instance *fmu = c->instance;
    mjtNum *state = MAX_PLUGIN_STATE ? d->plugin_state + m->plugin_stateadr[instance] : c->plugin_state;
    const size_t size = m->plugin_statenum[instance] * sizeof *state;
    double inputs[4];
    for (int i = 0; i < 2; i++) {
        inputs[2 * i] = d->qpos[m->jnt_qposadr[c->joints[i]]];
        inputs[2 * i + 1] = d->qvel[m->jnt_dofadr[c->joints[i]]];
    }
    const bool same = c->is_current && !memcmp(inputs, fmu->state.values + FIRST_INPUT, sizeof inputs) &&
                      !memcmp(c->plugin_state, state, size);
    if (same && !accept)
        return fmu->state.values + FIRST_OUTPUT;
    c->is_current = false;
    memcpy(fmu->state.values + FIRST_INPUT, inputs, sizeof inputs);
    fmu->outputs_outdated = true;
#if N_HISTORY
    read_path(c, state);
    accept |= !fmu->state.path.has_accepted_inputs;
#endif
    if ((accept ? instance_accept_inputs(fmu) : instance_evaluate(fmu, ERROR)) != OK)
        mju_error("%s: %s", fmu->name, c->error_message);
#if N_HISTORY
    if (accept)
        write_path(c, state);
#endif
    memmove(c->plugin_state, state, size);
    c->is_current = true;
    return fmu->state.values + FIRST_OUTPUT;
}

/* Callbacks of MuJoCo */

static int nsensordata(const mjModel *m, int instance, int sensor)
{
    (void)m, (void)instance, (void)sensor;
    return N_OUTPUTS;
}

static void compute(const mjModel *m, mjData *d, int instance, int capability)
{
    const double *outputs = evaluate(m, d, instance, false);
    const Coupling *c = (const Coupling *)d->plugin_data[instance];
    if (capability == mjPLUGIN_PASSIVE)
        for (int i = 0; i < 2; i++)
            d->qfrc_passive[m->jnt_dofadr[c->joints[i]]] += outputs[i];
    for (int i = 0; i < m->nsensor; i++)
        if (m->sensor_type[i] == mjSENS_PLUGIN && m->sensor_plugin[i] == instance)
            memcpy(d->sensordata + m->sensor_adr[i], outputs, N_OUTPUTS * sizeof *outputs);
}

static void advance(const mjModel *m, mjData *d, int instance)
{
    if (N_HISTORY)
        evaluate(m, d, instance, true);
}

/* Runs when the library is loaded. */
__attribute__((constructor)) static void register_plugin(void)
{
    static char name[sizeof "jointfmu." + sizeof data.name];
    static const char *attributes[2 + N_PARAMETERS] = {"phi1", "phi2"};
    for (uint32_t i = 0; i < N_PARAMETERS; i++)
        attributes[2 + i] = variables[FIRST_PARAMETER + i].name;
    snprintf(name, sizeof name, "jointfmu.%s", data.name);
    mjpPlugin plugin;
    mjp_defaultPlugin(&plugin);
    plugin.name = name;
    plugin.nattribute = sizeof attributes / sizeof *attributes;
    plugin.attributes = attributes;
    plugin.capabilityflags = mjPLUGIN_PASSIVE | mjPLUGIN_SENSOR;
    plugin.needstage = mjSTAGE_POS; /* speeds are known too: at mjSTAGE_VEL MuJoCo computes those of all subtrees */
    plugin.nstate = nstate;
    plugin.nsensordata = nsensordata;
    plugin.init = init;
    plugin.destroy = destroy;
    plugin.reset = reset;
    plugin.compute = compute;
    plugin.advance = advance;
    mjp_registerPlugin(&plugin);
}
