/* Dense systems by the modes of elastic sides. */
#ifndef JOINTFMU_DENSE_H
#define JOINTFMU_DENSE_H

#include <stdbool.h>

#include "law.h"

/* A row of modes and of the three motions that act with them, in fours. */
enum { LANES_OF_MODES = 4, WIDE = MODES + LANES_OF_MODES };
_Static_assert(MODES % LANES_OF_MODES == 0, "rows in fours");

/* Sum of the products of two rows. */
static inline double dense_dot(const double *a, const double *b)
{
    double sum[LANES_OF_MODES] = {0.0};
    for (int k = 0; k < MODES; k += LANES_OF_MODES)
        for (int l = 0; l < LANES_OF_MODES; l++)
            sum[l] += a[k + l] * b[k + l];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}
/* The following on a processor with has_avx or any other. */
/* Factors in place of a matrix `a`, whose columns are the rows of the array, with partial pivoting. */
typedef struct {
    double a[MODES][MODES];
    int pivots[MODES];
} Factors;
void dense_factor(bool use_avx, Factors *factors);
/* Solve with them, in place of the right side. */
void dense_solve(bool use_avx, const Factors *factors, double *x);
/* n rows with their weights, and the sums of those of four sets. */
void dense_weigh(bool use_avx, int n, const double *by, const double (*row)[WIDE], double (*result)[WIDE]);
void dense_combine(bool use_avx, int n, const double (*by)[4], const double (*const rows[4])[WIDE],
                   double (*result)[WIDE]);
/* Add the products of n weighted rows with rows to h up to a size, all or the lower half. */
void dense_products(bool use_avx, int n, const double (*restrict weighted)[WIDE], const double (*restrict rows)[WIDE],
                    int size, bool all, double (*restrict h)[WIDE]);
/* Add n rows with their weights to a sum over the modes. */
void dense_add_rows(bool use_avx, int n, const double *by, const double (*row)[WIDE], double *sum);
/* What n rows are along x, each in its place of the result. */
void dense_dots(bool use_avx, int n, const double (*row)[WIDE], const double *x, int stride, double *result);

#endif
