/* Implicit steps of a system of bodies: collocation at start, middle and end of a step (Lobatto IIIA of order 4: Hairer
 * and Wanner, Solving Ordinary Differential Equations II, IV.5), symmetric and A-stable. Newton's method uses the exact
 * tangents of the joints. Every step is computed as one step and as two half steps. Their difference estimates the
 * error, which controls the step size. The history variables of the joints advance with the half steps. */
#include <math.h>
#include <string.h>

#include "elementary.h"
#include "instance.h"
#include "system.h"

/* DEFAULT_TOLERANCE (model.h): of the speeds of a step, relative to `speed_scale`; a host may set a smaller one, down to
 * MIN_TOLERANCE. */
#define MIN_TOLERANCE 1e-10
#define NEWTON_TOLERANCE_RATIO 1e-2    /* residual correction of Newton's method over the tolerance */
#define WHOLE_STEP_TOLERANCE_RATIO 1.0 /* the same for a whole step, whose error may be 15 tolerances */
#define MIN_SPEED_RATIO 1e-6           /* smallest `speed_scale` over the nominal speed */
#define MIN_STEP_RATIO 1e-9            /* smallest step over the communication step */
#define MAX_STEPS 100000               /* attempts in one communication step */
#define TANGENT_REUSE_RATIO 0.3        /* largest ratio of successive corrections with which tangents are reused */
#define MAX_STEP_GROWTH 4.0            /* largest ratio of successive step sizes */
#define BACKWARD_STEP_RATIO 1e-6       /* see `set_end_history`: part of the last half step */
enum { MAX_ITERATIONS = 12, MIDDLE = 0, END = 1, X = FIRST_OUTPUT, V = X + N_BODIES, A = V + N_BODIES };

/* Weights of the accelerations at start, middle and end of a step of size 1, in the speeds and in the positions at
 * middle and end. */
static const double SPEED_WEIGHTS[2][3] = {{5.0 / 24.0, 1.0 / 3.0, -1.0 / 24.0}, {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}};
static const double POSITION_WEIGHTS[2][3] = {{1.0 / 16.0, 1.0 / 12.0, -1.0 / 48.0}, {1.0 / 6.0, 1.0 / 3.0, 0.0}};
static const double STAGE_TIMES[2] = {0.5, 1.0};

/* Step to compute: positions, speeds and accelerations at its start, history and time there, size. A whole step is only
 * used for the error estimate. */
typedef struct {
    const double *start, *history;
    double time, size;
    bool is_whole_step;
} TrialStep;

/* Set time, inputs, positions and speeds at a stage from the present accelerations. */
static void set_stage_values(Instance *m, const TrialStep *s, size_t stage)
{
    StepWork *w = &m->joint->work;
    const double h = s->size, *p = POSITION_WEIGHTS[stage], *q = SPEED_WEIGHTS[stage], *k = w->accelerations;
    double *values = w->stage_values[stage];
    values[0] = s->time + STAGE_TIMES[stage] * h;
    for (size_t i = FIRST_INPUT; i < FIRST_OUTPUT; i++)
        values[i] = m->state.values[i] + m->state.input_derivatives[i - FIRST_INPUT] * (values[0] - m->state.values[0]);
    for (size_t i = 0; i < N_BODIES; i++) {
        const double x = s->start[i], v = s->start[N_BODIES + i], a = s->start[2 * N_BODIES + i];
        values[X + i] = x + h * (STAGE_TIMES[stage] * v + h * (p[0] * a + p[1] * k[i] + p[2] * k[N_BODIES + i]));
        values[V + i] = v + h * (q[0] * a + q[1] * k[i] + q[2] * k[N_BODIES + i]);
    }
}

/* Evaluate the outputs at a stage. false: refused, or an acceleration is not finite. */
static bool evaluate_stage(Instance *m, const TrialStep *s, size_t stage, double *history_end)
{
    double *values = m->joint->work.stage_values[stage];
    StepWork *w = &m->joint->work;
    text_clear(&w->refusal);
    set_stage_values(m, s, stage);
    if (!joint_evaluate(m->joint, values + FIRST_INPUT, s->history, history_end, values + FIRST_OUTPUT, &w->refusal))
        return false;
    for (size_t i = 0; i < N_BODIES; i++)
        if (!(fabs(values[A + i]) < INFINITY)) {
            text_append_format(&w->refusal, "%s is not finite", variables[A + i].name);
            return false;
        }
    return true;
}

/* Derivatives of the accelerations at the end of the step, which was evaluated last. */
static void update_tangents(Instance *m, const TrialStep *s)
{
    StepWork *w = &m->joint->work;
    for (size_t j = 0; j < N_STATES; j++) {
        memset(w->seed, 0, sizeof w->seed);
        w->seed[N_INPUTS + j] = 1.0;
        joint_derivative(m->joint, w->stage_values[END] + FIRST_INPUT, s->history, NULL, w->seed, w->sensitivity);
        for (size_t i = 0; i < N_BODIES; i++)
            w->acceleration_tangents[i][j] = w->sensitivity[2 * N_BODIES + i];
    }
}

/* Matrix of Newton's method for a step of size h, with the same tangents at both stages. */
static void assemble(StepWork *w, double h)
{
    for (size_t stage = MIDDLE; stage <= END; stage++)
        for (size_t r = MIDDLE; r <= END; r++) {
            const double position_weight = h * h * POSITION_WEIGHTS[stage][1 + r],
                         speed_weight = h * SPEED_WEIGHTS[stage][1 + r];
            for (size_t i = 0; i < N_BODIES; i++)
                for (size_t j = 0; j < N_BODIES; j++)
                    w->matrix[stage * N_BODIES + i][r * N_BODIES + j] =
                        (i == j && r == stage) - position_weight * w->acceleration_tangents[i][j] -
                        speed_weight * w->acceleration_tangents[i][N_BODIES + j];
        }
}

/* LU decomposition of the matrix in place, with partial pivoting. */
static bool factorize(StepWork *w)
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
        const double pivot = w->matrix[k][k];
        if (!(fabs(pivot) > 0.0 && fabs(pivot) < INFINITY))
            return false;
        const double *restrict pivot_row = w->matrix[k];
        for (size_t i = k + 1; i < N_STATES; i++) {
            double *restrict row = w->matrix[i];
            const double factor = row[k] /= pivot;
            if (factor == 0.0)
                continue;
            for (size_t j = k + 1; j < N_STATES; j++)
                row[j] -= factor * pivot_row[j];
        }
    }
    return true;
}

/* Solve the linear system; `residual` is the right side, and then the solution. */
static void solve(StepWork *w)
{
    double *b = w->residual;
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

/* First guess of the accelerations at middle and end of a half step, by the parabola through those at start, middle and
 * end of the whole step; `middle` and `end` are their times over the size of the whole step. */
static void predict_accelerations(StepWork *w, const double *start, const double *stage_accelerations, double middle,
                                  double end)
{
    const double times[2] = {middle, end};
    for (size_t stage = MIDDLE; stage <= END; stage++)
        for (size_t i = 0; i < N_BODIES; i++) {
            const double c = times[stage], a = start[2 * N_BODIES + i];
            const double last = stage_accelerations[N_BODIES + i] - a,
                         first = 4.0 * (stage_accelerations[i] - a) - last;
            w->accelerations[stage * N_BODIES + i] = a + c * (first + c * (last - first));
        }
}

/* Compute a step by Newton's method from a first guess: positions, speeds and accelerations `to` at its end, and the
 * history there; of a whole step positions and speeds only. Tangents of another step are reused while the corrections
 * decrease fast enough. false: no convergence, or a joint refuses. */
static bool solve_step(Instance *m, const TrialStep *s, double *to, double *history_end)
{
    StepWork *w = &m->joint->work;
    const double precision = w->tolerance * (s->is_whole_step ? WHOLE_STEP_TOLERANCE_RATIO : NEWTON_TOLERANCE_RATIO);
    double *k = w->accelerations, previous = INFINITY;
    for (int n = 0; n < MAX_ITERATIONS; n++) {
        for (size_t stage = MIDDLE; stage <= END; stage++) {
            if (!evaluate_stage(m, s, stage, history_end))
                return false;
            for (size_t i = 0; i < N_BODIES; i++)
                w->residual[stage * N_BODIES + i] = w->stage_values[stage][A + i] - k[stage * N_BODIES + i];
        }
        if (!w->tangents_are_current) {
            update_tangents(m, s);
            w->tangents_are_current = true;
            w->factorized_size = 0.0;
        }
        if (w->factorized_size != s->size) { /* both half steps share the matrix */
            w->factorized_size = 0.0;
            assemble(w, s->size);
            if (!factorize(w))
                return false;
            w->factorized_size = s->size;
        }
        solve(w);
        double size = 0.0;
        for (size_t i = 0; i < N_STATES; i++) {
            const double relative = s->size * fabs(w->residual[i]) / w->speed_scale[i % N_BODIES];
            k[i] += w->residual[i];
            w->largest_correction = relative > size ? i : w->largest_correction;
            size = fmax(size, relative);
        }
        if (n > 0)
            w->correction_ratio = size / previous;
        if (size * fmin(w->correction_ratio, 1.0) <= precision) {
            if (s->is_whole_step)
                set_stage_values(m, s, END);
            else if (!evaluate_stage(m, s, END, history_end))
                return false;
            memcpy(to, w->stage_values[END] + X, (N_STATES + N_BODIES) * sizeof *to);
            return true;
        }
        w->tangents_are_current = n == 0 || w->correction_ratio < TANGENT_REUSE_RATIO;
        previous = size;
    }
    return false;
}

/* Error of the two half steps over the tolerance: by Richardson's rule for order 4, 1/15 of their difference from the
 * whole step. */
static double estimate_error(const StepWork *w, const double *whole, const double *halves)
{
    double largest = 0.0;
    for (size_t i = 0; i < N_BODIES; i++) {
        const double speed = fabs(whole[N_BODIES + i] - halves[N_BODIES + i]);
        const double position = sqrt(fabs(w->acceleration_tangents[i][i])) * fabs(whole[i] - halves[i]);
        largest = fmax(largest, (speed + position) / w->speed_scale[i]);
    }
    return largest / (15.0 * w->tolerance);
}

/* Step size, limited by the next time event. */
static double limit_to_event(Instance *m, double time, double size)
{
#if N_TIME_EVENTS
    double *times = m->joint->work.times;
    joint_event_times(m->joint, times);
    for (size_t i = 0; i < N_TIME_EVENTS; i++)
        if (times[i] > time + 1e-9 * size && times[i] < time + size)
            size = times[i] - time;
#else
    (void)m, (void)time;
#endif
    return size;
}

static Status log_step_error(const Instance *m, double time, double size)
{
    const StepWork *w = &m->joint->work;
    Text text;
    text_clear(&text);
    if (w->refusal.length)
        text_append(&text, w->refusal.line);
    else
        text_append_format(&text, "Newton's method still changes %s by %.3g",
                           variables[A + w->largest_correction % N_BODIES].name, w->residual[w->largest_correction]);
    return instance_log_error(m, "the step",
                              "the motion cannot be followed at %.10g s with steps of %.3g s: %s; expected inputs and "
                              "parameters with which a motion is possible",
                              time, size, text.line);
}

/* History just before the end of the last half step: if the motion reversed in this half step, the load step that
 * starts there continues in its final direction, and the tangents at its end are those of this direction. */
static void set_end_history(Instance *m, const double *end, const double *history, double size, double *history_end)
{
    StepWork *w = &m->joint->work;
    double *values = w->stage_values[END];
    memcpy(values + X, end, N_STATES * sizeof *values);
    for (size_t i = 0; i < N_BODIES; i++)
        values[X + i] -= BACKWARD_STEP_RATIO * size * values[V + i];
    if (!joint_evaluate(m->joint, values + FIRST_INPUT, history, history_end, values + FIRST_OUTPUT, &w->refusal))
        memcpy(history_end, history, sizeof w->history[0]);
}

Status instance_integrate(Instance *m, double size)
{
    StepWork *w = &m->joint->work;
    InstanceState *state = &m->state;
    double *from = w->states[0], *whole = w->states[1], *half = w->states[2], *halves = w->states[3];
    double *history = w->history[0], *half_history = w->history[1], *history_end = w->history[2],
           *whole_history = w->history[3];
    w->tolerance =
        state->tolerance > 0.0 ? fmax(fmin(state->tolerance, DEFAULT_TOLERANCE), MIN_TOLERANCE) : DEFAULT_TOLERANCE;
    w->tangents_are_current =
        false; /* no reuse from the step before: a restored FMU state continues with the same bits */
    w->factorized_size = 0.0;
    w->correction_ratio = 1.0;
    double elapsed = 0.0, last_half = 0.0, next = state->previous_step_size > 0.0 ? state->previous_step_size : size;
    memcpy(from, state->values + X, (N_STATES + N_BODIES) * sizeof *from);
    memcpy(history, state->path.history[state->path.end_index], sizeof w->history[0]);
    memcpy(half_history, history, sizeof w->history[0]);
    for (int attempts = 0; size - elapsed > 1e-12 * size; attempts++) {
        const double time = state->values[0] + elapsed;
        const bool is_last = next >= (1.0 - 1e-6) * (size - elapsed);
        double h = limit_to_event(m, time, is_last ? size - elapsed : fmin(next, 0.5 * (size - elapsed)));
        const bool is_shortened = is_last || h < next;
        if (attempts == MAX_STEPS) {
            text_clear(&w->refusal);
            text_append_format(&w->refusal, "more than %g of them are needed", (double)MAX_STEPS);
            return log_step_error(m, time, h);
        }
        for (size_t i = 0; i < N_BODIES; i++) {
            const double min_speed = MIN_SPEED_RATIO * state_nominals[N_BODIES + i];
            w->speed_scale[i] = fmax(min_speed, fmax(fabs(from[N_BODIES + i]), h * fabs(from[2 * N_BODIES + i])));
        }
        const TrialStep whole_step = {from, history, time, h, true};
        const TrialStep first = {from, history, time, 0.5 * h, false};
        const TrialStep second = {half, history_end, time + 0.5 * h, 0.5 * h, false};
        for (size_t i = 0; i < N_STATES; i++)
            w->accelerations[i] = from[2 * N_BODIES + i % N_BODIES];
        bool ok = solve_step(m, &whole_step, whole, whole_history);
        if (ok) {
            memcpy(w->whole_step_accelerations, w->accelerations, sizeof w->whole_step_accelerations);
            predict_accelerations(w, from, w->whole_step_accelerations, 0.25, 0.5);
            ok = solve_step(m, &first, half, history_end);
        }
        if (ok) {
            predict_accelerations(w, from, w->whole_step_accelerations, 0.75, 1.0);
            ok = solve_step(m, &second, halves, whole_history);
        }
        w->tangents_are_current &= ok;
        const double error = ok ? estimate_error(w, whole, halves) : INFINITY;
        const double factor = !ok ? 0.25 : error > 1e-4 ? 0.9 * portable_pow(error, -0.2) : MAX_STEP_GROWTH;
        if (error > 1.0 && (h > MIN_STEP_RATIO * size || !ok)) {
            if (!(h > MIN_STEP_RATIO * size))
                return log_step_error(m, time, h);
            next = h * fmin(fmax(factor, 0.1), 0.8);
            continue;
        }
        elapsed += h;
        last_half = 0.5 * h;
        memcpy(from, halves, sizeof w->states[0]);
        memcpy(half_history, history_end, sizeof w->history[0]); /* history at the start of the second half step */
        memcpy(history, whole_history, sizeof w->history[0]);
        const double grown_size = h * fmin(fmax(factor, 0.2), MAX_STEP_GROWTH);
        next = is_shortened ? fmax(next, grown_size) : grown_size;
    }
    memcpy(state->values + X, from, N_STATES * sizeof *from);
    set_end_history(m, from, half_history, last_half, state->path.history[state->path.end_index]);
    state->path.has_accepted_inputs = 0;
    state->previous_step_size = next;
    return OK;
}
