/* The contact pressure for the page: of each node its place x, y [m], its share of the area and its pressure [Pa]
 * at the present inputs. */
#include "instance.h"
#include "tabulated.h"

enum { ROOM = sizeof ((Kind *)0)->weight / sizeof *((Kind *)0)->weight };

static int nodes; /* that are in the map */

__attribute__((visibility("default"))) int lab_map_size(void)
{
    return nodes;
}

/* NULL: refused. */
__attribute__((visibility("default"))) const double *lab_map(Instance *m)
{
    static double map[ROOM][4];
    if (instance_evaluate(m) != OK)
        return NULL;
    const double *inputs = m->now.values + FIRST_INPUT;
    const Kind *kind = &m->joint->kind;
    nodes = 0;
    for (int i = 0; i < ROOM && kind->weight[i][0] > 0.0; i++) {
        double *node = map[nodes++];
        node[2] = kind->weight[i][0];
        node[0] = kind->weight[i][1] / node[2];
        node[1] = kind->weight[i][2] / node[2];
        const double apart = inputs[INPUT_S_REL_Z] + inputs[INPUT_THETA_X] * node[1] - inputs[INPUT_THETA_Y] * node[0];
        curve_at(&m->joint->curve, kind->start[i] - apart, 0, &node[3]);
    }
    return map[0];
}
