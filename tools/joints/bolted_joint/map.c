/* Map of the contact pressure for the page. Rows of four numbers, one for each point: position x, y [m], share of the
 * area [1], pressure [Pa] at the present inputs. */
#include "instance.h"
#include "tabulated_joint.h"

static int row_count; /* rows that are in use */

__attribute__((visibility("default"))) int lab_map_size(void)
{
    return row_count;
}

/* NULL: the inputs are refused. */
__attribute__((visibility("default"))) const double *lab_map(Instance *m)
{
    static double map[MAX_POINTS][4];
    if (instance_evaluate(m, ERROR) != OK)
        return NULL;
    const double *inputs = m->state.values + FIRST_INPUT;
    const Contact *contact = &m->joint->model.contact;
    row_count = 0;
    for (int i = 0; i < MAX_POINTS && contact->weight[i][0] > 0.0; i++) {
        double *row = map[row_count++];
        row[2] = contact->weight[i][0];
        row[0] = contact->weight[i][1] / row[2];
        row[1] = contact->weight[i][2] / row[2];
        const double opening = inputs[INPUT_S_REL_Z] + inputs[INPUT_THETA_X] * row[1] - inputs[INPUT_THETA_Y] * row[0];
        curve_evaluate(&m->joint->curve, contact->preload.approach[i] - opening, 0, &row[3]);
    }
    return map[0];
}
