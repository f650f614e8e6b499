#include "variables.h"

#include <math.h>

#define ANY_NUMBER "(-inf, inf)", -INFINITY, INFINITY, 0.0, 1, 1, 0, 0

const Variable variables[N_VALUES] = {
    {"time", "s", "time", ANY_NUMBER},
    {"u", "m", "displacement", ANY_NUMBER},
    {"preload", "N", "force that is added", "[0, inf)", 0.0, INFINITY, 0.0, 0, 1, 0, 0},
    {"f", "N", "force", ANY_NUMBER},
    {"K", "N/m", "df/du", ANY_NUMBER},
    {"E_loss", "J", "work turned into heat", ANY_NUMBER},
    {"k", "N/m", "stiffness", "(0, inf)", 0.0, INFINITY, 0.0, 1, 1, 0, 0},
    {"limit", "N", "force at which it slips", "[0, inf)", 0.0, INFINITY, 0.0, 0, 1, 0, 0},
};

const unsigned char output_dependencies[N_OUTPUTS][N_INPUTS] = {{1, 1}, {1, 0}, {1, 0}};
