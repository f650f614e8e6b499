/* Harmonic drive: torque over wind-up, odd; with the stiffness of the contact pair tabulated first. */
#ifndef JOINTFMU_HARMONIC_DRIVE_H
#define JOINTFMU_HARMONIC_DRIVE_H

#include "table.h"
#include "spots.h"

/* Blocks of two cells; every regime may end within one, and round-off may take another. */
enum { REGIME_BLOCKS = MOST_CELLS / 2 + 2 * N_LAW_ENDS, PAIR_BLOCKS = 2 * MOST_PAIR_STEPS };

typedef struct {
    Spots spots;
    double smoothing, max_torque, pair_scale, K_FTS0, length; /* of the drive */
    int n_regimes;
    double edges[N_LAW_ENDS]; /* [Pa] where a regime begins, ascending; below the first no stiffness */
    Blocks regimes[N_LAW_ENDS]; /* normal and tangential stiffness over the log-pressure above each */
    Blocks pair;                /* K_TS on the paper's scale over the log of the peak pressure */
    double pair_error;
    Block regime_blocks[REGIME_BLOCKS];
    Block pair_blocks[PAIR_BLOCKS];
} Kind;

#endif
