/* Dense systems by the modes of elastic sides. */
#ifndef JOINTFMU_DENSE_H
#define JOINTFMU_DENSE_H

#include <stdbool.h>

#include "law.h"

/* Before a loop whose iterations shall not run side by side. */
#ifdef __clang__
#define NOT_VECTORIZED _Pragma("clang loop vectorize(disable)")
#else
#define NOT_VECTORIZED
#endif

/* A row of modes and of the three motions that act with them, in fours. */
enum { LANES = 4, N_COLUMNS = MODES + LANES };
_Static_assert(MODES % LANES == 0, "rows in fours");

/* Sum of the products of two rows. */
static inline double dense_dot(const double *a, const double *b)
{
    double sum[LANES] = {0.0};
    for (int k = 0; k < MODES; k += LANES)
        for (int l = 0; l < LANES; l++)
            sum[l] += a[k + l] * b[k + l];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}
/* `use_avx`: the processor has AVX; results are equal to the bit with and without it. */
/* Factors in place of a matrix `a`, whose columns are the rows of the array, with partial pivoting. */
typedef struct {
    double a[MODES][MODES];
    int pivots[MODES];
} Factorization;
void dense_factor(bool use_avx, Factorization *factors);
/* Solve a system with the factors; the solution replaces the right side. */
void dense_solve(bool use_avx, const Factorization *factors, double *x);
/* n rows with their weights, and the sums of those of four sets. */
void dense_weigh(bool use_avx, int n, const double *by, const double (*row)[N_COLUMNS], double (*result)[N_COLUMNS]);
void dense_combine(bool use_avx, int n, const double (*by)[4], const double (*const rows[4])[N_COLUMNS],
                   double (*result)[N_COLUMNS]);
/* Add the products of n weighted rows with rows to h up to a size, all or the lower half: their sum; or, to resume the
 * sum of the rows before, one after the other. */
void dense_products(bool use_avx, int n, const double (*restrict weighted)[N_COLUMNS],
                    const double (*restrict rows)[N_COLUMNS], int size, bool all, bool resume,
                    double (*restrict h)[N_COLUMNS]);
/* Add n rows with their weights to a sum over the modes. */
void dense_add_rows(bool use_avx, int n, const double *by, const double (*row)[N_COLUMNS], double *sum);
/* Dot products of n rows with x, written to the result with a stride. */
void dense_dots(bool use_avx, int n, const double (*row)[N_COLUMNS], const double *x, int stride, double *result);

#endif
