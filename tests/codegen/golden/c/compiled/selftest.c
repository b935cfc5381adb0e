/* Compares planar_2r with the vectors; exits non-zero where one is missed. */
#include "planar_2r.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static FILE *opened(const char *folder, const char *name)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s.txt", folder, name);
    FILE *file = fopen(path, "r");
    if (!file) {
        fprintf(stderr, "cannot read %s\n", path);
        exit(2);
    }
    return file;
}

static int next(FILE *file, double *row, int width)
{
    int i = 0;
    while (i < width && fscanf(file, "%lf", row + i) == 1) {
        ++i;
    }
    if (i > 0 && i < width) {
        fprintf(stderr, "a row is not as long as it should be\n");
        exit(2);
    }
    return i == width;
}

static void read_row(double *to, const double *from, int size)
{
    for (int i = 0; i < size; ++i) {
        to[i] = (double)from[i];
    }
}

/* The largest error in units in the last place of the scale; infinite where a result is NaN. */
static double worse(double worst, const double *got, const double *want, int size, double scale)
{
    for (int i = 0; i < size; ++i) {
        const double error = fabs((double)got[i] - want[i])/(scale*(double)DBL_EPSILON);
        if (!(error <= worst)) {
            worst = error == error ? error : HUGE_VAL;
        }
    }
    return worst;
}

static int report(const char *name, FILE *file, int rows, double worst)
{
    const int ended = feof(file);
    fclose(file);
    printf("%s: %d states, largest error %.3g ulp\n", name, rows, worst);
    return !(rows > 0 && ended && worst <= 32);
}

static int test_dynamics(const char *folder)
{
    static double row[15];
    int rows = 0;
    double worst = 0;
    FILE *file = opened(folder, "dynamics");
    for (; next(file, row, 15); ++rows) {
        double q[2];
        read_row(q, row + 0, 2);
        double qdot[2];
        read_row(qdot, row + 2, 2);
        double M[4];
        double Cqdot[2];
        double g[2];
        planar_2r_dynamics(q, qdot, M, Cqdot, g);
        worst = worse(worst, M, row + 4, 4, row[12]);
        worst = worse(worst, Cqdot, row + 8, 2, row[13]);
        worst = worse(worst, g, row + 10, 2, row[14]);
    }
    return report("dynamics", file, rows, worst);
}

static int test_inverse_dynamics(const char *folder)
{
    static double row[9];
    int rows = 0;
    double worst = 0;
    FILE *file = opened(folder, "inverse_dynamics");
    for (; next(file, row, 9); ++rows) {
        double q[2];
        read_row(q, row + 0, 2);
        double qdot[2];
        read_row(qdot, row + 2, 2);
        double qddot[2];
        read_row(qddot, row + 4, 2);
        double tau[2];
        planar_2r_inverse_dynamics(q, qdot, qddot, tau);
        worst = worse(worst, tau, row + 6, 2, row[8]);
    }
    return report("inverse_dynamics", file, rows, worst);
}

int main(int count, char **words)
{
    const char *folder = count > 1 ? words[1] : "vectors";
    int failed = 0;
    failed += test_dynamics(folder);
    failed += test_inverse_dynamics(folder);
    return failed ? 1 : 0;
}
