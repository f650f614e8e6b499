/* Dense systems by the modes of elastic sides. */
#ifndef JOINTFMU_DENSE_H
#define JOINTFMU_DENSE_H

#include "law.h"

/* A row of modes and of the three motions that act with them, in fours. */
enum { LANES_OF_MODES = 4, WIDE = MODES + LANES_OF_MODES };
_Static_assert(MODES % LANES_OF_MODES == 0, "rows in fours");

/* Factors in place of a matrix, whose columns are the rows of the array, with partial pivoting. */
void dense_factor(double (*a)[MODES], int *pivots);
/* Solve with them, in place of the right side. */
void dense_solve(const double (*factors)[MODES], const int *pivots, double *x);
/* Add the products of n weighted rows with the rows themselves to h, its lower half up to a size. */
void dense_products(int n, const double (*restrict weighted)[WIDE], const double (*restrict rows)[WIDE], int size,
                    double (*restrict h)[WIDE]);

#endif
