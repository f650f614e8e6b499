#include "variables.h"

#include <math.h>

#define ANY_NUMBER "(-inf, inf)", -INFINITY, INFINITY, 0.0, 1, 1, 0, 0

const Variable variables[N_VALUES] = {
    {"time", "s", "time", ANY_NUMBER},
    {"preload", "N", "pre-tightening force", "[0, inf)", 0.0, INFINITY, 1e-3, 0, 1, 0, 0},
    {"phi", "rad", "angle, 100 % of #it#", ANY_NUMBER}, /* signs that FMI 2 gives a meaning */
    {"tau", "N.m", "k (phi + phi^3) + preload", ANY_NUMBER},
    {"square", "N2", "preload^2", ANY_NUMBER},
    {"K", "N.m/rad", "n k", ANY_NUMBER},
    {"D", "", "fractal dimension of the profile", "(1, 2)", 1.0, 2.0, 0.0, 1, 1, 0, 0},
    {"k", "N.m/rad", "stiffness", "[0, 1e+09]", 0.0, 1e9, 0.0, 0, 0, 0, 0},
    {"n", "", "number of bolts", "[1, inf)", 1.0, INFINITY, 0.0, 0, 1, 1, 0},
    {"rigid", "", "whether one side is rigid: twice the stiffness", "true, false", 0.0, 1.0, 0.0, 0, 0, 0, 1},
};

const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS] = {{1, 1}, {1, 0}, {0, 0}};
