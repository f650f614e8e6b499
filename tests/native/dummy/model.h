/* A joint in which everything occurs that a joint can have, for tests of the runtime. */
#define MODEL_NAME "Dummy"
#define MODEL_TOKEN "{01234567-89ab-cdef-0123-456789abcdef}"
#define MODEL_VERSION "1"

enum { N_INPUTS = 2, N_OUTPUTS = 3, N_PARAMETERS = 4 };
