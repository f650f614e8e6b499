/* Functions on an interval as quintics over blocks of two equal cells, each from the values and slopes at
 * its three nodes. */
#ifndef JOINTFMU_TABLE_H
#define JOINTFMU_TABLE_H

enum { BLOCK_FUNCTIONS = 2 };

typedef struct {
    double value[BLOCK_FUNCTIONS], slope[BLOCK_FUNCTIONS];
} Sample;

typedef struct {
    double a[BLOCK_FUNCTIONS][6]; /* of 1, t, ... t^5, t from -1 to 1 over the block */
} Block;

typedef struct {
    double start, cell;
    int n;
    Block *block; /* n of them, in memory of the owner */
} Blocks;

/* The block through three samples at a distance `cell`. */
void block_through(Block *block, const Sample *first, const Sample *middle, const Sample *last, double cell);

/* Values and slopes of the first `functions` at x, kept inside the table. */
void blocks_at(const Blocks *blocks, int functions, double x, double *value, double *slope);

/* Value of the first function of a block at t. */
double block_value(const Block *block, double t);

#endif
