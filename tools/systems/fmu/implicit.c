/* Implicit steps of a system of bodies: collocation at start, middle and end of a step (Lobatto IIIA of order 4: Hairer
 * and Wanner, Solving Ordinary Differential Equations II, IV.5), symmetric and A-stable. Newton's method uses the exact
 * tangents of the joints. Every step consists of two half steps. The same accelerations, integrated by the formula of
 * one whole step, give other speeds and positions; the difference estimates the error, which controls the step size.
 * The history variables of the joints advance with the half steps. */
#include <math.h>
#include <string.h>

#include "elementary.h"
#include "instance.h"
#include "system.h"

/* DEFAULT_TOLERANCE (model.h): of the speeds of a step, relative to `speed_scale`; a host may set a smaller one, down to
 * MIN_TOLERANCE. */
#define MIN_TOLERANCE 1e-10
#define NEWTON_TOLERANCE_RATIO 1e-2    /* residual correction of Newton's method over the tolerance */
#define HISTORY_TOLERANCE_RATIO 10.0   /* position of the history at the end of a half step, over the tolerance */
#define MIN_SPEED_RATIO 1e-6           /* smallest `speed_scale` over the nominal speed */
#define MIN_STEP_RATIO 1e-9            /* smallest step over the communication step */
#define MAX_STEPS 100000               /* attempts in one communication step */
#define TANGENT_REUSE_RATIO 0.3        /* largest ratio of successive corrections with which tangents are reused */
#define MAX_STEP_GROWTH 4.0            /* largest ratio of successive step sizes */
#define BACKWARD_STEP_RATIO 1e-6       /* see `set_end_history`: part of the last half step */
enum { MAX_ITERATIONS = 12, MIDDLE = 0, END = 1, RE = 0, IM = 1, X = FIRST_OUTPUT, V = X + N_BODIES, A = V + N_BODIES };

/* Weights of the accelerations at start, middle and end of a step of size 1, in the speeds and in the positions at
 * middle and end. */
static const double SPEED_WEIGHTS[2][3] = {{5.0 / 24.0, 1.0 / 3.0, -1.0 / 24.0}, {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}};
static const double POSITION_WEIGHTS[2][3] = {{1.0 / 16.0, 1.0 / 12.0, -1.0 / 48.0}, {1.0 / 6.0, 1.0 / 3.0, 0.0}};
static const double STAGE_TIMES[2] = {0.5, 1.0};

/* Eigenvalue of the speed weights of middle and end, and its square, which is that of the position weights; real and
 * imaginary part. The other eigenvalue is the conjugate one. */
#define SQRT_3 1.7320508075688772
static const double EIGENVALUE[2] = {0.25, 0.25 / SQRT_3}, SQUARED_EIGENVALUE[2] = {1.0 / 24.0, 0.125 / SQRT_3};

/* Half step to compute: positions, speeds and accelerations at its start, history and time there, size; accelerations
 * (at middle, then at end) that are corrected from a first guess. */
typedef struct {
    const double *start, *history;
    double time, size, *accelerations;
} TrialStep;

/* Set time, inputs, positions and speeds at a stage from the present accelerations. */
static void set_stage_values(Instance *m, const TrialStep *s, size_t stage)
{
    StepWork *w = &m->joint->work;
    const double h = s->size, *p = POSITION_WEIGHTS[stage], *q = SPEED_WEIGHTS[stage], *k = s->accelerations;
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

/* Evaluate the motion at a stage. false: refused, or an acceleration is not finite. */
static bool evaluate_stage(Instance *m, const TrialStep *s, size_t stage, double *history_end)
{
    double *values = m->joint->work.stage_values[stage];
    StepWork *w = &m->joint->work;
    text_clear(&w->refusal);
    set_stage_values(m, s, stage);
    if (!joint_evaluate(m->joint, values + FIRST_INPUT, s->history, history_end, N_MOTION_OUTPUTS,
                        values + FIRST_OUTPUT, &w->refusal))
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
        joint_derivative(m->joint, w->stage_values[END] + FIRST_INPUT, s->history, NULL, w->seed, N_MOTION_OUTPUTS,
                         w->sensitivity);
        for (size_t i = 0; i < N_BODIES; i++)
            w->acceleration_tangents[j][i] = w->sensitivity[2 * N_BODIES + i];
        if (j < N_BODIES)
            w->frequency[j] = sqrt(fabs(w->acceleration_tangents[j][j]));
    }
}

/* Matrix of Newton's method for a step of size h, with the same tangents at both stages. The eigenvectors of the
 * weights decouple the stages, so it is complex and has one row for each body; columns are stored one after another. */
static void assemble(StepWork *w, double h)
{
    for (size_t part = RE; part <= IM; part++) {
        const double position_weight = h * h * SQUARED_EIGENVALUE[part], speed_weight = h * EIGENVALUE[part];
        for (size_t j = 0; j < N_BODIES; j++) {
            for (size_t i = 0; i < N_BODIES; i++)
                w->matrix[part][j][i] = -position_weight * w->acceleration_tangents[j][i] -
                                        speed_weight * w->acceleration_tangents[N_BODIES + j][i];
            w->matrix[part][j][j] += part == RE;
        }
    }
}

/* Subtract from column b the multiple of column a by element k of b, in the rows from `first` up to `end`. */
static inline void eliminate(const double *restrict a_re, const double *restrict a_im, double *restrict b_re,
                             double *restrict b_im, size_t k, size_t first, size_t end)
{
    const double re = b_re[k], im = b_im[k];
    for (size_t i = first; i < end; i++) {
        b_re[i] -= a_re[i] * re - a_im[i] * im;
        b_im[i] -= a_re[i] * im + a_im[i] * re;
    }
}

static inline void swap(double *x, size_t i, size_t k)
{
    const double other = x[i];
    x[i] = x[k];
    x[k] = other;
}

static inline void multiply(double *re, double *im, double factor_re, double factor_im)
{
    const double product = *re * factor_re - *im * factor_im;
    *im = *re * factor_im + *im * factor_re;
    *re = product;
}

/* LU decomposition of the matrix in place, with partial pivoting; the diagonal of U is inverted. */
static bool factorize(StepWork *w)
{
    double(*re)[N_BODIES] = w->matrix[RE], (*im)[N_BODIES] = w->matrix[IM];
    for (size_t k = 0; k < N_BODIES; k++) {
        size_t best = k;
        for (size_t i = k + 1; i < N_BODIES; i++)
            if (fabs(re[k][i]) + fabs(im[k][i]) > fabs(re[k][best]) + fabs(im[k][best]))
                best = i;
        w->pivot[k] = (unsigned short)best;
        for (size_t j = 0; j < N_BODIES && best != k; j++) {
            swap(re[j], best, k);
            swap(im[j], best, k);
        }
        const double square = re[k][k] * re[k][k] + im[k][k] * im[k][k];
        if (!(square > 0.0 && square < INFINITY))
            return false;
        re[k][k] /= square;
        im[k][k] /= -square;
        for (size_t i = k + 1; i < N_BODIES; i++)
            multiply(&re[k][i], &im[k][i], re[k][k], im[k][k]);
        for (size_t j = k + 1; j < N_BODIES; j++)
            eliminate(re[k], im[k], re[j], im[j], k, k + 1, N_BODIES);
    }
    return true;
}

/* Solve the linear system: `residual` has the right sides at middle and end, and then the corrections there. */
static void solve(StepWork *w)
{
    double *middle = w->residual, *end = w->residual + N_BODIES, re[N_BODIES], im[N_BODIES];
    for (size_t i = 0; i < N_BODIES; i++) {
        re[i] = middle[i] - 0.125 * end[i];
        im[i] = 0.125 * SQRT_3 * end[i];
    }
    for (size_t k = 0; k < N_BODIES; k++) {
        swap(re, w->pivot[k], k);
        swap(im, w->pivot[k], k);
    }
    for (size_t k = 0; k < N_BODIES; k++)
        eliminate(w->matrix[RE][k], w->matrix[IM][k], re, im, k, k + 1, N_BODIES);
    for (size_t k = N_BODIES; k-- > 0;) {
        multiply(&re[k], &im[k], w->matrix[RE][k][k], w->matrix[IM][k][k]);
        eliminate(w->matrix[RE][k], w->matrix[IM][k], re, im, k, 0, k);
    }
    for (size_t i = 0; i < N_BODIES; i++) {
        middle[i] = re[i] + im[i] / SQRT_3;
        end[i] = 8.0 / SQRT_3 * im[i];
    }
}

/* First guess of the accelerations at middle and end of a half step, by the parabola through those at start, middle and
 * end of another half step (`known`); `middle` and `end` are times since its start over its size. */
static void predict_accelerations(double known[3][N_BODIES], double middle, double end, double *guess)
{
    for (size_t i = 0; i < N_BODIES; i++) {
        const double a = known[0][i], last = known[2][i] - a, first = 4.0 * (known[1][i] - a) - last;
        guess[i] = a + middle * (first + middle * (last - first));
        guess[N_BODIES + i] = a + end * (first + end * (last - first));
    }
}

/* Last correction of an acceleration, as a change of the speed over its scale. */
static double correction_size(const StepWork *w, double h, size_t i)
{
    return h * fabs(w->residual[i]) / w->speed_scale[i % N_BODIES];
}

/* Size of a change of the positions in the norm of the tolerance: as a speed of the free vibration over its scale. */
static double position_size(const StepWork *w, size_t body, double change)
{
    return w->frequency[body] * fabs(change) / w->speed_scale[body];
}

/* Largest change of a position at the end of a half step of size h by the last correction. */
static double end_correction_size(const StepWork *w, double h)
{
    const double *p = POSITION_WEIGHTS[END];
    double largest = 0.0;
    for (size_t i = 0; i < N_BODIES; i++)
        largest = fmax(largest,
                       position_size(w, i, h * h * (p[1] * w->residual[i] + p[2] * w->residual[N_BODIES + i])));
    return largest;
}

/* Compute a half step by Newton's method: positions, speeds and accelerations `to` at its end, and the history there.
 * Tangents of another step are reused while the corrections decrease fast enough. The history is that of the last
 * evaluated positions, see HISTORY_TOLERANCE_RATIO; the differences to the result do not add up over the steps, because
 * the history has the positions themselves. false: no convergence, or a joint refuses. */
static bool solve_step(Instance *m, const TrialStep *s, double *to, double *history_end)
{
    StepWork *w = &m->joint->work;
    double *k = s->accelerations, previous = INFINITY;
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
            k[i] += w->residual[i];
            const double relative = correction_size(w, s->size, i);
            size = relative <= size ? size : relative; /* also if it is not a number */
        }
        if (!(size < INFINITY))
            return false;
        if (n > 0)
            w->correction_ratio = size / previous;
        if (size * fmin(w->correction_ratio, 1.0) <= NEWTON_TOLERANCE_RATIO * w->tolerance) {
            if (end_correction_size(w, s->size) > HISTORY_TOLERANCE_RATIO * w->tolerance && !evaluate_stage(m, s, END, history_end))
                return false;
            set_stage_values(m, s, END);
            memcpy(to, w->stage_values[END] + X, N_STATES * sizeof *to);
            memcpy(to + N_STATES, k + N_BODIES, N_BODIES * sizeof *to);
            return true;
        }
        w->tangents_are_current = n == 0 || w->correction_ratio < TANGENT_REUSE_RATIO;
        previous = size;
    }
    return false;
}

/* Error of two half steps over the tolerance: by Richardson's rule for order 4, 1/15 of the difference from the whole
 * step of size h, whose formula uses the accelerations at start, middle and end. */
static double estimate_error(const StepWork *w, double h)
{
    double largest = 0.0;
    for (size_t i = 0; i < N_BODIES; i++) {
        const double a0 = w->nodes[0][i], a1 = w->nodes[1][i], a2 = w->nodes[2][i], a3 = w->nodes[3][i],
                     a4 = w->nodes[4][i];
        const double speed = h / 12.0 * fabs(a0 - 4.0 * a1 + 6.0 * a2 - 4.0 * a3 + a4);
        const double position = h * h / 12.0 * (a0 - 3.0 * a1 + 3.0 * a2 - a3);
        largest = fmax(largest, speed / w->speed_scale[i] + position_size(w, i, position));
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
    if (w->refusal.length) {
        text_append(&text, w->refusal.line);
    } else {
        size_t largest = 0;
        for (size_t i = 1; i < N_STATES; i++)
            if (correction_size(w, size, i) > correction_size(w, size, largest))
                largest = i;
        text_append_format(&text, "Newton's method still changes %s by %.3g", variables[A + largest % N_BODIES].name,
                           w->residual[largest]);
    }
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
    if (!joint_evaluate(m->joint, values + FIRST_INPUT, history, history_end, N_MOTION_OUTPUTS, values + FIRST_OUTPUT,
                        &w->refusal))
        memcpy(history_end, history, sizeof w->history[0]);
}

static inline void swap_rows(double **a, double **b)
{
    double *const other = *a;
    *a = *b;
    *b = other;
}

Status instance_integrate(Instance *m, double size)
{
    StepWork *w = &m->joint->work;
    InstanceState *state = &m->state;
    double *from = w->states[0], *middle = w->states[1], *end = w->states[2];
    double *history = w->history[0], *middle_history = w->history[1], *end_history = w->history[2];
    w->tolerance =
        state->tolerance > 0.0 ? fmax(fmin(state->tolerance, DEFAULT_TOLERANCE), MIN_TOLERANCE) : DEFAULT_TOLERANCE;
    w->tangents_are_current =
        false; /* no reuse from the step before: a restored FMU state continues with the same bits */
    w->factorized_size = 0.0;
    w->correction_ratio = 1.0;
    double elapsed = 0.0, next = state->previous_step_size > 0.0 ? state->previous_step_size : size;
    double known_start = 0.0, known_size = 0.0; /* of the half step from which the next accelerations are predicted */
    memcpy(from, state->values + X, (N_STATES + N_BODIES) * sizeof *from);
    memcpy(history, state->path.history[state->path.end_index], sizeof w->history[0]);
    memcpy(middle_history, history, sizeof w->history[0]);
    for (int attempts = 0; size - elapsed > 1e-12 * size; attempts++) {
        const double time = state->values[0] + elapsed;
        const double remaining = size - elapsed, step_count = ceil((1.0 - 1e-6) * remaining / next);
        const double h = limit_to_event(m, time, remaining / step_count);
        if (attempts == MAX_STEPS) {
            text_clear(&w->refusal);
            text_append_format(&w->refusal, "more than %g of them are needed", (double)MAX_STEPS);
            return log_step_error(m, time, h);
        }
        for (size_t i = 0; i < N_BODIES; i++) {
            const double min_speed = MIN_SPEED_RATIO * state_nominals[N_BODIES + i];
            w->speed_scale[i] = fmax(min_speed, fmax(fabs(from[N_BODIES + i]), h * fabs(from[N_STATES + i])));
        }
        if (known_size > 0.0)
            predict_accelerations(w->nodes, (elapsed + 0.25 * h - known_start) / known_size,
                                  (elapsed + 0.5 * h - known_start) / known_size, w->nodes[1]);
        else
            for (size_t n = 1; n <= 2; n++)
                memcpy(w->nodes[n], from + N_STATES, sizeof w->nodes[n]);
        memcpy(w->nodes[0], from + N_STATES, sizeof w->nodes[0]);
        const TrialStep first = {from, history, time, 0.5 * h, w->nodes[1]};
        const TrialStep second = {middle, middle_history, time + 0.5 * h, 0.5 * h, w->nodes[3]};
        bool ok = solve_step(m, &first, middle, middle_history);
        if (ok) {
            predict_accelerations(w->nodes, 1.5, 2.0, w->nodes[3]);
            ok = solve_step(m, &second, end, end_history);
        }
        w->tangents_are_current &= ok;
        known_size = ok ? 0.5 * h : 0.0;
        known_start = elapsed;
        const double error = ok ? estimate_error(w, h) : INFINITY;
        const double factor = !ok ? 0.25 : error > 1e-4 ? 0.9 * portable_pow(error, -0.2) : MAX_STEP_GROWTH;
        if (error > 1.0 && (h > MIN_STEP_RATIO * size || !ok)) {
            if (!(h > MIN_STEP_RATIO * size))
                return log_step_error(m, time, h);
            next = h * fmin(fmax(factor, 0.1), 0.8);
            continue;
        }
        elapsed += h;
        known_start += 0.5 * h;
        memmove(w->nodes[0], w->nodes[2], 3 * sizeof w->nodes[0]);
        swap_rows(&from, &end);
        swap_rows(&history, &end_history);
        next = factor < MAX_STEP_GROWTH ? h * fmax(factor, 0.2) : fmax(next, h * MAX_STEP_GROWTH);
    }
    memcpy(state->values + X, from, N_STATES * sizeof *from);
    set_end_history(m, from, middle_history, known_size, state->path.history[state->path.end_index]);
    state->path.has_accepted_inputs = 0;
    state->previous_step_size = next;
    return OK;
}
