/* Torque along a motion, in C: follow MODEL PERIOD MOTION
   MOTION is text, a line per sample: what to do before it (0 nothing, 1 reset, 2 pause), the clock of a reset (nan: not known) or the
   seconds of a pause, then q, qd, qdd and the torque that is expected, one value per joint each.
   Prints the largest difference as a part of the largest torque; exit status 1 above a millionth. */
#include <residyn.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int failed(residyn_model *model) {
    fprintf(stderr, "error: %s\n", residyn_last_error());
    residyn_free(model);
    return 2;
}

int main(int count, char **given) {
    if (count != 4) {
        fprintf(stderr, "usage: follow MODEL PERIOD MOTION\n");
        return 2;
    }
    residyn_model *model = NULL;
    size_t n = 0;
    if (residyn_load(given[1], atof(given[2]), &model) != RESIDYN_OK || residyn_joints(model, &n) != RESIDYN_OK) {
        return failed(model);
    }
    FILE *file = fopen(given[3], "r");
    double *row = malloc((2 + 4 * n) * sizeof *row);
    double *tau = malloc(n * sizeof *tau);
    if (file == NULL || row == NULL || tau == NULL) {
        fprintf(stderr, "error: %s cannot be read\n", given[3]);
        residyn_free(model);
        return 2;
    }
    double worst = 0.0, largest = 0.0;
    size_t samples = 0;
    for (;;) {
        size_t read = 0;
        while (read < 2 + 4 * n && fscanf(file, "%lf", &row[read]) == 1) {
            ++read;
        }
        if (read < 2 + 4 * n) {
            break;
        }
        residyn_code code = RESIDYN_OK;
        if (row[0] == 1.0) {
            code = residyn_reset(model, row[1]);
        } else if (row[0] == 2.0) {
            code = residyn_pause(model, row[1]);
        }
        const double *q = row + 2, *qd = q + n, *qdd = qd + n, *expected = qdd + n;
        uint32_t status = 0;
        if (code != RESIDYN_OK || residyn_torque(model, q, qd, qdd, tau, n, &status) != RESIDYN_OK) {
            return failed(model);
        }
        for (size_t j = 0; j < n; ++j) {
            worst = fmax(worst, fabs(tau[j] - expected[j]));
            largest = fmax(largest, fabs(expected[j]));
        }
        ++samples;
    }
    fclose(file);
    free(row);
    free(tau);
    residyn_free(model);
    printf("%zu samples of %zu joints, largest difference %.3e of the largest torque\n", samples, n, worst / largest);
    return samples > 0 && worst <= 1e-6 * largest ? 0 : 1;
}
