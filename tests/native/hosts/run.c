/* run LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS < points
 *
 * One co-simulation step per line of inputs; the outputs after it go to standard output, one line each. */
#include "host.h"

int main(int argc, char **argv)
{
    if (argc != 6) {
        fprintf(stderr, "run LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS < points\n");
        return 2;
    }
    const Library library = load(argv[1], argv[2]);
    const Layout v = layout(argv[4], argv[5], "0");
    Fmu fmu;
    CHECK(fmu_instantiate(&fmu, &library, argv[3], false, false), &fmu.log);
    CHECK(fmu_enter(&fmu) == OK && fmu_exit(&fmu) == OK, &fmu.log);
    static double inputs[MAX_VARIABLES], outputs[MAX_VARIABLES];
    for (;;) {
        for (size_t i = 0; i < v.inputs; i++)
            if (scanf("%lf", &inputs[i]) != 1) {
                fmu_free(&fmu);
                return 0;
            }
        CHECK(fmu_set(&fmu, input_refs(&v), v.inputs, inputs) == OK, &fmu.log);
        CHECK(fmu_step(&fmu, 0.5) == OK, &fmu.log);
        CHECK(fmu_get(&fmu, output_refs(&v), v.outputs, outputs) == OK, &fmu.log);
        for (size_t i = 0; i < v.outputs; i++)
            printf("%.17g%c", outputs[i], i + 1 < v.outputs ? ' ' : '\n');
    }
}
