#include "data.h"

const Data data = {
    .magic = "jointfmu data 1",
    .name = "PassThrough",
    .token = "{6f1c3a52-0f60-5c0b-9d57-1f2a4b6c8d10}",
    .start = {0.0, 0.0, 0.0, 0.0, 0.0, 1.0},
    .fixed = {0.0},
};
