/* Joint with a tabulated curve of load over displacement. Its own folder defines JointModel: its other tables. */
#ifndef JOINTFMU_TABULATED_JOINT_H
#define JOINTFMU_TABULATED_JOINT_H

#include "curve.h"
#include "joint.h"
#include "joint_model.h" /* generated: includes the header that defines JointModel */
#include "law.h"
#include "variables.h"

struct Joint {
    const Data *data;
    double constants[N_CONSTANTS]; /* parameters, parameters that are no FMU variables, expressions of both */
    Curve curve;
    JointModel model;
};

/* Compute curve and model from the constants; the folder of the joint defines it. false: refused, with the reason. */
bool tabulate_model(Joint *joint, Text *reason);

/* Function that tabulates a curve with a number of steps. `refine_curve` calls it with more and more steps, until the
 * interpolation error is at most MAX_INTERPOLATION_ERROR. false: refused, with the reason. */
typedef bool (*TabulateFunction)(Joint *joint, int steps, Text *reason);
bool refine_curve(Joint *joint, TabulateFunction tabulate, int steps, Text *reason);

#endif
