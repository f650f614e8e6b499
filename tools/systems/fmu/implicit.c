/* Steps of co-simulation of a system of bodies: collocation at the begin, the middle and the end of a step (Lobatto
 * IIIA of order 4: Hairer and Wanner, Solving Ordinary Differential Equations II, IV.5), which is symmetric and
 * A-stable. Newton's method takes the exact tangents of the joints. Each step is made whole and in two halves; their
 * difference decides its size, so that every communication step is right. What the joints remember goes on from half
 * step to half step. */
#include <math.h>
#include <string.h>

#include "elementary.h"
#include "instance.h"
#include "system.h"

#define TOLERANCE 1e-5 /* of the speeds in a step, of the largest in it; a host may state less, down to: */
#define LEAST_TOLERANCE 1e-10
#define CONVERGED 1e-2 /* of the tolerance, what Newton's method may leave */
#define ROUGHLY 1.0    /* the same of a whole step, whose error is compared with 15 tolerances */
#define LEAST_SPEED 1e-6 /* of the nominal speed: what is slower counts as that */
#define LEAST_STEP 1e-9 /* of the communication step */
#define MOST_STEPS 100000 /* tried in one communication step */
#define WORTH 0.3 /* a correction that shrinks by less asks for new tangents */
#define MOST_GROWTH 4.0
#define LAST 1e-6 /* of half a step: its last part */
enum { MOST_ITERATIONS = 12, MIDDLE = 0, END = 1, X = FIRST_OUTPUT, V = X + N_BODIES, A = V + N_BODIES };

/* From accelerations at begin, middle and end of a step of size 1 to the speed, and to the place. */
static const double SPEEDS[2][3] = {{5.0 / 24.0, 1.0 / 3.0, -1.0 / 24.0}, {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}};
static const double PLACES[2][3] = {{1.0 / 16.0, 1.0 / 12.0, -1.0 / 48.0}, {1.0 / 6.0, 1.0 / 3.0, 0.0}};
static const double TIMES[2] = {0.5, 1.0};

/* A step: places, speeds and accelerations at its begin, time, size; rough: for the error alone. */
typedef struct {
    const double *from, *memory;
    double time, size;
    bool rough;
} Step;

/* Values at a stage for the present accelerations, without the outputs after them. */
static void place(Instance *m, const Step *s, size_t stage)
{
    Work *w = &m->joint->work;
    const double h = s->size, *p = PLACES[stage], *q = SPEEDS[stage], *k = w->accelerations;
    double *at = w->at[stage];
    at[0] = s->time + TIMES[stage] * h;
    for (size_t i = FIRST_INPUT; i < FIRST_OUTPUT; i++)
        at[i] = m->now.values[i] + m->now.slopes[i - FIRST_INPUT] * (at[0] - m->now.values[0]);
    for (size_t i = 0; i < N_BODIES; i++) {
        const double x = s->from[i], v = s->from[N_BODIES + i], a = s->from[2 * N_BODIES + i];
        at[X + i] = x + h * (TIMES[stage] * v + h * (p[0] * a + p[1] * k[i] + p[2] * k[N_BODIES + i]));
        at[V + i] = v + h * (q[0] * a + q[1] * k[i] + q[2] * k[N_BODIES + i]);
    }
}

static bool evaluate(Instance *m, const Step *s, size_t stage, double *after)
{
    double *at = m->joint->work.at[stage];
    Work *w = &m->joint->work;
    text_clear(&w->why);
    place(m, s, stage);
    if (!joint_evaluate(m->joint, at + FIRST_INPUT, s->memory, after, at + FIRST_OUTPUT, &w->why))
        return false;
    for (size_t i = 0; i < N_BODIES; i++)
        if (!(fabs(at[A + i]) < INFINITY)) {
            text_print(&w->why, "%s is not finite", variables[A + i].name);
            return false;
        }
    return true;
}

/* Tangents of the accelerations at the end of a step, which was evaluated last. */
static void differentiate(Instance *m, const Step *s)
{
    Work *w = &m->joint->work;
    for (size_t j = 0; j < N_STATES; j++) {
        memset(w->seed, 0, sizeof w->seed);
        w->seed[N_INPUTS + j] = 1.0;
        joint_derivative(m->joint, w->at[END] + FIRST_INPUT, s->memory, NULL, w->seed, w->change);
        for (size_t i = 0; i < N_BODIES; i++)
            w->tangents[i][j] = w->change[2 * N_BODIES + i];
    }
}

/* Newton's matrix of a step of a size, with the same tangents at both stages. */
static void assemble(Work *w, double h)
{
    for (size_t stage = MIDDLE; stage <= END; stage++)
        for (size_t r = MIDDLE; r <= END; r++) {
            const double way = h * h * PLACES[stage][1 + r], speed = h * SPEEDS[stage][1 + r];
            for (size_t i = 0; i < N_BODIES; i++)
                for (size_t j = 0; j < N_BODIES; j++)
                    w->matrix[stage * N_BODIES + i][r * N_BODIES + j] =
                        (i == j && r == stage) - way * w->tangents[i][j] - speed * w->tangents[i][N_BODIES + j];
        }
}

/* L and U of the matrix in its place, rows exchanged. */
static bool factorize(Work *w)
{
    for (size_t k = 0; k < N_STATES; k++) {
        size_t best = k;
        for (size_t i = k + 1; i < N_STATES; i++)
            if (fabs(w->matrix[i][k]) > fabs(w->matrix[best][k]))
                best = i;
        w->pivot[k] = (unsigned short)best;
        for (size_t j = 0; j < N_STATES && best != k; j++) {
            const double other = w->matrix[k][j];
            w->matrix[k][j] = w->matrix[best][j];
            w->matrix[best][j] = other;
        }
        const double top = w->matrix[k][k];
        if (!(fabs(top) > 0.0 && fabs(top) < INFINITY))
            return false;
        for (size_t i = k + 1; i < N_STATES; i++) {
            const double part = w->matrix[i][k] / top;
            w->matrix[i][k] = part;
            for (size_t j = k + 1; j < N_STATES && part != 0.0; j++)
                w->matrix[i][j] -= part * w->matrix[k][j];
        }
    }
    return true;
}

/* `rest` becomes the solution. */
static void solve(Work *w)
{
    double *b = w->rest;
    for (size_t k = 0; k < N_STATES; k++) {
        const double other = b[w->pivot[k]];
        b[w->pivot[k]] = b[k];
        b[k] = other;
    }
    for (size_t i = 0; i < N_STATES; i++)
        for (size_t j = 0; j < i; j++)
            b[i] -= w->matrix[i][j] * b[j];
    for (size_t i = N_STATES; i-- > 0;) {
        for (size_t j = i + 1; j < N_STATES; j++)
            b[i] -= w->matrix[i][j] * b[j];
        b[i] /= w->matrix[i][i];
    }
}

/* First guess of the accelerations: those of the parabola through begin, middle and end of a step, at its parts
 * `middle` and `end`. */
static void guess(Work *w, const double *begin, const double *known, double middle, double end)
{
    const double at[2] = {middle, end};
    for (size_t stage = MIDDLE; stage <= END; stage++)
        for (size_t i = 0; i < N_BODIES; i++) {
            const double c = at[stage], a = begin[2 * N_BODIES + i];
            const double last = known[N_BODIES + i] - a, first = 4.0 * (known[i] - a) - last;
            w->accelerations[stage * N_BODIES + i] = a + c * (first + c * (last - first));
        }
}

/* One step by Newton's method from a first guess: places, speeds and accelerations at its end, and what is remembered
 * there; of a rough one places and speeds. Tangents of another step serve as long as the corrections shrink. false: it
 * does not converge, or the joints refuse the way. */
static bool step(Instance *m, const Step *s, double *to, double *after)
{
    Work *w = &m->joint->work;
    const double precision = w->tolerance * (s->rough ? ROUGHLY : CONVERGED);
    double *k = w->accelerations, last = INFINITY;
    bool factorized = false;
    for (int n = 0; n < MOST_ITERATIONS; n++) {
        for (size_t stage = MIDDLE; stage <= END; stage++) {
            if (!evaluate(m, s, stage, after))
                return false;
            for (size_t i = 0; i < N_BODIES; i++)
                w->rest[stage * N_BODIES + i] = w->at[stage][A + i] - k[stage * N_BODIES + i];
        }
        if (!w->tangents_known) {
            differentiate(m, s);
            w->tangents_known = true;
            factorized = false;
        }
        if (!factorized) {
            assemble(w, s->size);
            if (!factorize(w))
                return false;
            factorized = true;
        }
        solve(w);
        double size = 0.0;
        for (size_t i = 0; i < N_STATES; i++) {
            const double own = s->size * fabs(w->rest[i]) / w->scale[i % N_BODIES];
            k[i] += w->rest[i];
            w->worst = own > size ? i : w->worst;
            size = fmax(size, own);
        }
        if (n > 0)
            w->shrinks = size / last;
        if (size * fmin(w->shrinks, 1.0) <= precision) {
            if (s->rough)
                place(m, s, END);
            else if (!evaluate(m, s, END, after))
                return false;
            memcpy(to, w->at[END] + X, (N_STATES + N_BODIES) * sizeof *to);
            return true;
        }
        w->tangents_known = n == 0 || w->shrinks < WORTH;
        last = size;
    }
    return false;
}

/* Difference of two ends over what is allowed; the error of the second, of order 4, is a fifteenth of it. */
static double error_of(const Work *w, const double *whole, const double *halves)
{
    double most = 0.0;
    for (size_t i = 0; i < N_BODIES; i++) {
        const double speed = fabs(whole[N_BODIES + i] - halves[N_BODIES + i]);
        const double way = sqrt(fabs(w->tangents[i][i])) * fabs(whole[i] - halves[i]);
        most = fmax(most, (speed + way) / w->scale[i]);
    }
    return most / (15.0 * w->tolerance);
}

/* Size of a step up to the next corner of a load. */
static double until_event(Instance *m, double time, double size)
{
#if N_EVENTS
    double *times = m->joint->work.times;
    joint_events(m->joint, times);
    for (size_t i = 0; i < N_EVENTS; i++)
        if (times[i] > time + 1e-9 * size && times[i] < time + size)
            size = times[i] - time;
#else
    (void)m, (void)time;
#endif
    return size;
}

static Status refuse(const Instance *m, double time, double size)
{
    const Work *w = &m->joint->work;
    Text text;
    text_clear(&text);
    if (w->why.length)
        text_add(&text, w->why.line);
    else
        text_print(&text, "Newton's method still changes %s by %.3g", variables[A + w->worst % N_BODIES].name,
                   w->rest[w->worst]);
    return instance_refuse(m, "the step",
                           "the motion cannot be followed at %.10g s with steps of %.3g s: %s; expected inputs and "
                           "parameters with which a motion is possible",
                           time, size, text.line);
}

/* What is remembered just before the end of a way: a motion that has turned on it goes on from there in its own
 * direction, of which the stiffness at the end is. */
static void approach(Instance *m, const double *end, const double *memory, double size, double *after)
{
    Work *w = &m->joint->work;
    double *at = w->at[END];
    memcpy(at + X, end, N_STATES * sizeof *at);
    for (size_t i = 0; i < N_BODIES; i++)
        at[X + i] -= LAST * size * at[V + i];
    if (!joint_evaluate(m->joint, at + FIRST_INPUT, memory, after, at + FIRST_OUTPUT, &w->why))
        memcpy(after, memory, sizeof w->memory[0]);
}

Status instance_advance(Instance *m, double size)
{
    Work *w = &m->joint->work;
    State *now = &m->now;
    double *from = w->states[0], *whole = w->states[1], *half = w->states[2], *halves = w->states[3];
    double *memory = w->memory[0], *between = w->memory[1], *after = w->memory[2], *aside = w->memory[3];
    w->tolerance = now->tolerance > 0.0 ? fmax(fmin(now->tolerance, TOLERANCE), LEAST_TOLERANCE) : TOLERANCE;
    w->tangents_known = false; /* nothing is kept from step to step, so that a restored state goes on alike */
    w->shrinks = 1.0;
    double done = 0.0, last_half = 0.0, next = now->last_size > 0.0 ? now->last_size : size;
    memcpy(from, now->values + X, (N_STATES + N_BODIES) * sizeof *from);
    memcpy(memory, now->path.memory[now->path.last], sizeof w->memory[0]);
    memcpy(between, memory, sizeof w->memory[0]);
    for (int tried = 0; size - done > 1e-12 * size; tried++) {
        const double time = now->values[0] + done;
        const bool last = next >= (1.0 - 1e-6) * (size - done);
        double h = until_event(m, time, last ? size - done : fmin(next, 0.5 * (size - done)));
        const bool cut = last || h < next;
        if (tried == MOST_STEPS) {
            text_clear(&w->why);
            text_print(&w->why, "more than %g of them are needed", (double)MOST_STEPS);
            return refuse(m, time, h);
        }
        for (size_t i = 0; i < N_BODIES; i++) {
            const double least = LEAST_SPEED * nominals[N_BODIES + i];
            w->scale[i] = fmax(least, fmax(fabs(from[N_BODIES + i]), h * fabs(from[2 * N_BODIES + i])));
        }
        const Step one = {from, memory, time, h, true};
        const Step first = {from, memory, time, 0.5 * h, false};
        const Step second = {half, after, time + 0.5 * h, 0.5 * h, false};
        for (size_t i = 0; i < N_STATES; i++)
            w->accelerations[i] = from[2 * N_BODIES + i % N_BODIES];
        bool ok = step(m, &one, whole, aside);
        if (ok) {
            memcpy(w->known, w->accelerations, sizeof w->known);
            guess(w, from, w->known, 0.25, 0.5);
            ok = step(m, &first, half, after);
        }
        if (ok) {
            guess(w, from, w->known, 0.75, 1.0);
            ok = step(m, &second, halves, aside);
        }
        w->tangents_known &= ok;
        const double error = ok ? error_of(w, whole, halves) : INFINITY;
        const double factor = !ok ? 0.25 : error > 1e-4 ? 0.9 * same_pow(error, -0.2) : MOST_GROWTH;
        if (error > 1.0 && (h > LEAST_STEP * size || !ok)) {
            if (!(h > LEAST_STEP * size))
                return refuse(m, time, h);
            next = h * fmin(fmax(factor, 0.1), 0.8);
            continue;
        }
        done += h;
        last_half = 0.5 * h;
        memcpy(from, halves, sizeof w->states[0]);
        memcpy(between, after, sizeof w->memory[0]); /* the way to the end is that of the second half */
        memcpy(memory, aside, sizeof w->memory[0]);
        const double grown = h * fmin(fmax(factor, 0.2), MOST_GROWTH);
        next = cut ? fmax(next, grown) : grown;
    }
    memcpy(now->values + X, from, N_STATES * sizeof *from);
    approach(m, from, between, last_half, now->path.memory[now->path.last]);
    now->path.accepted = 0;
    now->last_size = next;
    return OK;
}
