/* threads LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS PARAMETER < points
 *
 * Eight threads with an instance each, at the same time and one after another: the numbers are the same.
 * Instance k scales the points by 1 - k/10 and the start value of PARAMETER, a value reference, by 1 +
 * k/1000. */
#include "host.h"

#ifndef _WIN32
#include <pthread.h>
#endif

enum { N_THREADS = 8, MAX_POINTS = 4096 };

static Library library;
static const char *token;
static Layout v;
static uint32_t parameter;
static double points[MAX_POINTS];
static size_t n_points; /* numbers, a multiple of the inputs */

typedef struct {
    int number;
    double outputs[MAX_POINTS];
} Job;

static void work(Job *job)
{
    Fmu fmu;
    double value, inputs[MAX_VARIABLES], outputs[MAX_VARIABLES];
    CHECK(fmu_instantiate(&fmu, &library, token, false, false), &fmu.log);
    CHECK(fmu_enter(&fmu) == OK, &fmu.log);
    CHECK(fmu_get(&fmu, &parameter, 1, &value) == OK, &fmu.log);
    value *= 1.0 + 1e-3 * job->number;
    CHECK(fmu_set(&fmu, &parameter, 1, &value) == OK, &fmu.log);
    CHECK(fmu_exit(&fmu) == OK, &fmu.log);
    size_t n = 0;
    for (size_t at = 0; at < n_points; at += v.inputs) {
        for (size_t i = 0; i < v.inputs; i++)
            inputs[i] = points[at + i] * (1.0 - 0.1 * job->number);
        CHECK(fmu_set(&fmu, input_refs(&v), v.inputs, inputs) == OK, &fmu.log);
        CHECK(fmu_step(&fmu, 0.5) == OK, &fmu.log);
        CHECK(fmu_get(&fmu, output_refs(&v), v.outputs, outputs) == OK, &fmu.log);
        for (size_t i = 0; i < v.outputs && n < MAX_POINTS; i++)
            job->outputs[n++] = outputs[i];
    }
    fmu_free(&fmu);
}

#ifdef _WIN32
typedef HANDLE Thread;
static DWORD WINAPI start(void *job)
{
    work(job);
    return 0;
}
static void begin(Thread *thread, Job *job)
{
    *thread = CreateThread(NULL, 0, start, job, 0, NULL);
}
static void end(Thread thread)
{
    WaitForSingleObject(thread, INFINITE);
}
#else
typedef pthread_t Thread;
static void *start(void *job)
{
    work(job);
    return NULL;
}
static void begin(Thread *thread, Job *job)
{
    if (pthread_create(thread, NULL, start, job) != 0)
        fail(__FILE__, __LINE__, "no thread", NULL);
}
static void end(Thread thread)
{
    pthread_join(thread, NULL);
}
#endif

int main(int argc, char **argv)
{
    static Job together[N_THREADS], alone[N_THREADS];
    Thread threads[N_THREADS];
    if (argc != 7) {
        fprintf(stderr, "threads LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS PARAMETER < points\n");
        return 2;
    }
    library = load(argv[1], argv[2]);
    token = argv[3];
    v = layout(argv[4], argv[5], "0");
    parameter = (uint32_t)strtoul(argv[6], NULL, 10);
    while (n_points < MAX_POINTS && scanf("%lf", &points[n_points]) == 1)
        n_points++;
    n_points -= n_points % v.inputs;

    for (int i = 0; i < N_THREADS; i++) {
        together[i].number = alone[i].number = i;
        begin(&threads[i], &together[i]);
    }
    for (int i = 0; i < N_THREADS; i++)
        end(threads[i]);
    for (int i = 0; i < N_THREADS; i++) {
        work(&alone[i]);
        if (memcmp(&together[i], &alone[i], sizeof(Job)) != 0)
            fail(__FILE__, __LINE__, "numbers differ between threads and one after another", NULL);
        if (i > 0 && memcmp(alone[i].outputs, alone[0].outputs, sizeof alone[i].outputs) == 0)
            fail(__FILE__, __LINE__, "two instances gave the same numbers", NULL);
    }
    printf("%d threads, %zu numbers each\n", N_THREADS, n_points / v.inputs * v.outputs);
    return 0;
}
