/* Every joint is constants that follow from the parameters, a curve, and what its kind needs beside. */
#ifndef JOINTFMU_TABULATED_H
#define JOINTFMU_TABULATED_H

#include "curve.h"
#include "joint.h"
#include "kind.h" /* generated: includes the header that defines Kind */
#include "law.h"
#include "variables.h"

struct Joint {
    double c[N_CONSTANTS]; /* the parameters, those that are fixed, then what the laws need of them */
    Curve curve;
    Kind kind;
};

/* Fill the curve, given the constants; false: refused. */
bool kind_tabulate(Joint *joint, Text *why);

/* Builds a curve from so many steps, finer from call to call until its error is small enough. */
typedef bool (*Tabulate)(Joint *joint, int steps, Text *why);
bool refined(Joint *joint, Tabulate tabulate, int steps, Text *why);

#endif
