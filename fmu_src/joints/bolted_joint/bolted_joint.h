/* Bolted joint: every node follows the curve of pressure over approach from its pressure at tightening.
 *
 * Sums over the nodes are exact polynomials of the normal displacement as long as no node passes from one
 * segment of the curve to the next. The displacements are divided into cells; a cell has the sum of the nodes
 * that pass nowhere in it as polynomials, and the list of the others. What a cell holds follows from
 * tightening and place alone, so it does not matter when it was made. */
#ifndef JOINTFMU_BOLTED_JOINT_H
#define JOINTFMU_BOLTED_JOINT_H

#include "approach.h"

enum {
    CELLS = 512,       /* kept at a time, by place modulo their number */
    PASSING = 40,      /* nodes that pass in a cell, on average where the nodes are spread over the curve */
    LIST = CELLS * 96, /* room for the lists of all cells */
    SLOTS = 64         /* segments whose nodes are summed at a time */
};
_Static_assert(LIST >= (int)N_NODES, "the list of a cell holds all nodes");
_Static_assert(N_NODES <= USHRT_MAX, "a list holds numbers of nodes");

/* Sums of powers of t over nodes on one segment, times share and share times the squares of position. */
typedef struct {
    int segment; /* its number plus one; 0: none */
    double share[6], x2[5], y2[5];
} Moments;

/* Polynomials of the approach from the middle of a cell, in halves of its width. */
typedef struct {
    double pressure[6];
    double about_x[5], about_y[5];
    double works[N_LAW_STATE][6];
} Polynomials;

/* A node, and the segment where it is at the end of the cell at which its approach is smallest. */
typedef struct {
    unsigned short node, segment;
} Passing;

typedef struct {
    double place; /* displacement over width, rounded down */
    unsigned long long tightening; /* 0: none */
    int first, passing;            /* nodes that pass, in the list */
    Polynomials sum;
} Cell;

typedef struct {
    Spots spots;
    Approach approach;
    bool tight;             /* the values at tightening are those of this preload and moment */
    double preload, moment;
    unsigned long long tightening; /* counted */
    const double (*nodes)[5]; /* NODES, or without a moment the fewer EVEN_NODES */
    int n_nodes;
    double start[N_NODES];  /* approach of each node at tightening */
    double tightened;       /* sum of the pressures times share */
    int tightest;           /* node with the largest pressure */
    double width;           /* of a cell [m] */
    int listed;             /* places in the list that are taken */
    Passing list[LIST];
    Cell cells[CELLS];
    Moments slots[SLOTS];
} Kind;

#endif
