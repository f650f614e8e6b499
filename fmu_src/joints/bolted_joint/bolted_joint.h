/* Repeats `BoltedJointSpring` of the package. Every point follows the curve of pressure over approach from its preload
 * state; friction acts on fewer patches, with history or without. */
#ifndef JOINTFMU_BOLTED_JOINT_H
#define JOINTFMU_BOLTED_JOINT_H

#include "bodies.h"
#include "bolts.h"
#include "contact.h"
#include "equilibrium.h"
#include "friction.h"
#include "outputs.h"

typedef struct {
    OutputSums sums;
    Bodies bodies;
    Bolts bolts;
    Contact contact;
    Friction friction;
    Equilibrium equilibrium; /* of elastic members */
} JointModel;

#endif
