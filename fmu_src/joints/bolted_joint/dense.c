#include "dense.h"

#include <math.h>

void dense_factor(double (*a)[MODES], int *pivots)
{
    for (int c = 0; c < MODES; c++) {
        int best = c;
        for (int r = c + 1; r < MODES; r++)
            best = fabs(a[r][c]) > fabs(a[best][c]) ? r : best;
        pivots[c] = best;
        for (int k = 0; k < MODES && best != c; k++) {
            const double kept = a[c][k];
            a[c][k] = a[best][k];
            a[best][k] = kept;
        }
        for (int r = c + 1; r < MODES; r++) {
            const double by = a[r][c] / a[c][c];
            a[r][c] = by;
            for (int k = c + 1; k < MODES; k++)
                a[r][k] -= by * a[c][k];
        }
    }
}

void dense_solve(const double (*a)[MODES], const int *pivots, double *x)
{
    for (int c = 0; c < MODES; c++) {
        const double kept = x[pivots[c]];
        x[pivots[c]] = x[c];
        x[c] = kept;
    }
    for (int r = 0; r < MODES; r++)
        for (int k = 0; k < r; k++)
            x[r] -= a[r][k] * x[k];
    for (int r = MODES - 1; r >= 0; r--) {
        for (int k = r + 1; k < MODES; k++)
            x[r] -= a[r][k] * x[k];
        x[r] /= a[r][r];
    }
}

void dense_products(int n, const double (*restrict weighted)[WIDE], const double (*restrict rows)[WIDE], int size,
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
