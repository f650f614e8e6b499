#include "data.h"

const Data data = {
    .magic = "jointfmu data 1",
    .name = "Dummy",
    .token = "{01234567-89ab-cdef-0123-456789abcdef}",
    .start = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.5, 10.0, 4.0, 1.0},
    .fixed = {0.0},
};
