/* A joint that passes its inputs on: the least that an FMU of this runtime does, for tests and benchmarks. */

enum { N_INPUTS = 2, N_OUTPUTS = 2, N_PARAMETERS = 1 };
