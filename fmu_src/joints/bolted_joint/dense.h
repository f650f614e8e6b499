/* Dense linear systems whose unknowns are the modal coordinates of elastic members. */
#ifndef JOINTFMU_DENSE_H
#define JOINTFMU_DENSE_H

#include <stdbool.h>

#include "law.h"

/* Forbid the compiler to vectorize the loop that follows. */
#ifdef __clang__
#define NOT_VECTORIZED _Pragma("clang loop vectorize(disable)")
#else
#define NOT_VECTORIZED
#endif

/* A row has the modes, then three rigid motions and an unused column, so that its length is a multiple of four. */
enum { LANES = 4, N_COLUMNS = MODES + LANES };
_Static_assert(MODES % LANES == 0, "rows in fours");

/* Dot product of the modal entries of two rows. */
static inline double dense_dot(const double *a, const double *b)
{
    double sum[LANES] = {0.0};
    for (int k = 0; k < MODES; k += LANES)
        for (int l = 0; l < LANES; l++)
            sum[l] += a[k + l] * b[k + l];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}
/* `use_avx`: the processor has AVX; results are equal to the bit with and without it. */
/* LU factors with partial pivoting; they replace the matrix `a`, whose columns are the rows of the array. */
typedef struct {
    double a[MODES][MODES];
    int pivots[MODES];
} Factorization;
void dense_factor(bool use_avx, Factorization *factors);
/* Solve a system with the factors; the solution replaces the right side. */
void dense_solve(bool use_avx, const Factorization *factors, double *x);
/* Multiply n rows by their weights `by`; dense_combine: weighted sums of four sets of n rows. */
void dense_weigh(bool use_avx, int n, const double *by, const double (*row)[N_COLUMNS], double (*result)[N_COLUMNS]);
void dense_combine(bool use_avx, int n, const double (*by)[4], const double (*const rows[4])[N_COLUMNS],
                   double (*result)[N_COLUMNS]);
/* Add the products of n weighted rows and n rows to h, up to a size; `all`: the complete matrix, else its lower half.
 * `resume`: add to h row by row, as if the rows continued an earlier call; else add the sum of the products. */
void dense_products(bool use_avx, int n, const double (*restrict weighted)[N_COLUMNS],
                    const double (*restrict rows)[N_COLUMNS], int size, bool all, bool resume,
                    double (*restrict h)[N_COLUMNS]);
/* Add n rows, times their weights `by`, to a sum over the modes. */
void dense_add_rows(bool use_avx, int n, const double *by, const double (*row)[N_COLUMNS], double *sum);
/* Dot products of n rows with x, written to the result with a stride. */
void dense_dots(bool use_avx, int n, const double (*row)[N_COLUMNS], const double *x, int stride, double *result);

#endif
