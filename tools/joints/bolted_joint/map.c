/* Contact pressure for the page of the laboratory: position x, y [m], share of the area [1] and pressure [Pa] of each
 * node at the present inputs. */
#include "instance.h"
#include "tabulated_joint.h"

enum { MAX_MAP_NODES = sizeof ((JointModel *)0)->weight / sizeof *((JointModel *)0)->weight };

static int n_map_nodes; /* in the map */

__attribute__((visibility("default"))) int lab_map_size(void)
{
    return n_map_nodes;
}

/* Map as rows of four numbers; NULL: the joint refuses the inputs. */
__attribute__((visibility("default"))) const double *lab_map(Instance *m)
{
    static double map[MAX_MAP_NODES][4];
    if (instance_evaluate(m) != OK)
        return NULL;
    const double *inputs = m->state.values + FIRST_INPUT;
    const JointModel *model = &m->joint->model;
    n_map_nodes = 0;
    for (int i = 0; i < MAX_MAP_NODES && model->weight[i][0] > 0.0; i++) {
        double *node = map[n_map_nodes++];
        node[2] = model->weight[i][0];
        node[0] = model->weight[i][1] / node[2];
        node[1] = model->weight[i][2] / node[2];
        const double opening =
            inputs[INPUT_S_REL_Z] + inputs[INPUT_THETA_X] * node[1] - inputs[INPUT_THETA_Y] * node[0];
        curve_evaluate(&m->joint->curve, model->start[i] - opening, 0, &node[3]);
    }
    return map[0];
}
