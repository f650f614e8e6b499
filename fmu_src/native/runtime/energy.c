#include "energy.h"

void energy_tabulate(Energy *energy, const Curve *curve)
{
    energy->at[0] = 0.0;
    for (int i = 0; i + 1 < curve->n; i++)
        energy->at[i + 1] = energy_inside(energy, curve, i, 1.0);
}
