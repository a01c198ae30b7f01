/* All robots of a simulation, one row each. */
#ifndef ARO_FLEET_H
#define ARO_FLEET_H

#include <stdint.h>

/* Changes with each structure and function of the library that Python uses. */
#define ARO_FLEET_VERSION 3

/* Columns of limits, as in BaseLimits of base_controller.py */
enum { MAX_V, MAX_W, MAX_DV, MAX_DW, TIMEOUT, LIMITS };

struct fleet {
    int64_t n;
    const double *limits;  /* (n, LIMITS) [m/s], [rad/s], [m/s^2], [rad/s^2], [s] */
    const double *wheels;  /* (n, 2) radius, separation [m] */
    const double *radii;   /* (n,) [m] of the footprints */
    double *commands;      /* (n, 2) the newest command, within the velocity limits: v [m/s], w [rad/s] */
    double *commanded_at;  /* (n,) [s] simulated time at which it arrived */
    double *velocities;    /* (n, 2) v [m/s], w [rad/s] that the base controller has reached */
    double *targets;       /* (n, 2) wheel speeds [rad/s] that it asks for, left and right */
    double *poses;         /* (n, 3) x, y [m], yaw [rad] of the footprint in the world */
    double *twists;        /* (n, 2) true v [m/s], w [rad/s] in the footprint's frame */
    double *wheel_angles;  /* (n, 2) [rad], never wrapped */
    double *wheel_speeds;  /* (n, 2) [rad/s] */
};

/* Advance the base controllers of all robots by one step of dt [s] from `now` [s].
   Return whether any wheel speed target has changed. */
int aro_control(const struct fleet *fleet, double now, double dt);

/* Displacement dx, dy [m] along an arc of a length [m] from a heading [rad] to heading + turn. */
void aro_arc(double heading, double length, double turn, double *dx, double *dy);

/* The same angle [rad] within [-pi, pi]. */
double aro_wrap(double angle);

#endif
