/* A joint that passes its inputs on: the least that an FMU of this runtime does, for tests and benchmarks. */
#define MODEL_NAME "PassThrough"
#define MODEL_TOKEN "{6f1c3a52-0f60-5c0b-9d57-1f2a4b6c8d10}"
#define MODEL_VERSION "1"

enum { N_INPUTS = 2, N_OUTPUTS = 2, N_PARAMETERS = 1 };
