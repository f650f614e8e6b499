/* The outputs of an instance: tables for its parameters, checks of its inputs, the law. */
#ifndef JOINTFMU_EVALUATE_H
#define JOINTFMU_EVALUATE_H

#include "instance.h"

/* Make the outputs right for the present inputs and parameters; reports a refusal and gives ERROR. */
Status instance_evaluate(Instance *m);

#endif
