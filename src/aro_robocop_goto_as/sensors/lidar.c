/* The errors of lidars: exact distances -> ranges. */

#include <math.h>
#include <stdint.h>

struct lidar {
    double range_min, range_max; /* [m] */
    double noise, resolution;    /* [m] standard deviation; ranges are whole multiples of it, 0: exact */
    double too_near, no_return;  /* [m] what is reported in these cases */
    double *normals;             /* (samples,) written by aro_measure */
    int64_t samples;
    int64_t n_accuracy;          /* 0: the noise is normal, else its bounds come from a data sheet: */
    const double *accuracy;      /* (n_accuracy, 3): up to which distance [m], error [m], error as a share of it */
};

/* What the noise depends on. */
struct episode {
    uint64_t seed, step;
};

/* Steele, Lea and Flood, "Fast splittable pseudorandom number generators" (2014): SplitMix64. */
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static uint64_t next(uint64_t *state) { return mix(*state += UINT64_C(0x9e3779b97f4a7c15)); }

/* Uniform from -1 to 1. */
static double uniform(uint64_t *state) { return (double)(next(state) >> 11) * 0x1p-52 - 1.0; }

/* Standard normal numbers (n,), always the same for a seed, stream and step; by Marsaglia's polar method. */
void aro_normals(uint64_t seed, uint64_t stream, uint64_t step, int64_t n, double *normals)
{
    uint64_t state = seed;
    int64_t i;
    state = next(&state) ^ stream;
    state = next(&state) ^ step;
    state = next(&state);
    for (i = 0; i < n; i += 2) {
        double x, y, squared, factor;
        do {
            x = uniform(&state);
            y = uniform(&state);
            squared = x * x + y * y;
        } while (squared >= 1.0 || squared == 0.0);
        factor = sqrt(-2.0 * log(squared) / squared);
        normals[i] = x * factor;
        if (i + 1 < n)
            normals[i + 1] = y * factor;
    }
}

/* The error [m] at a distance [m]; a data sheet's accuracy is taken as two sigma and as the maximum. */
static double error_at(const struct lidar *lidar, double distance, double normal)
{
    const double *entry = lidar->accuracy, *last = entry + 3 * (lidar->n_accuracy - 1);
    if (lidar->n_accuracy == 0)
        return lidar->noise * normal;
    while (entry < last && distance > entry[0])
        entry += 3;
    return (entry[1] + entry[2] * fmin(distance, lidar->range_max)) * fmax(-1.0, fmin(1.0, normal / 2.0));
}

/* Make ranges of the exact distances [m; +inf: no return] in these robots' rows of `ranges` (n, samples) [m]. The noise
 * of a robot on a step does not depend on the other robots. */
void aro_measure(const struct lidar *lidar, int64_t n_scans, const int64_t *robots, const struct episode *at,
                 double *ranges)
{
    int64_t i, k;
    for (i = 0; i < n_scans; i++) {
        double *row = ranges + robots[i] * lidar->samples;
        aro_normals(at->seed, (uint64_t)robots[i], at->step, lidar->samples, lidar->normals);
        for (k = 0; k < lidar->samples; k++) {
            double range = row[k] + error_at(lidar, row[k], lidar->normals[k]);
            if (range < lidar->range_min)
                row[k] = lidar->too_near;
            else if (range > lidar->range_max)
                row[k] = lidar->no_return;
            else
                row[k] = lidar->resolution > 0.0 ? rint(range / lidar->resolution) * lidar->resolution : range;
        }
    }
}
