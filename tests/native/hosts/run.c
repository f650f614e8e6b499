/* run LIBRARY 2|3 TOKEN N_INPUTS N_OUTPUTS < points
 *
 * One co-simulation step per line of inputs; the outputs after it go to standard output, one line each. A number
 * is written as its 64 bits, 16 hexadecimal digits: so no C library converts it. */
#include "host.h"

static const char DIGITS[] = "0123456789abcdef";

/* Whether there was a number. */
static bool read_number(double *value)
{
    uint64_t bits = 0;
    for (int i = 0; i < 16; i++) {
        const int c = getchar();
        if (c == EOF)
            return false;
        bits = bits << 4 | (uint64_t)(strchr(DIGITS, c) - DIGITS);
    }
    memcpy(value, &bits, sizeof bits);
    (void)getchar(); /* what parts it from the next */
    return true;
}

static void write_number(double value, char after)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    for (int i = 60; i >= 0; i -= 4)
        putchar(DIGITS[bits >> i & 15]);
    putchar(after);
}

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
            if (!read_number(&inputs[i])) {
                fmu_free(&fmu);
                return 0;
            }
        CHECK(fmu_set(&fmu, input_refs(&v), v.inputs, inputs) == OK, &fmu.log);
        CHECK(fmu_step(&fmu, 0.5) == OK, &fmu.log);
        CHECK(fmu_get(&fmu, output_refs(&v), v.outputs, outputs) == OK, &fmu.log);
        for (size_t i = 0; i < v.outputs; i++)
            write_number(outputs[i], i + 1 < v.outputs ? ' ' : '\n');
    }
}
