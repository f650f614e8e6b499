#include "variables.h"

#include <math.h>

#define ANY_NUMBER "(-inf, inf)", -INFINITY, INFINITY, 0.0, 1, 1, 0, 0

const Variable variables[N_VALUES] = {
    {"time", "s", "time", ANY_NUMBER},
    {"u1", "m", "first input", ANY_NUMBER},
    {"u2", "m", "second input", ANY_NUMBER},
    {"y1", "m", "gain u1", ANY_NUMBER},
    {"y2", "m", "gain u2", ANY_NUMBER},
    {"gain", "", "outputs over inputs", "(0, 1e+06]", 0.0, 1e6, 0.0, 1, 0, 0, 0},
};

const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS] = {{1, 0}, {0, 1}};
