#include "dense.h"

#include <math.h>
#include <string.h>

#include "simd.h"

enum { L = LANES };

/* Subtract `by` times a column from x, from row `first` on, four rows at a time. */
static inline void subtract_column(double by, const double *restrict column, int first, double *restrict x)
{
    for (int r = first; r < MODES; r += L)
        for (int l = 0; l < L; l++)
            x[r + l] -= by * column[r + l];
}

/* A column of the matrix is a row of the array, so operations on a column are vectorized. */

ALWAYS_INLINE void factor(double (*a)[MODES], int *pivots)
{
    for (int c = 0; c < MODES; c++) {
        double column[MODES];
        int best = c;
        for (int r = c + 1; r < MODES; r++)
            best = fabs(a[c][r]) > fabs(a[c][best]) ? r : best;
        pivots[c] = best;
        for (int k = 0; k < MODES && best != c; k++) {
            const double kept = a[k][c];
            a[k][c] = a[k][best];
            a[k][best] = kept;
        }
        a[c][c] = 1.0 / a[c][c];
        for (int r = c + 1; r < MODES; r++)
            a[c][r] *= a[c][c];
        for (int r = 0; r < MODES; r++)
            column[r] = r > c ? a[c][r] : 0.0;
        for (int k = c + 1; k < MODES; k++)
            subtract_column(a[k][c], column, (c + 1) / L * L, a[k]);
    }
}
DEFINE_BASELINE_AND_AVX(factor, (double (*a)[MODES], int *pivots), (a, pivots))

void dense_factor(bool use_avx, Factorization *factors)
{
    (use_avx ? factor_avx : factor_baseline)(factors->a, factors->pivots);
}

/* Eliminate four columns at a time: their own four rows one by one, the other rows in vectors. */
ALWAYS_INLINE void solve(const double (*a)[MODES], const int *pivots, double *x)
{
    for (int c = 0; c < MODES; c++) {
        const double kept = x[pivots[c]];
        x[pivots[c]] = x[c];
        x[c] = kept;
    }
    for (int b = 0; b < MODES; b += L) {
        for (int c = b; c < b + L; c++)
            for (int r = c + 1; r < b + L; r++)
                x[r] -= x[c] * a[c][r];
        for (int c = b; c < b + L; c++)
            subtract_column(x[c], a[c], b + L, x);
    }
    for (int b = MODES - L; b >= 0; b -= L) {
        for (int c = b + L - 1; c >= b; c--) {
            x[c] *= a[c][c];
            for (int r = b; r < c; r++)
                x[r] -= x[c] * a[c][r];
        }
        for (int c = b + L - 1; c >= b; c--)
            for (int r = 0; r < b; r += L)
                for (int l = 0; l < L; l++)
                    x[r + l] -= x[c] * a[c][r + l];
    }
}
DEFINE_BASELINE_AND_AVX(solve, (const double (*a)[MODES], const int *pivots, double *x), (a, pivots, x))

void dense_solve(bool use_avx, const Factorization *factors, double *x)
{
    (use_avx ? solve_avx : solve_baseline)((const double(*)[MODES])factors->a, factors->pivots, x);
}

ALWAYS_INLINE void weigh(int n, const double *by, const double (*restrict row)[N_COLUMNS],
                         double (*restrict result)[N_COLUMNS])
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < N_COLUMNS; k++)
            result[i][k] = by[i] * row[i][k];
}
DEFINE_BASELINE_AND_AVX(weigh,
                        (int n, const double *by, const double (*restrict row)[N_COLUMNS],
                         double (*restrict result)[N_COLUMNS]),
                        (n, by, row, result))

void dense_weigh(bool use_avx, int n, const double *by, const double (*row)[N_COLUMNS], double (*result)[N_COLUMNS])
{
    (use_avx ? weigh_avx : weigh_baseline)(n, by, row, result);
}

ALWAYS_INLINE void combine(int n, const double (*by)[4], const double (*restrict x)[N_COLUMNS],
                           const double (*restrict y)[N_COLUMNS], const double (*restrict t)[N_COLUMNS],
                           const double (*restrict z)[N_COLUMNS], double (*restrict result)[N_COLUMNS])
{
    for (int i = 0; i < n; i++)
        for (int k = 0; k < N_COLUMNS; k++)
            result[i][k] = by[i][0] * x[i][k] + by[i][1] * y[i][k] + by[i][2] * t[i][k] + by[i][3] * z[i][k];
}
DEFINE_BASELINE_AND_AVX(combine,
                        (int n, const double (*by)[4], const double (*restrict x)[N_COLUMNS],
                         const double (*restrict y)[N_COLUMNS], const double (*restrict t)[N_COLUMNS],
                         const double (*restrict z)[N_COLUMNS], double (*restrict result)[N_COLUMNS]),
                        (n, by, x, y, t, z, result))

void dense_combine(bool use_avx, int n, const double (*by)[4], const double (*const rows[4])[N_COLUMNS],
                   double (*result)[N_COLUMNS])
{
    (use_avx ? combine_avx : combine_baseline)(n, by, rows[0], rows[1], rows[2], rows[3], result);
}

/* Sums are split into lanes, which a processor adds in parallel. */

ALWAYS_INLINE void products(int n, const double (*restrict weighted)[N_COLUMNS],
                            const double (*restrict rows)[N_COLUMNS], int size, bool all, bool resume,
                            double (*restrict h)[N_COLUMNS])
{
    for (int r = 0; r < size; r += L) /* in blocks, whose sums stay in registers */
        for (int c = 0; c <= (all ? size - L : r); c += L) {
            double sum[L][L];
            for (int k = 0; k < L; k++)
                for (int l = 0; l < L; l++)
                    sum[k][l] = resume ? h[r + k][c + l] : 0.0;
            for (int i = 0; i < n; i++)
                for (int k = 0; k < L; k++)
                    for (int l = 0; l < L; l++)
                        sum[k][l] += weighted[i][r + k] * rows[i][c + l];
            for (int k = 0; k < L; k++)
                for (int l = 0; l < L; l++)
                    h[r + k][c + l] = resume ? sum[k][l] : h[r + k][c + l] + sum[k][l];
        }
}
DEFINE_BASELINE_AND_AVX(products,
               (int n, const double (*restrict weighted)[N_COLUMNS], const double (*restrict rows)[N_COLUMNS], int size,
                bool all, bool resume, double (*restrict h)[N_COLUMNS]),
               (n, weighted, rows, size, all, resume, h))

void dense_products(bool use_avx, int n, const double (*restrict weighted)[N_COLUMNS],
                    const double (*restrict rows)[N_COLUMNS], int size, bool all, bool resume,
                    double (*restrict h)[N_COLUMNS])
{
    (use_avx ? products_avx : products_baseline)(n, weighted, rows, size, all, resume, h);
}

ALWAYS_INLINE void add_rows(int n, const double *by, const double (*row)[N_COLUMNS], double *restrict sum)
{
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < MODES; k++)
            sum[k] += (by[i] * row[i][k] + by[i + 1] * row[i + 1][k]) +
                      (by[i + 2] * row[i + 2][k] + by[i + 3] * row[i + 3][k]);
    for (; i < n; i++)
        for (int k = 0; k < MODES; k++)
            sum[k] += by[i] * row[i][k];
}
DEFINE_BASELINE_AND_AVX(add_rows, (int n, const double *by, const double (*row)[N_COLUMNS], double *restrict sum),
                        (n, by, row, sum))

void dense_add_rows(bool use_avx, int n, const double *by, const double (*row)[N_COLUMNS], double *sum)
{
    (use_avx ? add_rows_avx : add_rows_baseline)(n, by, row, sum);
}

ALWAYS_INLINE void dots(int n, const double (*row)[N_COLUMNS], const double *x, int stride, double *result)
{
    enum { ROWS = 32 }; /* rows at a time: first the lanes of all rows, then the sums of the lanes */
    double sum[ROWS][L];
    for (int first = 0; first < n; first += ROWS) {
        const int rows = n - first < ROWS ? n - first : ROWS;
        NOT_VECTORIZED /* the lanes of one row are added in parallel, not two rows */
        for (int i = 0; i < rows; i++) {
            double lane[L] = {0.0};
            for (int k = 0; k < MODES; k += L)
                for (int l = 0; l < L; l++)
                    lane[l] += row[first + i][k + l] * x[k + l];
            memcpy(sum[i], lane, sizeof lane);
        }
        for (int i = 0; i < rows; i++)
            result[stride * (first + i)] = (sum[i][0] + sum[i][2]) + (sum[i][1] + sum[i][3]);
    }
}
DEFINE_BASELINE_AND_AVX(dots, (int n, const double (*row)[N_COLUMNS], const double *x, int stride, double *result),
               (n, row, x, stride, result))

void dense_dots(bool use_avx, int n, const double (*row)[N_COLUMNS], const double *x, int stride, double *result)
{
    (use_avx ? dots_avx : dots_baseline)(n, row, x, stride, result);
}
