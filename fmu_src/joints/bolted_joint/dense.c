#include "dense.h"

#include <math.h>
#include <string.h>

#include "vectors.h"

/* From a row on, a multiple of four. */
static inline void take_fours(double by, const double *restrict column, int first, double *restrict x)
{
    for (int r = first; r < MODES; r += LANES_OF_MODES)
        for (int l = 0; l < LANES_OF_MODES; l++)
            x[r + l] -= by * column[r + l];
}

/* Columns are rows of the array, so that what is done to a column goes side by side. */

void dense_factor(double (*a)[MODES], int *pivots)
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
            take_fours(a[k][c], column, (c + 1) / LANES_OF_MODES * LANES_OF_MODES, a[k]);
    }
}

static inline void take(double by, const double *restrict column, int first, int end, double *restrict x)
{
    for (int r = first; r < end; r++)
        x[r] -= by * column[r];
}

void dense_solve(const double (*a)[MODES], const int *pivots, double *x)
{
    for (int c = 0; c < MODES; c++) {
        const double kept = x[pivots[c]];
        x[pivots[c]] = x[c];
        x[c] = kept;
    }
    for (int c = 0; c < MODES; c++)
        take(x[c], a[c], c + 1, MODES, x);
    for (int c = MODES - 1; c >= 0; c--) {
        x[c] *= a[c][c];
        take(x[c], a[c], 0, c, x);
    }
}

/* Sums go in lanes, which a processor adds side by side. */

WITHIN void products(int n, const double (*restrict weighted)[WIDE], const double (*restrict rows)[WIDE], int size,
                     double (*restrict h)[WIDE])
{
    enum { L = LANES_OF_MODES }; /* in blocks, whose sums stay in registers */
    for (int r = 0; r < size; r += L)
        for (int c = 0; c <= r; c += L) {
            double sum[L][L] = {{0.0}};
            for (int i = 0; i < n; i++)
                for (int k = 0; k < L; k++)
                    for (int l = 0; l < L; l++)
                        sum[k][l] += weighted[i][r + k] * rows[i][c + l];
            for (int k = 0; k < L; k++)
                for (int l = 0; l < L; l++)
                    h[r + k][c + l] += sum[k][l];
        }
}
COMPILED_TWICE(products,
               (int n, const double (*restrict weighted)[WIDE], const double (*restrict rows)[WIDE], int size,
                double (*restrict h)[WIDE]),
               (n, weighted, rows, size, h))

void dense_products(bool fours, int n, const double (*restrict weighted)[WIDE], const double (*restrict rows)[WIDE],
                    int size, double (*restrict h)[WIDE])
{
    (fours ? products_fours : products_any)(n, weighted, rows, size, h);
}

WITHIN void add_rows(int n, const double *by, const double (*row)[WIDE], double *restrict sum)
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
COMPILED_TWICE(add_rows, (int n, const double *by, const double (*row)[WIDE], double *restrict sum), (n, by, row, sum))

void dense_add_rows(bool fours, int n, const double *by, const double (*row)[WIDE], double *sum)
{
    (fours ? add_rows_fours : add_rows_any)(n, by, row, sum);
}

WITHIN void dots(int n, const double (*row)[WIDE], const double *x, int stride, double *result)
{
    for (int i = 0; i < n; i++)
        result[stride * i] = dense_dot(row[i], x);
}
COMPILED_TWICE(dots, (int n, const double (*row)[WIDE], const double *x, int stride, double *result),
               (n, row, x, stride, result))

void dense_dots(bool fours, int n, const double (*row)[WIDE], const double *x, int stride, double *result)
{
    (fours ? dots_fours : dots_any)(n, row, x, stride, result);
}
