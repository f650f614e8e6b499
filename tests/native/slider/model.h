/* A joint with memory: a spring that slips, for tests of the runtime. */
#define MODEL_NAME "Slider"
#define MODEL_TOKEN "{89abcdef-0123-4567-89ab-cdef01234567}"
#define MODEL_VERSION "1"
#define N_MEMORY 3

enum { N_INPUTS = 2, N_OUTPUTS = 3, N_PARAMETERS = 2 };
