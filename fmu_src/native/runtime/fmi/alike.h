/* Entry points that FMI 2.0 and 3.0 have alike: fmi2.c and fmi3.c include this file, and say before it by what name,
 * FMI(Name), theirs are called, and what their Component and Real are. */
#ifndef JOINTFMU_ALIKE_H
#define JOINTFMU_ALIKE_H

#include "instance.h"

/* The standards' statuses have the numbers of Status. */
#define STATUS(call) ((FMI(Status))(call))

/* An entry point that is one call for the instance c. */
#define ENTRY(name, parameters, call) \
    FMI(Status) name parameters       \
    {                                 \
        return STATUS(call);          \
    }

/* Whether a pointer of the host points anywhere. */
#define HAS(pointer) instance_has(c, __func__, #pointer, pointer)

const char *FMI(GetVersion)(void)
{
    return FMI(Version);
}

void FMI(FreeInstance)(Component c)
{
    instance_free(c);
}

ENTRY(FMI(SetDebugLogging), (Component c, FMI(Boolean) on, size_t n, const FMI(String) categories[]),
      instance_select_logs(c, __func__, on != FMI(False), n, categories))
ENTRY(FMI(ExitInitializationMode), (Component c), instance_initialize(c, __func__))
ENTRY(FMI(Reset), (Component c), instance_restart(c, __func__))

/* Model exchange: no event indicators, and states in systems only */

FMI(Status) FMI(CompletedIntegratorStep)(Component c, FMI(Boolean) noSetFMUStatePriorToCurrentPoint,
                                         FMI(Boolean) *enterEventMode, FMI(Boolean) *terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!instance_allows(c, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME) || !HAS(enterEventMode) ||
        !HAS(terminateSimulation))
        return STATUS(ERROR);
    *enterEventMode = *terminateSimulation = FMI(False);
    return STATUS(N_MEMORY ? instance_accept(c) : OK);
}

ENTRY(FMI(EnterContinuousTimeMode), (Component c),
      instance_change(c, __func__, MODEL_EXCHANGE | EVENT, CONTINUOUS_TIME))
ENTRY(FMI(SetTime), (Component c, Real time), instance_set_time(c, __func__, time))
ENTRY(FMI(SetContinuousStates), (Component c, const Real x[], size_t nx), instance_set_states(c, __func__, x, nx))
ENTRY(FMI(GetContinuousStates), (Component c, Real x[], size_t nx), instance_get_states(c, __func__, x, nx))
ENTRY(FMI(GetEventIndicators), (Component c, Real indicators[], size_t ni),
      ((void)indicators, instance_none(c, __func__, MODEL_EXCHANGE | READABLE, "event indicators", ni)))

#endif
