/* FMI 3.0, model exchange and co-simulation: what an importer calls. */

#include "fmu_model.h"

#ifndef FMI3_FUNCTION_PREFIX
#define FMI3_FUNCTION_PREFIX FUNCTION_PREFIX
#endif
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wstrict-prototypes" /* two callbacks of the standard have none */
#endif
#include "fmi3Functions.h"
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#define FMI(name) fmi3##name

typedef struct {
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
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
        m->listener.log(m->listener.environment, status, category, text); /* texts are without # */
    }
}

/* -- instances --------------------------------------------------------------------------------- */

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage)
{
    const Listener listener = {logMessage, instanceEnvironment};
    const unsigned told = loggingOn ? TELL_ALL : 0;
    return create(&listener, told, __func__, instanceName, instantiationToken, MODEL_EXCHANGE);
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
    fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
    size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate)
{
    const Listener listener = {logMessage, instanceEnvironment};
    const unsigned told = loggingOn ? TELL_ALL : 0;
    const int kind = eventModeUsed ? CO_SIMULATION_WITH_EVENTS : CO_SIMULATION;
    return create(&listener, told, __func__, instanceName, instantiationToken, kind);
}

void fmi3FreeInstance(fmi3Instance instance)
{
    free(instance);
}

fmi3Status fmi3SetDebugLogging(
    fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
    const fmi3String categories[])
{
    CALL(instance, ANY)
    return set_logging(m, loggingOn, nCategories, categories);
}

/* -- modes ------------------------------------------------------------------------------------- */

fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
    fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    CALL(instance, INSTANTIATED)
    set_time(m, startTime);
    return enter(m, INITIALIZATION);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    CALL(instance, INITIALIZATION)
    return initialized(m);
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    CALL(instance, CONTINUOUS | STEP)
    if (m->now.kind == CO_SIMULATION) {
        return refused(m, fmi3Error, "the instance was made without event mode");
    }
    return enter(m, m->now.kind == MODEL_EXCHANGE ? EVENT : STEP_EVENT);
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    CALL(instance, EVENT)
    return enter(m, CONTINUOUS);
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    CALL(instance, STEP_EVENT)
    return enter(m, STEP);
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    CALL(instance, EVENT | CONTINUOUS | STEP_EVENT | STEP)
    return enter(m, TERMINATED);
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    CALL(instance, ANY)
    start(&m->now);
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(
    fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
    fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
    fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined,
    fmi3Float64 *nextEventTime)
{
    fmi3Boolean *const happened[] = {
        discreteStatesNeedUpdate, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined};
    CALL(instance, EVENT | STEP_EVENT)
    for (int i = 0; i < 5; ++i) {
        if (!happened[i] || !nextEventTime) {
            return null(m);
        }
    }
    for (int i = 0; i < 5; ++i) {
        *happened[i] = fmi3False;
    }
    *nextEventTime = 0.0;
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(
    fmi3Instance instance, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
    fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
{
    CALL(instance, CONTINUOUS)
    if (!enterEventMode || !terminateSimulation) {
        return null(m);
    }
    *enterEventMode = *terminateSimulation = fmi3False;
    return fmi3OK;
}

/* -- variables --------------------------------------------------------------------------------- */

fmi3Status fmi3GetFloat64(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
    fmi3Float64 values[], size_t nValues)
{
    CALL(instance, ANY)
    if (!holds(m, values, nValues, nValueReferences)) {
        return fmi3Error;
    }
    return get(m, valueReferences, nValueReferences, values);
}

fmi3Status fmi3SetFloat64(
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
    const fmi3Float64 values[], size_t nValues)
{
    CALL(instance, ANY)
    if (!holds(m, values, nValues, nValueReferences)) {
        return fmi3Error;
    }
    return set(m, valueReferences, nValueReferences, values);
}

#define NONE(function, ...)                                                \
    fmi3Status function(                                                   \
        fmi3Instance instance, const fmi3ValueReference valueReferences[], \
        size_t nValueReferences, __VA_ARGS__)                              \
    {                                                                      \
        CALL(instance, ANY)                                                \
        return none(m, nValueReferences);                                  \
    }

#define NONE_OF(Type)                                        \
    NONE(fmi3Get##Type, fmi3##Type values[], size_t nValues) \
    NONE(fmi3Set##Type, const fmi3##Type values[], size_t nValues)

NONE_OF(Float32)
NONE_OF(Int8)
NONE_OF(UInt8)
NONE_OF(Int16)
NONE_OF(UInt16)
NONE_OF(Int32)
NONE_OF(UInt32)
NONE_OF(Int64)
NONE_OF(UInt64)
NONE_OF(Boolean)
NONE_OF(String)
NONE(fmi3GetBinary, size_t valueSizes[], fmi3Binary values[], size_t nValues)
NONE(fmi3SetBinary, const size_t valueSizes[], const fmi3Binary values[], size_t nValues)
NONE(fmi3GetClock, fmi3Clock values[])
NONE(fmi3SetClock, const fmi3Clock values[])
NONE(fmi3GetIntervalDecimal, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
NONE(fmi3GetIntervalFraction,
     fmi3UInt64 counters[], fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
NONE(fmi3GetShiftDecimal, fmi3Float64 shifts[])
NONE(fmi3GetShiftFraction, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NONE(fmi3SetIntervalDecimal, const fmi3Float64 intervals[])
NONE(fmi3SetIntervalFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
NONE(fmi3SetShiftDecimal, const fmi3Float64 shifts[])
NONE(fmi3SetShiftFraction, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])

/* -- copies of the state ----------------------------------------------------------------------- */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    CALL(instance, ANY)
    return save(m, FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    CALL(instance, ANY)
    return restore(m, FMUState);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    CALL(instance, ANY)
    return release(FMUState);
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    CALL(instance, ANY)
    return serialized_size(m, FMUState, size);
}

fmi3Status fmi3SerializeFMUState(
    fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    CALL(instance, ANY)
    return serialize(m, FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(
    fmi3Instance instance, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState)
{
    CALL(instance, ANY)
    return deserialize(m, serializedState, size, FMUState);
}

/* -- model exchange ---------------------------------------------------------------------------- */

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    CALL(instance, EVENT | CONTINUOUS)
    return set_time(m, time);
}

fmi3Status fmi3SetContinuousStates(
    fmi3Instance instance, const fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    CALL(instance, CONTINUOUS)
    return set_states(m, continuousStates, nContinuousStates);
}

fmi3Status fmi3GetContinuousStates(
    fmi3Instance instance, fmi3Float64 continuousStates[], size_t nContinuousStates)
{
    CALL(instance, CALCULABLE)
    return get_states(m, continuousStates, nContinuousStates);
}

fmi3Status fmi3GetContinuousStateDerivatives(
    fmi3Instance instance, fmi3Float64 derivatives[], size_t nContinuousStates)
{
    CALL(instance, CALCULABLE)
    return get_derivatives(m, derivatives, nContinuousStates);
}

fmi3Status fmi3GetEventIndicators(
    fmi3Instance instance, fmi3Float64 eventIndicators[], size_t nEventIndicators)
{
    CALL(instance, CALCULABLE)
    return holds(m, eventIndicators, nEventIndicators, 0) ? fmi3OK : fmi3Error;
}

fmi3Status fmi3GetNominalsOfContinuousStates(
    fmi3Instance instance, fmi3Float64 nominals[], size_t nContinuousStates)
{
    CALL(instance, ANY)
    return get_nominals(m, nominals, nContinuousStates);
}

static fmi3Status number(const Instance *m, size_t is, size_t *count)
{
    if (!count) {
        return null(m);
    }
    *count = is;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *nEventIndicators)
{
    CALL(instance, ANY)
    return number(m, 0, nEventIndicators);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *nContinuousStates)
{
    CALL(instance, ANY)
    return number(m, STATES, nContinuousStates);
}

/* -- co-simulation ----------------------------------------------------------------------------- */

fmi3Status fmi3DoStep(
    fmi3Instance instance, fmi3Float64 currentCommunicationPoint,
    fmi3Float64 communicationStepSize, fmi3Boolean noSetFMUStatePriorToCurrentPoint,
    fmi3Boolean *eventHandlingNeeded, fmi3Boolean *terminateSimulation,
    fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    CALL(instance, STEP)
    if (!eventHandlingNeeded || !terminateSimulation || !earlyReturn || !lastSuccessfulTime) {
        return null(m);
    }
    const Status status = advance(m, currentCommunicationPoint, communicationStepSize);
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    *lastSuccessfulTime = m->now.value[TIME];
    return status;
}

/* -- what this FMU does not offer, as modelDescription.xml says -------------------------------- */

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
    fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment instanceEnvironment,
    fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
    fmi3LockPreemptionCallback lockPreemption, fmi3UnlockPreemptionCallback unlockPreemption)
{
    if (loggingOn && logMessage) {
        const char *text = "this FMU does not offer scheduled execution";
        logMessage(instanceEnvironment, fmi3Error, "logStatusError", text);
    }
    return NULL;
}

#define WITHOUT(function, arguments)                                  \
    fmi3Status function arguments                                     \
    {                                                                 \
        CALL(instance, ANY)                                           \
        return refused(m, fmi3Error, "this FMU does not offer that"); \
    }

WITHOUT(fmi3EnterConfigurationMode, (fmi3Instance instance))
WITHOUT(fmi3ExitConfigurationMode, (fmi3Instance instance))
WITHOUT(fmi3EvaluateDiscreteStates, (fmi3Instance instance))
WITHOUT(fmi3ActivateModelPartition, (
    fmi3Instance instance, fmi3ValueReference clockReference, fmi3Float64 activationTime))
WITHOUT(fmi3GetNumberOfVariableDependencies, (
    fmi3Instance instance, fmi3ValueReference valueReference, size_t *nDependencies))
WITHOUT(fmi3GetVariableDependencies, (
    fmi3Instance instance, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
    fmi3ValueReference independents[], size_t elementIndicesOfIndependents[],
    fmi3DependencyKind dependencyKinds[], size_t nDependencies))
WITHOUT(fmi3GetDirectionalDerivative, (
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
    fmi3Float64 sensitivity[], size_t nSensitivity))
WITHOUT(fmi3GetAdjointDerivative, (
    fmi3Instance instance, const fmi3ValueReference unknowns[], size_t nUnknowns,
    const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
    fmi3Float64 sensitivity[], size_t nSensitivity))
WITHOUT(fmi3GetOutputDerivatives, (
    fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
    const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues))
