/* A joint between two flanges (phi1 w1 phi2 w2 in, tau1 tau2 out first) as MuJoCo's passive force and sensor;
 * further inputs stay at their start.
 *
 * Compiled with the C sources of an FMU. Each plugin instance has an instance of the FMU; its path lies in
 * MuJoCo's plugin state (before, after, inputs, accepted), so that mjData can be copied, saved and set. Memory
 * that the parameters leave unused, as that of a hysteresis that is off, has no place there. */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

enum { PHI1, W1, PHI2, W2 };
enum { PATH = N_MEMORY ? 2 * N_MEMORY + N_PATH + 1 : 0 }; /* at most */
_Static_assert(N_INPUTS > W2 && N_OUTPUTS >= 2 && !MOVES, "a joint between two flanges");

typedef struct {
    Instance *instance;
    int joints[2];
    int unused; /* of the memory, its first numbers */
    bool known;              /* the instance stands where it was evaluated last, with this path before it: */
    mjtNum state[PATH + 1];  /* one more, for C */
    char why[sizeof((Text *)0)->line]; /* of the last refusal */
} Coupling;

/* Messages: MuJoCo's warnings, and one line for the error that follows */

static void deliver(const Reporter *to, const char *name, Status status, const char *category, const char *line)
{
    (void)category;
    Coupling *c = to->environment;
    if (status == ERROR)
        snprintf(c->why, sizeof c->why, "%s", line);
    else
        mju_warning("%s: %s", name, line);
}

/* Configuration: joints for phi1 and phi2, and parameters by name */

static bool find_joint(Coupling *c, const mjModel *m, int instance, const char *key, bool slides, int *joint)
{
    const char *name = mj_getPluginConfig(m, instance, key);
    *joint = name && *name ? mj_name2id(m, mjOBJ_JOINT, name) : -1;
    if (*joint >= 0 && (m->jnt_type[*joint] == mjJNT_HINGE || (slides && m->jnt_type[*joint] == mjJNT_SLIDE)))
        return true;
    snprintf(c->why, sizeof c->why, "%s = '%.80s' is not a hinge joint; expected the name of one", key,
             name ? name : "");
    return false;
}

static bool set_parameter(Coupling *c, const char *text, uint32_t ref)
{
    const Variable *v = &variables[ref];
    char *end;
    double value = strtod(text, &end);
    bool right = *end == '\0' && end != text;
    if (v->boolean) {
        value = strcmp(text, "true") == 0;
        right = value || strcmp(text, "false") == 0;
    }
    if (right)
        instance_put(c->instance, ref, value);
    else
        snprintf(c->why, sizeof c->why, "%s = '%.80s' is not a %s", v->name, text,
                 v->boolean ? "Boolean; expected true or false" : "number; expected one");
    return right;
}

static bool set_parameters(Coupling *c, const mjModel *m, int instance)
{
    for (uint32_t ref = FIRST_PARAMETER; ref < N_VALUES; ref++) {
        const char *text = mj_getPluginConfig(m, instance, variables[ref].name);
        if (text && *text && !set_parameter(c, text, ref))
            return false;
    }
    c->instance->dirty = c->instance->parameters_changed = true;
    return instance_set_experiment(c->instance, "init", 0.0, 0.0, false, 0.0) == OK &&
           instance_change(c->instance, "init", BOTH | INSTANTIATED, INITIALIZATION) == OK &&
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
    const Reporter reporter = {deliver, NULL, c};
    c->instance = instance_new("init", 3, MODEL_EXCHANGE, name, data.token, false, reporter);
    return c;
}

static int init(const mjModel *m, mjData *d, int instance)
{
    const char *given = mj_id2name(m, mjOBJ_PLUGIN, instance), *name = given && *given ? given : data.name;
    Coupling *c = new_coupling(name);
    if (!c)
        return -1;
    if (!c->instance || !find_joint(c, m, instance, "phi1", true, &c->joints[0]) ||
        !find_joint(c, m, instance, "phi2", false, &c->joints[1]) || !set_parameters(c, m, instance)) {
        char why[sizeof c->why];
        memcpy(why, c->why, sizeof why);
        free_coupling(c);
        mju_error("%s: %s", name, why);
        return -1;
    }
    c->unused = (PATH - m->plugin_statenum[instance]) / 2;
    d->plugin_data[instance] = (uintptr_t)c;
    return 0;
}

static void destroy(mjData *d, int instance)
{
    free_coupling((Coupling *)d->plugin_data[instance]);
    d->plugin_data[instance] = 0;
}

/* The path of the inputs */

/* How many numbers at the begin of the memory a first small motion leaves zero: what acts moves from there on. A
 * parameter that is refused is so again where the data are made. */
static int unused(Coupling *c, const mjModel *m, int instance)
{
    int n = 0;
    if (!c->instance || !set_parameters(c, m, instance))
        return 0;
    c->instance->now.values[FIRST_INPUT + PHI1] = 1e-6;
    c->instance->dirty = true;
    if (instance_evaluate(c->instance) != OK)
        return 0;
    while (n < N_MEMORY && c->instance->tried[n] == 0.0)
        n++;
    return n;
}

static int nstate(const mjModel *m, int instance)
{
    Coupling *c = PATH ? new_coupling(data.name) : NULL;
    const int n = c ? PATH - 2 * unused(c, m, instance) : PATH;
    free_coupling(c);
    return n;
}

static void reset(const mjModel *m, mjtNum *state, void *coupling, int instance)
{
    (void)coupling;
    for (int i = 0; i < m->plugin_statenum[instance]; i++)
        state[i] = 0.0;
}

#if N_MEMORY
static void read_path(const Coupling *c, const mjtNum *state)
{
    Path *path = &c->instance->now.path;
    const size_t n = N_MEMORY - c->unused;
    memcpy(path->memory[0] + c->unused, state, n * sizeof *state);
    memcpy(path->memory[1] + c->unused, state + n, n * sizeof *state);
    memcpy(path->knowns, state + 2 * n, sizeof path->knowns);
    path->accepted = state[2 * n + N_PATH] != 0.0;
    path->last = 1;
}

static void write_path(const Coupling *c, mjtNum *state)
{
    const Path *path = &c->instance->now.path;
    const size_t n = N_MEMORY - c->unused;
    memcpy(state, path->memory[1u - path->last] + c->unused, n * sizeof *state);
    memcpy(state + n, path->memory[path->last] + c->unused, n * sizeof *state);
    memcpy(state + 2 * n, path->knowns, sizeof path->knowns);
    state[2 * n + N_PATH] = path->accepted;
}
#endif

/* Evaluate at the present angles and speeds, on the path of the state; if `accept`, the path goes on from them.
 * The first evaluation after a reset begins the path, as an FMU's initialization does. What was evaluated last, at
 * the end of a step and at the begin of the next one, is not evaluated again. */
static const double *evaluate(const mjModel *m, mjData *d, int instance, bool accept)
{
    Coupling *c = (Coupling *)d->plugin_data[instance];
    Instance *fmu = c->instance;
    mjtNum *state = PATH ? d->plugin_state + m->plugin_stateadr[instance] : c->state;
    const size_t size = m->plugin_statenum[instance] * sizeof *state;
    double inputs[4];
    for (int i = 0; i < 2; i++) {
        inputs[2 * i] = d->qpos[m->jnt_qposadr[c->joints[i]]];
        inputs[2 * i + 1] = d->qvel[m->jnt_dofadr[c->joints[i]]];
    }
    const bool same = c->known && !memcmp(inputs, fmu->now.values + FIRST_INPUT, sizeof inputs) &&
                      !memcmp(c->state, state, size);
    if (same && !accept)
        return fmu->now.values + FIRST_OUTPUT;
    c->known = false;
    memcpy(fmu->now.values + FIRST_INPUT, inputs, sizeof inputs);
    fmu->dirty = true;
#if N_MEMORY
    read_path(c, state);
    accept |= !fmu->now.path.accepted;
#endif
    if ((accept ? instance_accept(fmu) : instance_evaluate(fmu)) != OK)
        mju_error("%s: %s", fmu->name, c->why);
#if N_MEMORY
    if (accept)
        write_path(c, state);
#endif
    memmove(c->state, state, size);
    c->known = true;
    return fmu->now.values + FIRST_OUTPUT;
}

/* What MuJoCo calls */

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
    if (N_MEMORY)
        evaluate(m, d, instance, true);
}

/* When the library is loaded. */
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
