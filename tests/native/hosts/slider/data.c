#include "data.h"

const Data data = {
    .magic = "jointfmu data 1",
    .name = "Slider",
    .token = "{89abcdef-0123-4567-89ab-cdef01234567}",
    .start = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 64.0, 1.0},
    .fixed = {0.0},
};
