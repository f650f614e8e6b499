/* A joint with memory: a spring that slips, for tests of the runtime. */
#define N_HISTORY 3

enum { N_INPUTS = 2, N_OUTPUTS = 3, N_PARAMETERS = 2 };
