/* Wheel odometry of all robots: dead reckoning from what the wheel encoders count. */

#include <math.h>
#include <stddef.h>

#include "../robot/fleet.h"

struct odometers {
    int64_t n;
    const double *wheels; /* (n, 2) radius and separation [m] that odometry assumes */
    double *poses;        /* (n, 3) x, y [m], yaw [rad] of the footprint in odom */
    double *twists;       /* (n, 2) mean v [m/s], w [rad/s] since the update before */
    double *read;         /* (n, 2) encoder angles [rad] at the latest update, in whole multiples of the resolution */
    double *counted;      /* (n, 2) encoder angles [rad] */
    double *rolled;       /* (n, 2) true wheel angles [rad] at that time */
    double slip, resolution; /* relative overcount; of the encoders [rad], 0: exact */
};

/* Update all odometers at true wheel angles (n, 2) [rad], dt [s] after the last update. noise: (n, 2) standard normal; its
 * magnitude is used, as slip only adds to what an encoder counts. */
void aro_odometry(struct odometers *odometers, const double *wheel_angles, const double *noise, double dt)
{
    int64_t i;
    for (i = 0; i < odometers->n; i++) {
        double *pose = odometers->poses + 3 * i, travelled[2], distance, turn, dx, dy;
        double radius = odometers->wheels[2 * i], separation = odometers->wheels[2 * i + 1];
        int64_t k;
        for (k = 2 * i; k < 2 * i + 2; k++) {
            double angle = wheel_angles[k], read;
            if (odometers->slip > 0.0)
                angle = odometers->counted[k]
                        + (angle - odometers->rolled[k]) * (1.0 + odometers->slip * fabs(noise[k]));
            odometers->counted[k] = angle;
            odometers->rolled[k] = wheel_angles[k];
            read = odometers->resolution > 0.0 ? floor(angle / odometers->resolution) * odometers->resolution : angle;
            travelled[k - 2 * i] = (read - odometers->read[k]) * radius;
            odometers->read[k] = read;
        }
        distance = (travelled[0] + travelled[1]) / 2.0;
        turn = (travelled[1] - travelled[0]) / separation;
        aro_arc(pose[2], distance, turn, &dx, &dy);
        pose[0] += dx;
        pose[1] += dy;
        pose[2] = aro_wrap(pose[2] + turn);
        odometers->twists[2 * i] = distance / dt;
        odometers->twists[2 * i + 1] = turn / dt;
    }
}
