/* Base controllers: the newest command -> command timeout, acceleration limits -> wheel speed targets; and arcs. */

#include <math.h>

#include "fleet.h"

#define TURN 6.283185307179586 /* [rad] */

int aro_fleet_version(void) { return ARO_FLEET_VERSION; }

double aro_wrap(double angle) { return remainder(angle, TURN); }

void aro_arc(double heading, double length, double turn, double *dx, double *dy)
{
    double half = turn / 2.0, chord = length * (half != 0.0 ? sin(half) / half : 1.0);
    *dx = chord * cos(heading + half);
    *dy = chord * sin(heading + half);
}

/* The value moved towards the target by at most `step`. */
static double approach(double value, double target, double step)
{
    double change = target - value;
    return fabs(change) <= step ? target : value + copysign(step, change);
}

int aro_control(const struct fleet *fleet, double now, double dt)
{
    int changed = 0;
    int64_t i;
    for (i = 0; i < fleet->n; i++) {
        const double *limits = fleet->limits + LIMITS * i, *command = fleet->commands + 2 * i;
        double *velocity = fleet->velocities + 2 * i, *target = fleet->targets + 2 * i;
        double radius = fleet->wheels[2 * i], separation = fleet->wheels[2 * i + 1], half;
        int in_force = !(limits[TIMEOUT] > 0.0 && limits[TIMEOUT] < now - fleet->commanded_at[i]);
        double v = in_force ? command[0] : 0.0, w = in_force ? command[1] : 0.0;
        if (v == velocity[0] && w == velocity[1])
            continue;
        velocity[0] = approach(velocity[0], v, limits[MAX_DV] * dt);
        velocity[1] = approach(velocity[1], w, limits[MAX_DW] * dt);
        half = velocity[1] * (separation / 2.0);
        target[0] = (velocity[0] - half) / radius;
        target[1] = (velocity[0] + half) / radius;
        changed = 1;
    }
    return changed;
}
