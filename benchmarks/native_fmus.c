/* native_fmus LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS REPEATS (0: the longest steps) < inputs
 *
 * Times of the calls of an FMU, as a host in C makes them. `inputs` are five sets of ROWS rows of doubles:
 * along a smooth trajectory, along one in one direction, along one on which the preload moves too, the same under
 * a moment, and at random.
 * Prints lines "NAME VALUE": seconds, and bytes of memory. */
#include "host.h"

#include <malloc.h>
#include <time.h>

enum {
    ROWS = 4093, /* a prime: no loop meets the same rows again and again */
    MOST_REPEATS = 1000,
    INSTANCES = 32
};

/* Of a loop: far above the clock's resolution, and below a time slice, so most loops run undisturbed [s]. */
static const double LONG_ENOUGH = 2e-4;
static const double STEP = 1e-3; /* [s] */

typedef struct {
    double *rows;
    size_t size, next; /* in doubles */
} Inputs;

static Library library;
static Layout v;
static double sum; /* of all that was read */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Of this thread alone, without what else the machine does; a call takes a quarter of a microsecond. */
static double spent(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Loops: `n` times the same calls; every set takes the next row of inputs. */

static inline void set_next(Fmu *fmu, Inputs *inputs)
{
    MUST(fmu_set(fmu, input_refs(&v), v.inputs, inputs->rows + inputs->next), fmu);
    inputs->next += v.inputs;
    if (inputs->next == inputs->size)
        inputs->next = 0;
}

static void set(Fmu *fmu, Inputs *inputs, long n)
{
    for (long i = 0; i < n; i++)
        set_next(fmu, inputs);
}

static void set_step(Fmu *fmu, Inputs *inputs, long n)
{
    for (long i = 0; i < n; i++) {
        set_next(fmu, inputs);
        MUST(fmu_step(fmu, STEP), fmu);
    }
}

static void set_step_get(Fmu *fmu, Inputs *inputs, long n)
{
    double outputs[MAX_VARIABLES];
    for (long i = 0; i < n; i++) {
        set_next(fmu, inputs);
        MUST(fmu_step(fmu, STEP), fmu);
        MUST(fmu_get(fmu, output_refs(&v), v.outputs, outputs), fmu);
        sum += outputs[0];
    }
}

static void step(Fmu *fmu, Inputs *inputs, long n)
{
    (void)inputs;
    for (long i = 0; i < n; i++)
        MUST(fmu_step(fmu, STEP), fmu);
}

/* Of all outputs along a seed in all inputs. */
static void derivative(Fmu *fmu, Inputs *inputs, long n)
{
    const uint32_t *unknowns = output_refs(&v), *knowns = input_refs(&v);
    const double *seed = inputs->rows;
    double result[MAX_VARIABLES];
    for (long i = 0; i < n; i++) {
        MUST(CALL(GetDirectionalDerivative(fmu->instance, unknowns, v.outputs, knowns, v.inputs, seed,
                                           result),
                  GetDirectionalDerivative(fmu->instance, unknowns, v.outputs, knowns, v.inputs, seed,
                                           v.inputs, result, v.outputs)),
             fmu);
        sum += result[0];
    }
}

/* What is measured: seconds per call of a loop, less those of another. */
typedef void Loop(Fmu *fmu, Inputs *inputs, long n);
typedef struct {
    const char *name;
    Loop *loop, *less;
    int inputs; /* which set of inputs */
} Measure;

enum { SMOOTH, STRAIGHT, TIGHTENING, BENT, SCATTERED, SETS };

static const Measure measures[] = {
    {"cycle_smooth", set_step_get, NULL, SMOOTH},
    {"cycle_straight", set_step_get, NULL, STRAIGHT},
    {"cycle_tightening", set_step_get, NULL, TIGHTENING},
    {"cycle_bent", set_step_get, NULL, BENT},
    {"cycle_random", set_step_get, NULL, SCATTERED},
    {"step_smooth", set_step, set, SMOOTH},
    {"step_random", set_step, set, SCATTERED},
    {"unchanged", step, NULL, SMOOTH},
    {"derivative", derivative, NULL, SMOOTH},
};
enum { MEASURES = sizeof measures / sizeof *measures };

static double seconds(Loop *loop, Fmu *fmu, Inputs *inputs, long n)
{
    const double start = now();
    loop(fmu, inputs, n);
    return now() - start;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_median(const char *name, double *x, int n)
{
    qsort(x, (size_t)n, sizeof *x, ascending);
    printf("%s %.9g\n", name, 0.5 * (x[(n - 1) / 2] + x[n / 2]));
}

static void start(Fmu *fmu, const char *token)
{
    CHECK(fmu_instantiate(fmu, &library, token, false, false), &fmu->log);
    MUST(fmu_enter(fmu), fmu);
    MUST(fmu_exit(fmu), fmu);
}

static void measure_calls(const char *token, Inputs inputs[SETS], int repeats)
{
    static double times[MEASURES][MOST_REPEATS];
    long calls[MEASURES];
    for (int i = 0; i < MEASURES; i++) {
        const Measure *m = &measures[i];
        Fmu fmu;
        start(&fmu, token);
        seconds(set_step_get, &fmu, &inputs[m->inputs], ROWS); /* what an instance keeps for later is made */
        calls[i] = 1;
        while (seconds(m->loop, &fmu, &inputs[m->inputs], calls[i]) < LONG_ENOUGH)
            calls[i] *= 2;
        for (int r = 0; r < repeats; r++) {
            const double whole = seconds(m->loop, &fmu, &inputs[m->inputs], calls[i]);
            const double less = m->less ? seconds(m->less, &fmu, &inputs[m->inputs], calls[i]) : 0.0;
            times[i][r] = (whole - less) / (double)calls[i];
        }
        fmu_free(&fmu);
    }
    for (int i = 0; i < MEASURES; i++)
        print_median(measures[i].name, times[i], repeats);
}

/* Each of a million random steps on its own: median, what one in 10 000 exceeds, and the longest. */
static void measure_worst(const char *token, Inputs *inputs)
{
    enum { STEPS = 1000000 };
    static double times[STEPS];
    Fmu fmu;
    start(&fmu, token);
    for (long i = 0; i < STEPS; i++) {
        set(&fmu, inputs, 1);
        const double begin = spent();
        step(&fmu, inputs, 1);
        times[i] = spent() - begin;
    }
    fmu_free(&fmu);
    print_median("median", times, STEPS);
    printf("rare %.9g\nlongest %.9g\n", times[STEPS - 1 - STEPS / 10000], times[STEPS - 1]);
}

/* From instantiation to the end of initialization. */
static void measure_start(const char *token, int repeats)
{
    static double times[MOST_REPEATS];
    for (int r = 0; r < repeats; r++) {
        Fmu fmu;
        const double begin = now();
        start(&fmu, token);
        times[r] = now() - begin;
        fmu_free(&fmu);
    }
    print_median("start", times, repeats);
}

static size_t allocated(void)
{
    const struct mallinfo info = mallinfo(); /* of glibc 2.17, for which FMUs are built */
    return (size_t)info.uordblks + (size_t)info.hblkhd;
}

static void measure_memory(const char *token)
{
    static Fmu fmus[INSTANCES];
    const size_t before = allocated();
    for (int i = 0; i < INSTANCES; i++)
        start(&fmus[i], token);
    printf("memory %zu\n", (allocated() - before) / INSTANCES);
    for (int i = 0; i < INSTANCES; i++)
        fmu_free(&fmus[i]);
}

static Inputs read_inputs(void)
{
    const size_t size = ROWS * v.inputs;
    Inputs inputs = {malloc(size * sizeof(double)), size, 0};
    if (!inputs.rows || fread(inputs.rows, sizeof(double), size, stdin) != size)
        fail(__FILE__, __LINE__, "too few inputs", NULL);
    return inputs;
}

int main(int argc, char **argv)
{
    const int repeats = argc == 7 ? atoi(argv[6]) : -1;
    if (repeats < 0 || repeats > MOST_REPEATS) {
        fprintf(stderr, "native_fmus LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS REPEATS (0: the longest steps) < inputs\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    v = layout(argv[4], argv[5], "0");
    Inputs inputs[SETS];
    for (int i = 0; i < SETS; i++)
        inputs[i] = read_inputs();
    if (repeats == 0) {
        measure_worst(argv[3], &inputs[SCATTERED]);
        return sum != sum;
    }
    measure_calls(argv[3], inputs, repeats);
    measure_start(argv[3], repeats);
    measure_memory(argv[3]);
    return sum != sum; /* everything that was read counts */
}
