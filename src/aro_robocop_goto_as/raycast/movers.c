/* Circles that move as the world's file says; mirrored in movers.py, ARO_CASTER_VERSION changes with it. */

#include <math.h>
#include <stdint.h>

#define TURN 6.283185307179586 /* [rad] */

/* A circle that is fixed to a model whose motion is a function of time. */
struct mover {
    double x, y, yaw;    /* [m], [rad] world_from_model at time zero */
    double turn;         /* [rad/s] about the model's origin */
    double at_x, at_y;   /* [m] the circle's centre in the model's frame */
    int64_t n_stops;     /* 0: it does not travel */
    const double *stops; /* (n_stops, 3) time [s], x, y [m] in the model's frame at time zero; from 0 to the cycle's end */
    double *circle;      /* (2,) the centre in the world [m] */
};

/* Displacement x, y [m] of a model's origin since time zero, in its frame at time zero. */
static void shift(const struct mover *mover, double time, double *x, double *y)
{
    const double *stop = mover->stops + 3;
    double share;
    *x = *y = 0.0;
    if (mover->n_stops == 0)
        return;
    time = fmod(time, mover->stops[3 * (mover->n_stops - 1)]);
    while (stop[0] <= time)
        stop += 3;
    share = (time - stop[-3]) / (stop[0] - stop[-3]);
    *x = stop[-2] + share * (stop[1] - stop[-2]);
    *y = stop[-1] + share * (stop[2] - stop[-1]);
}

/* Put n circles where they are at a time of at least 0 [s]; returns the largest distance that one has moved [m]. */
double aro_move(const struct mover *movers, int64_t n, double time)
{
    double farthest = 0.0;
    int64_t i;
    for (i = 0; i < n; i++) {
        const struct mover *mover = movers + i;
        double x, y, c = cos(mover->yaw), s = sin(mover->yaw), yaw, before_x = mover->circle[0];
        double before_y = mover->circle[1];
        shift(mover, time, &x, &y);
        yaw = remainder(mover->yaw + remainder(mover->turn * time, TURN), TURN);
        mover->circle[0] = mover->x + c * x - s * y + cos(yaw) * mover->at_x - sin(yaw) * mover->at_y;
        mover->circle[1] = mover->y + s * x + c * y + sin(yaw) * mover->at_x + cos(yaw) * mover->at_y;
        farthest = fmax(farthest, hypot(mover->circle[0] - before_x, mover->circle[1] - before_y));
    }
    return farthest;
}
