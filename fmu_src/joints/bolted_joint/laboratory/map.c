/* The contact pressure for the page: of each node its place x, y [m], its share of the area and its pressure [Pa]
 * at the present inputs. */
#include "tabulated.h"
#include "values.h"

__attribute__((visibility("default"))) int lab_map_size(void)
{
    return N_NODES;
}

/* NULL: refused. */
__attribute__((visibility("default"))) const double *lab_map(Instance *m)
{
    enum { S_REL_Z = 4, THETA_X = 8, THETA_Y };
    static double map[N_NODES][4];
    if (instance_evaluate(m) != OK)
        return NULL;
    const double *inputs = m->now.values + FIRST_INPUT;
    for (int i = 0; i < N_NODES; i++) {
        const double x = NODES[i][PLACE_X], y = NODES[i][PLACE_Y];
        const double apart = inputs[S_REL_Z] + inputs[THETA_X] * y - inputs[THETA_Y] * x;
        map[i][0] = x;
        map[i][1] = y;
        map[i][2] = NODES[i][SHARE];
        curve_at(&m->joint->curve, m->joint->kind.start[i] - apart, 0, &map[i][3]);
    }
    return map[0];
}
