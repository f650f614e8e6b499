/* What an FMU is beside its code: name, token, start values, numbers that no tool may set. */
#ifndef JOINTFMU_DATA_H
#define JOINTFMU_DATA_H

#include <stdint.h>

enum { N_HIDDEN_PARAMETERS = 0 };

typedef struct {
    char magic[16];
    char name[64];
    char token[40];
    double start[6];
    double fixed[1];
} Data;
_Static_assert(sizeof(Data) == 176, "the same bytes on every platform");

extern const Data data;

#endif
