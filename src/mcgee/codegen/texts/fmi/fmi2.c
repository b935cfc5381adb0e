/* FMI 2.0, model exchange and co-simulation: what an importer calls. */

#include "fmu_model.h"

#if !defined(FMI2_FUNCTION_PREFIX) && !defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define FMI2_FUNCTION_PREFIX FUNCTION_PREFIX
#endif
#include "fmi2Functions.h"

#define FMI(name) fmi2##name

typedef struct {
    fmi2CallbackLogger log;
    fmi2ComponentEnvironment environment;
    char name[128];
} Listener;

#include "fmu.h"
#include "fmu_motion.h"

/* The standard says what is passed, and some of it is of no use here. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

static void report(const Instance *m, Status status, const char *category, const char *text)
{
    if (m->listener.log) {
        const Listener *to = &m->listener;
        to->log(to->environment, to->name, status, category, text); /* texts are without % and # */
    }
}

/* -- instances --------------------------------------------------------------------------------- */

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

/* Errors are told whatever loggingOn says, which is about debugging. */
fmi2Component fmi2Instantiate(
    fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
    const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn)
{
    Listener listener = {NULL, NULL, ""};
    if (functions) {
        listener.log = functions->logger;
        listener.environment = functions->componentEnvironment;
    }
    if (instanceName) {
        snprintf(listener.name, sizeof listener.name, "%s", instanceName);
    }
    const int kind = fmuType == fmi2ModelExchange ? MODEL_EXCHANGE : CO_SIMULATION;
    return create(&listener, TELL_ALL, __func__, instanceName, fmuGUID, kind);
}

void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}

fmi2Status fmi2SetDebugLogging(
    fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[])
{
    CALL(c, ANY)
    return set_logging(m, loggingOn, nCategories, categories);
}

/* -- modes ------------------------------------------------------------------------------------- */

fmi2Status fmi2SetupExperiment(
    fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
    fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    CALL(c, INSTANTIATED)
    return set_time(m, startTime);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    CALL(c, INSTANTIATED)
    return enter(m, INITIALIZATION);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    CALL(c, INITIALIZATION)
    return initialized(m);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    CALL(c, EVENT | CONTINUOUS | STEP)
    return enter(m, TERMINATED);
}

fmi2Status fmi2Reset(fmi2Component c)
{
    CALL(c, ANY)
    start(&m->now);
    return fmi2OK;
}

fmi2Status fmi2EnterEventMode(fmi2Component c)
{
    CALL(c, EVENT | CONTINUOUS)
    return enter(m, EVENT);
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c)
{
    CALL(c, EVENT)
    return enter(m, CONTINUOUS);
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *fmi2eventInfo)
{
    static const fmi2EventInfo nothing;
    CALL(c, EVENT)
    if (!fmi2eventInfo) {
        return null(m);
    }
    *fmi2eventInfo = nothing;
    return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(
    fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint, fmi2Boolean *enterEventMode,
    fmi2Boolean *terminateSimulation)
{
    CALL(c, CONTINUOUS)
    if (!enterEventMode || !terminateSimulation) {
        return null(m);
    }
    *enterEventMode = *terminateSimulation = fmi2False;
    return fmi2OK;
}

/* -- variables --------------------------------------------------------------------------------- */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    CALL(c, ANY & ~INSTANTIATED)
    return get(m, vr, nvr, value);
}

fmi2Status fmi2SetReal(
    fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    CALL(c, ANY)
    return set(m, vr, nvr, value);
}

#define NONE(Type)                                                                      \
    fmi2Status fmi2Get##Type(                                                           \
        fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2##Type value[]) \
    {                                                                                   \
        CALL(c, ANY)                                                                    \
        return none(m, nvr);                                                            \
    }                                                                                   \
    fmi2Status fmi2Set##Type(                                                           \
        fmi2Component c, const fmi2ValueReference vr[], size_t nvr,                     \
        const fmi2##Type value[])                                                       \
    {                                                                                   \
        CALL(c, ANY)                                                                    \
        return none(m, nvr);                                                            \
    }

NONE(Integer)
NONE(Boolean)
NONE(String)

/* -- copies of the state ----------------------------------------------------------------------- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    CALL(c, ANY)
    return save(m, FMUstate);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    CALL(c, ANY)
    return restore(m, FMUstate);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    CALL(c, ANY)
    return release(FMUstate);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    CALL(c, ANY)
    return serialized_size(m, FMUstate, size);
}

fmi2Status fmi2SerializeFMUstate(
    fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    CALL(c, ANY)
    return serialize(m, FMUstate, serializedState, size);
}

fmi2Status fmi2DeSerializeFMUstate(
    fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate)
{
    CALL(c, ANY)
    return deserialize(m, serializedState, size, FMUstate);
}

/* -- model exchange ---------------------------------------------------------------------------- */

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time)
{
    CALL(c, EVENT | CONTINUOUS)
    return set_time(m, time);
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx)
{
    CALL(c, CONTINUOUS)
    return set_states(m, x, nx);
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx)
{
    CALL(c, CALCULABLE)
    return get_states(m, x, nx);
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx)
{
    CALL(c, CALCULABLE)
    return get_derivatives(m, derivatives, nx);
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni)
{
    CALL(c, CALCULABLE)
    return holds(m, eventIndicators, ni, 0) ? fmi2OK : fmi2Error;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx)
{
    CALL(c, ANY)
    return get_nominals(m, x_nominal, nx);
}

/* -- co-simulation ----------------------------------------------------------------------------- */

fmi2Status fmi2DoStep(
    fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
    fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    CALL(c, STEP)
    return advance(m, currentCommunicationPoint, communicationStepSize);
}

/* To be asked for after a step was discarded; then the simulation cannot go on. */
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    CALL(c, STEP | TERMINATED)
    if (s != fmi2Terminated) {
        return refused(m, fmi2Error, "this status is not known");
    }
    if (!value) {
        return null(m);
    }
    *value = m->discarded;
    return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    CALL(c, STEP | TERMINATED)
    if (s != fmi2LastSuccessfulTime) {
        return refused(m, fmi2Error, "this status is not known");
    }
    if (!value) {
        return null(m);
    }
    *value = m->now.value[TIME];
    return fmi2OK;
}

/* -- what this FMU does not offer, as modelDescription.xml says -------------------------------- */

#define WITHOUT(function, arguments)                                  \
    fmi2Status function arguments                                     \
    {                                                                 \
        CALL(c, ANY)                                                  \
        return refused(m, fmi2Error, "this FMU does not offer that"); \
    }

WITHOUT(fmi2GetDirectionalDerivative, (
    fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
    const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
    fmi2Real dvUnknown[]))
WITHOUT(fmi2SetRealInputDerivatives, (
    fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
    const fmi2Real value[]))
WITHOUT(fmi2GetRealOutputDerivatives, (
    fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
    fmi2Real value[]))
WITHOUT(fmi2CancelStep, (fmi2Component c))
WITHOUT(fmi2GetStatus, (fmi2Component c, const fmi2StatusKind s, fmi2Status *value))
WITHOUT(fmi2GetIntegerStatus, (fmi2Component c, const fmi2StatusKind s, fmi2Integer *value))
WITHOUT(fmi2GetStringStatus, (fmi2Component c, const fmi2StatusKind s, fmi2String *value))
