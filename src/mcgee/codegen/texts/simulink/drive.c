/* Calls an S-function as Simulink's engine does, on the rows of its vectors. */
#include S_FUNCTION_FILE

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define TOLERANCE 32

static void refuse(const char *why)
{
    fprintf(stderr, "%s\n", why);
    exit(2);
}

static double *numbers(int count)
{
    double *made = calloc((size_t)(count > 0 ? count : 1), sizeof *made);
    if (!made) {
        refuse("no memory");
    }
    return made;
}

/* The number at (i, j) of a port lies where Simulink's matrices have it. */
static double worse(double worst, const SimStruct *S, int k, const double *want, double scale)
{
    const int rows = S->output_rows[k], columns = S->output_columns[k];
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) {
            const double got = S->output[k][j*rows + i];
            const double error = fabs(got - want[i*columns + j])/(scale*DBL_EPSILON);
            worst = error <= worst ? worst : error == error ? error : HUGE_VAL;
        }
    }
    return worst;
}

static double tried(SimStruct *S, const double *row, int count, double worst)
{
    for (int k = 0; k < S->inputs; ++k) {
        S->input[k] = row;
        row += S->input_width[k];
    }
    for (int k = 0; k < count; ++k) {
        S->param[0].values[k] = *row++;
    }
    mdlOutputs(S, 0);
    const double *scales = row;
    for (int k = 0; k < S->outputs; ++k) {
        scales += S->output_rows[k]*S->output_columns[k];
    }
    for (int k = 0; k < S->outputs; ++k) {
        worst = worse(worst, S, k, row, scales[k]);
        row += S->output_rows[k]*S->output_columns[k];
    }
    return worst;
}

int main(void)
{
    static SimStruct first, sim;
    FILE *file = fopen("vectors/" VECTORS ".txt", "r");
    if (!file) {
        refuse("cannot read vectors/" VECTORS ".txt");
    }
    first.given_params = -1;
    mdlInitializeSizes(&first); /* says only how many parameters there are */
    mxArray params = {NULL, 0};
    sim.given_params = first.params;
    sim.param = &params;
    mdlInitializeSizes(&sim);
    if (!first.params == (sim.error != NULL)) {
        refuse("an empty vector is taken for the parameters");
    }
    while (sim.error) {
        sim.error = NULL;
        ++params.count;
        mdlInitializeSizes(&sim);
    }
    mdlInitializeSampleTimes(&sim);
    const int count = (int)params.count;
    params.values = numbers(count);
    int width = sim.outputs + count;
    for (int k = 0; k < sim.inputs; ++k) {
        width += sim.input_width[k];
    }
    for (int k = 0; k < sim.outputs; ++k) {
        const int size = sim.output_rows[k]*sim.output_columns[k];
        width += size;
        sim.output[k] = numbers(size);
    }
    double *row = numbers(width), worst = 0;
    int rows = 0, read = 1;
    while (read) {
        int i = 0;
        while (i < width && fscanf(file, "%lf", row + i) == 1) {
            ++i;
        }
        if (i > 0 && i < width) {
            refuse("a row is not as long as it should be");
        }
        read = i == width;
        if (read) {
            worst = tried(&sim, row, count, worst);
            ++rows;
        }
    }
    const int whole = feof(file);
    fclose(file);
    mdlTerminate(&sim);
    printf("%s: %d states, largest error %.3g ulp\n", VECTORS, rows, worst);
    return !(rows > 0 && whole && worst <= TOLERANCE);
}
