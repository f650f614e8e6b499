/* Simulation of a system over measured inputs in one call, for a fit that loads the library without an FMU. */
#include "fmi3Functions.h"

#include "instance.h"

/* Simulate an initialized instance of co-simulation and return how many of `n` times were reached; fewer than `n` if a
 * step was refused, with a message. The inputs are linear between the times.
 *
 * times   : increasing; the first one is the present time of the instance
 * inputs  : value references (n_inputs); their values (n, n_inputs), one row a time
 * outputs : value references (n_outputs); their values (n, n_outputs) are written */
FMI3_Export size_t jointfmu_simulate(fmi3Instance c, size_t n, const fmi3Float64 times[], size_t n_inputs,
                                     const fmi3ValueReference inputs[], const fmi3Float64 input_values[],
                                     size_t n_outputs, const fmi3ValueReference outputs[], fmi3Float64 output_values[]);
size_t jointfmu_simulate(fmi3Instance c, size_t n, const fmi3Float64 times[], size_t n_inputs,
                         const fmi3ValueReference inputs[], const fmi3Float64 input_values[], size_t n_outputs,
                         const fmi3ValueReference outputs[], fmi3Float64 output_values[])
{
    Instance *m = c;
    for (size_t i = 0; i < n; i++) {
        const double *row = input_values + i * n_inputs;
        if (i) {
            const double start = times[i - 1], size = times[i] - start;
            for (size_t k = 0; k < n_inputs; k++)
                m->state.input_derivatives[inputs[k] - FIRST_INPUT] = (row[k] - row[k - n_inputs]) / size;
            if (instance_do_step(m, __func__, start, size) != OK)
                return i;
        }
        if (instance_set_values(m, __func__, inputs, n_inputs, row) != OK ||
            instance_get_values(m, __func__, outputs, n_outputs, output_values + i * n_outputs) != OK)
            return i;
    }
    return n;
}
