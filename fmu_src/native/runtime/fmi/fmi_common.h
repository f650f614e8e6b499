/* FMI functions that are the same in FMI 2.0 and 3.0. fmi2.c and fmi3.c include this file; before, they define
 * FMI(Name), the name with the prefix of the version, and the types Component and Real. */
#ifndef JOINTFMU_FMI_COMMON_H
#define JOINTFMU_FMI_COMMON_H

#include "instance.h"

/* FMI status of a call; fmi2Status and fmi3Status have the numbers of Status. */
#define STATUS(call) ((FMI(Status))(call))

/* Define an FMI function that consists of one call for the instance c. */
#define FMI_FUNCTION(name, parameters, call) \
    FMI(Status) name parameters              \
    {                                        \
        return STATUS(call);                 \
    }

/* false, with an error message, if a pointer argument of the host is NULL. */
#define CHECK_POINTER(pointer) instance_check_pointer(c, __func__, #pointer, pointer)

const char *FMI(GetVersion)(void)
{
    return FMI(Version);
}

void FMI(FreeInstance)(Component c)
{
    instance_free(c);
}

FMI_FUNCTION(FMI(SetDebugLogging), (Component c, FMI(Boolean) on, size_t n, const FMI(String) categories[]),
             instance_set_log_categories(c, __func__, on != FMI(False), n, categories))
FMI_FUNCTION(FMI(ExitInitializationMode), (Component c), instance_initialize(c, __func__))
FMI_FUNCTION(FMI(Reset), (Component c), instance_reset_if_allowed(c, __func__))

/* Model exchange: there are no event indicators; only bodies and systems have continuous states */

FMI(Status)
FMI(CompletedIntegratorStep)(Component c, FMI(Boolean) noSetFMUStatePriorToCurrentPoint, FMI(Boolean) * enterEventMode,
                             FMI(Boolean) * terminateSimulation)
{
    (void)noSetFMUStatePriorToCurrentPoint;
    if (!instance_check_mode(c, __func__, MODEL_EXCHANGE | CONTINUOUS_TIME) || !CHECK_POINTER(enterEventMode) ||
        !CHECK_POINTER(terminateSimulation))
        return STATUS(ERROR);
    *enterEventMode = *terminateSimulation = FMI(False);
    return STATUS(N_HISTORY ? instance_accept_inputs(c) : OK);
}

FMI_FUNCTION(FMI(EnterContinuousTimeMode), (Component c),
             instance_enter_mode(c, __func__, MODEL_EXCHANGE | EVENT, CONTINUOUS_TIME))
FMI_FUNCTION(FMI(SetTime), (Component c, Real time), instance_set_time(c, __func__, time))
FMI_FUNCTION(FMI(SetContinuousStates), (Component c, const Real x[], size_t nx),
             instance_set_continuous_states(c, __func__, x, nx))
FMI_FUNCTION(FMI(GetContinuousStates), (Component c, Real x[], size_t nx),
             instance_get_continuous_states(c, __func__, x, nx))
FMI_FUNCTION(FMI(GetEventIndicators), (Component c, Real indicators[], size_t ni),
             ((void)indicators, instance_check_empty(c, __func__, MODEL_EXCHANGE | READABLE, "event indicators", ni)))

#endif
