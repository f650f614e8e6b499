/* The interface law: its numbers for one parameter set, and the inversion from pressure to largest spot.
 *
 * The functions law_... are generated from the Python package into law.c; u is the log-area of the largest
 * spot. Costly sums change their form at law_switches, so there is a function for each range between them. */
#ifndef JOINTFMU_SPOTS_H
#define JOINTFMU_SPOTS_H

#include <stdbool.h>

#include "law.h"
#include "text.h"

typedef struct {
    double area;                      /* nominal area A_0 [m2] */
    double hardness;                  /* [Pa] */
    double reference;                 /* area of log-area 0 [m2] */
    double m;                         /* exponent of the size distribution */
    double onset;                     /* log-area up to which there is no stiffness */
    int n_ends;
    double ends[N_LAW_ENDS + 1];      /* ascending log-areas where the slope of the stiffness jumps */
    double switches[N_LAW_SWITCHES + 1];
    double least, most;               /* logs of the smallest and largest load that can be represented */
} Spots;

/* false: the law cannot be represented with these constants, `why` says so. */
bool spots_begin(Spots *spots, const double *c, Text *why);

/* Load and quantities with their slopes in u: y = F, F', K_n, K_n', ... */
void spots_table(const Spots *spots, const double *c, double u, double *y);

/* Which of the functions law_..._0, 1, ... is valid at u. */
int spots_regime(const Spots *spots, double u);

/* Log-area u of the largest spot under a nominal pressure > 0, from a first guess, and d ln(load)/du. */
bool spots_solve(const Spots *spots, const double *c, double pressure, double *u, double *slope, Text *why);

#endif
