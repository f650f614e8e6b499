/* Repeats `Blocks` of table.py in the package. */
#include "table.h"

void block_through(Block *block, const Sample *first, const Sample *middle, const Sample *last, double cell)
{
    for (int q = 0; q < BLOCK_FUNCTIONS; q++) {
        const double y0 = first->value[q], y1 = middle->value[q], y2 = last->value[q];
        const double s0 = cell * first->slope[q], s1 = cell * middle->slope[q], s2 = cell * last->slope[q];
        const double even = 0.5 * (y0 + y2) - y1, odd = 0.5 * (y2 - y0) - s1;
        const double fourth = 0.25 * (s2 - s0) - even, fifth = 0.5 * (0.5 * (s0 + s2) - s1 - 3.0 * odd);
        double *a = block->a[q];
        a[0] = y1;
        a[1] = s1;
        a[2] = even - fourth;
        a[3] = odd - fifth;
        a[4] = fourth;
        a[5] = fifth;
    }
}

void blocks_at(const Blocks *blocks, int functions, double x, double *value, double *slope)
{
    const double place = (x - blocks->start) / (2.0 * blocks->cell);
    int k = place > 0.0 ? (int)place : 0;
    if (k >= blocks->n)
        k = blocks->n - 1;
    double t = 2.0 * (place - k) - 1.0;
    t = t < -1.0 ? -1.0 : (t > 1.0 ? 1.0 : t);
    for (int q = 0; q < functions; q++) {
        const double *a = blocks->block[k].a[q];
        value[q] = a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * (a[4] + t * a[5]))));
        slope[q] = (a[1] + t * (2.0 * a[2] + t * (3.0 * a[3] + t * (4.0 * a[4] + t * 5.0 * a[5])))) / blocks->cell;
    }
}

double block_value(const Block *block, double t)
{
    const double *a = block->a[0];
    return a[0] + t * (a[1] + t * (a[2] + t * (a[3] + t * (a[4] + t * a[5]))));
}
