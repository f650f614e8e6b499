/* A joint in which everything occurs that a joint can have, for tests of the runtime. */

enum { N_INPUTS = 2, N_OUTPUTS = 3, N_PARAMETERS = 4 };
