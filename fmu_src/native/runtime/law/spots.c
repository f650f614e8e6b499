/* Repeats `largest_spot` of the package for a single pressure; the law in it is generated. */
#include "spots.h"

#include <math.h>

_Static_assert(N_LAW_HEAD == 5, "the members of Spots that spots_begin reads");

int spots_regime(const Spots *spots, double u)
{
    int k = 0;
    while (k < N_LAW_SWITCHES && u > spots->switches[k])
        k++;
    return k;
}

static void load(const Spots *spots, const double *c, double u, double *y)
{
    law_load[spots_regime(spots, u)](&u, c, y);
}

void spots_table(const Spots *spots, const double *c, double u, double *y)
{
    law_table[spots_regime(spots, u)](&u, c, y);
}

static void sort_ends(Spots *spots, const double *given)
{
    spots->n_ends = 0;
    for (int i = 0; i < N_LAW_ENDS; i++) {
        int place = 0;
        while (place < spots->n_ends && spots->ends[place] < given[i])
            place++;
        if (place < spots->n_ends && spots->ends[place] == given[i])
            continue;
        for (int j = spots->n_ends++; j > place; j--)
            spots->ends[j] = spots->ends[j - 1];
        spots->ends[place] = given[i];
    }
}

bool spots_begin(Spots *spots, const double *c, Text *why)
{
    double head[N_LAW_HEAD], ends[N_LAW_ENDS], log_load[2], table[N_LAW_TABLE];
    law_head(0, c, head);
    spots->area = head[0];
    spots->hardness = head[1];
    spots->reference = head[2];
    spots->m = head[3];
    spots->onset = head[4];
    law_switches(0, c, spots->switches);
    law_ends(0, c, ends);
    sort_ends(spots, ends);
    bool good = isfinite(spots->reference) && spots->reference > 0.0 && isfinite(1.0 / spots->reference);
    const double at[] = {MIN_LOG_AREA, 0.0, MAX_LOG_AREA};
    for (int i = 0; i < 3; i++) {
        load(spots, c, at[i], log_load);
        spots_table(spots, c, at[i], table);
        good = good && isfinite(log_load[0]) && isfinite(log_load[1]) && isfinite(table[0]);
        if (i == 0)
            spots->least = log_load[0];
        spots->most = log_load[0];
    }
    if (!good)
        text_print(why,
                   "the parameters give a reference area of %g m2 or a load that is not representable; "
                   "check D (close to the end of its interval?) and extreme values of G, h and others",
                   spots->reference);
    return good;
}

bool spots_solve(const Spots *spots, const double *c, double pressure, double *u, double *slope, Text *why)
{
    const double target = same_log(pressure * spots->area);
    if (!(target >= spots->least && target <= spots->most)) {
        text_print(why,
                   "pressure = %g Pa is outside [%.3g, %.3g]: its largest spot is not representable "
                   "beside the critical area %.3g m2 of this surface",
                   pressure, same_exp(spots->least) / spots->area, same_exp(spots->most) / spots->area,
                   spots->reference);
        return false;
    }
    double x = *u, low = -INFINITY, high = INFINITY, y[2] = {0.0, 1.0};
    for (int k = 0; k < MAX_ITERATIONS; k++) {
        load(spots, c, x, y);
        const double rest = target - y[0];
        const double a = rest / (MIN_LOAD_SLOPE * spots->m), b = rest / MAX_LOAD_SLOPE;
        const double least = fmin(a, b), most = fmax(a, b);
        const double step = fmin(fmax(rest / y[1], least), most);
        low = fmax(low, x + least);
        high = fmin(high, x + most);
        x = fmin(fmax(x + step, low), high);
        if (fabs(rest) <= NEWTON_TOLERANCE) {
            *u = x;
            *slope = y[1];
            return true;
        }
    }
    text_print(why, "the inversion of the pressure %g Pa did not converge", pressure);
    return false;
}
