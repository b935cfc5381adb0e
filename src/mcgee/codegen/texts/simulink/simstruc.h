/* What an S-function of ours sees of Simulink, enough to compile one and call it. Not Simulink's
 * own header, which comes with MATLAB: the names and what they do are those of its documentation. */
#ifndef SIMSTRUC_H
#define SIMSTRUC_H

#include <stddef.h>

typedef double real_T;
typedef int int_T;

typedef struct mxArray {
    double *values;
    size_t count;
} mxArray;

#define PORTS 8

typedef struct SimStruct {
    int params, given_params;
    const mxArray *param;
    int inputs, outputs, states, sample_times;
    int input_width[PORTS], feeds_through[PORTS], contiguous[PORTS];
    int output_rows[PORTS], output_columns[PORTS];
    const real_T *input[PORTS];
    real_T *output[PORTS];
    double sample_time, offset_time;
    unsigned options;
    const char *error;
} SimStruct;

#define INHERITED_SAMPLE_TIME (-1.0)
#define SS_OPTION_EXCEPTION_FREE_CODE 1u

#define ssSetNumSFcnParams(S, n) ((S)->params = (n))
#define ssGetNumSFcnParams(S) ((S)->params)
#define ssGetSFcnParamsCount(S) ((S)->given_params)
#define ssGetSFcnParam(S, k) ((S)->param + (k))
#define ssSetNumContStates(S, n) ((S)->states += (n))
#define ssSetNumDiscStates(S, n) ((S)->states += (n))
#define ssSetNumInputPorts(S, n) ((S)->inputs = (n), (n) <= PORTS)
#define ssSetInputPortWidth(S, k, n) ((S)->input_width[k] = (n))
#define ssSetInputPortRequiredContiguous(S, k, yes) ((S)->contiguous[k] = (yes))
#define ssSetInputPortDirectFeedThrough(S, k, yes) ((S)->feeds_through[k] = (yes))
#define ssSetNumOutputPorts(S, n) ((S)->outputs = (n), (n) <= PORTS)
#define ssSetOutputPortWidth(S, k, n) \
    ((S)->output_rows[k] = (n), (S)->output_columns[k] = 1)
#define ssSetOutputPortMatrixDimensions(S, k, m, n) \
    ((S)->output_rows[k] = (m), (S)->output_columns[k] = (n))
#define ssSetNumSampleTimes(S, n) ((S)->sample_times = (n))
#define ssSetSampleTime(S, k, t) ((void)(k), (S)->sample_time = (t))
#define ssSetOffsetTime(S, k, t) ((void)(k), (S)->offset_time = (t))
#define ssSetOptions(S, o) ((S)->options = (o))
#define ssGetInputPortRealSignal(S, k) ((S)->input[k])
#define ssGetOutputPortRealSignal(S, k) ((S)->output[k])
#define ssSetErrorStatus(S, text) ((S)->error = (text))
#define ssGetErrorStatus(S) ((S)->error)

#define mxGetPr(a) ((a)->values)
#define mxIsDouble(a) ((a) != NULL)
#define mxIsComplex(a) ((void)(a), 0)
#define mxGetNumberOfElements(a) ((a)->count)

#endif
