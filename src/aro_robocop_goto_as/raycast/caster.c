/* Exact distances along the beams of planar sensors to segments, circles and other robots.
 *
 * A shape is compared only with the beams between the bearings of its two edges. Of segments that are listed in tiles,
 * only those are compared whose tiles a beam passes through. Each distance depends on one beam and one shape only, and
 * a beam's result is their minimum, so results depend neither on the order of the shapes nor on which other sensors
 * are cast.
 */

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "tiles.h"

#define ARO_CASTER_VERSION 7   /* changes with each structure and function of the library that Python uses */
#define TURN 6.283185307179586 /* [rad] */
#define TOLERANCE 1e-9         /* [rad] a beam this close to a shape's edge hits it: none slips between two walls */
#define ROUGH 2e-5             /* [rad] the bearings between which beams are compared with a circle are wider by this */
#define CULL (1.0 + 1e-9)      /* rounding errors never put a shape beyond max_range */

#define BLOCK 2  /* tiles on each side of the sensor's whose segments are cast before beams are walked */

/* Status of aro_cast */
#define OK 0
#define NO_SUCH_ROBOT 1
#define POSE_NOT_FINITE 2

/* Beam i points at angle_min + i * increment [rad] in the sensor's frame; increment > 0. */
struct beams {
    double angle_min, per_angle; /* per_angle = 1 / increment */
    double end;                  /* [rad] a little more than from the first beam to the last */
    int64_t samples;
    const double *dx, *dy; /* (samples,) unit vectors */
};

/* What sensors at one height see. */
struct beam_plane {
    int64_t n_segments, n_circles, n_bodies;
    const double *segments; /* (n_segments, 2, 2) [m] in the world */
    const double *circles;  /* (n_circles, 3) x, y, radius [m] in the world */
    const double *bodies;   /* (n_bodies, 3) x, y, radius [m] of robots' circles, each in its robot's frame */
    const int64_t *owners;  /* (n_bodies,) the robot of each */
    double *moved_bodies;   /* (n_bodies, 3) in the world, written by aro_cast */
    struct tiles *tiles;    /* of the segments; NULL, or the sensor is outside of them: compare all segments */
};

struct beam_scene {
    int64_t n_robots, n_planes;
    const double *footprints;     /* (n_robots, 3) x, y [m], yaw [rad] in the world */
    const double *mounts;    /* (n_robots, 3) the sensor's pose in its robot's frame */
    const int64_t *plane_of; /* (n_robots,) */
    struct beam_plane *planes;
};

struct scan {
    const struct beams *beams;
    double x, y, c, s; /* the sensor's position [m], cosine and sine of its yaw */
    double max_range;  /* [m] */
    double *nearest;   /* (samples,) [m] */
};

int aro_caster_version(void) { return ARO_CASTER_VERSION; }

/* The beams from bearing low to low + span [rad], counted from the first beam; 0 for none. */
static inline int beams_between(const struct beams *beams, double low, double span, int64_t *first, int64_t *last)
{
    double most = (double)(beams->samples - 1), from = (low - TOLERANCE) * beams->per_angle;
    double to = (low + span + TOLERANCE) * beams->per_angle;
    if (!(from <= most && to >= 0.0))
        return 0;
    *first = from > 0.0 ? (int64_t)from : 0;
    *first += (double)*first < from;
    *last = to < most ? (int64_t)to : beams->samples - 1;
    return *first <= *last;
}

/* The least bearing [rad], counted from the first beam, from which bearings up to `span` more can meet a beam. */
static double first_bearing(const struct beams *beams, double bearing, double span)
{
    double angle = bearing - beams->angle_min;
    angle -= TURN * floor(angle / TURN);
    return angle + span + 2.0 * TOLERANCE >= TURN ? angle - TURN : angle;
}

static void to_sensor_frame(const struct scan *scan, const double *point, double *x, double *y)
{
    double dx = point[0] - scan->x, dy = point[1] - scan->y;
    *x = scan->c * dx + scan->s * dy;
    *y = scan->c * dy - scan->s * dx;
}

static void cast_segment(const struct scan *scan, const double *segment)
{
    const struct beams *beams = scan->beams;
    const double *dx = beams->dx, *dy = beams->dy;
    double *nearest = scan->nearest;
    double ax, ay, bx, by, ex, ey, length2, a2, b2, ahead, foot, near2, near, far, low, sweep;
    int64_t first, last, i;

    to_sensor_frame(scan, segment, &ax, &ay);
    to_sensor_frame(scan, segment + 2, &bx, &by);
    ex = bx - ax;
    ey = by - ay;
    length2 = ex * ex + ey * ey;
    if (length2 == 0.0)
        return;
    a2 = ax * ax + ay * ay;
    b2 = bx * bx + by * by;
    ahead = ax * ey - ay * ex;
    foot = -(ax * ex + ay * ey); /* of the perpendicular from the sensor, times length2 */
    near2 = foot <= 0.0 ? a2 : foot >= length2 ? b2 : ahead * ahead / length2;
    if (near2 > scan->max_range * scan->max_range * CULL)
        return;
    near = sqrt(near2);
    far = sqrt(a2 > b2 ? a2 : b2);

    low = atan2(ay, ax);
    sweep = atan2(by, bx) - low;
    if (sweep > TURN / 2.0)
        sweep -= TURN;
    else if (sweep < -TURN / 2.0)
        sweep += TURN;
    low = sweep >= 0.0 ? low : low + sweep;
    sweep = fabs(sweep);

    for (low = first_bearing(beams, low, sweep); low <= beams->end; low += TURN) {
        if (!beams_between(beams, low, sweep, &first, &last))
            continue;
#pragma omp simd
        for (i = first; i <= last; i++) {
            double distance = ahead / (dx[i] * ey - dy[i] * ex);
            /* Along a segment seen edge-on both terms vanish, and their quotient is arbitrary. */
            distance = distance > near ? distance : near;
            distance = distance < far ? distance : far;
            nearest[i] = distance < nearest[i] ? distance : nearest[i];
        }
    }
}

/* The bearing [rad] of a point, by at most ROUGH wrong; atan2 takes five times as long. The polynomial is 4.4.47 of
 * Abramowitz and Stegun, "Handbook of Mathematical Functions" (1964), for the arc tangent from 0 to 1. */
static double rough_bearing(double x, double y)
{
    double width = fabs(x), height = fabs(y);
    double ratio = (width < height ? width : height) / (width > height ? width : height), r2 = ratio * ratio;
    double angle = ratio * (0.9998660 + r2 * (-0.3302995 + r2 * (0.1801410 + r2 * (-0.0851330 + r2 * 0.0208351))));
    /* Without branches, which processors would guess wrong: mirrored at the diagonal and at both axes. */
    angle = TURN / 8.0 - copysign(TURN / 8.0 - angle, width - height);
    return copysign(TURN / 4.0 - copysign(TURN / 4.0 - angle, x), y);
}

/* From inside a circle its far side is seen. */
static void cast_circle(const struct scan *scan, const double *circle)
{
    const struct beams *beams = scan->beams;
    double x, y, radius = circle[2], reach = scan->max_range * CULL + radius, away2, free2, tangent, half, low, touch;
    int64_t first, last, i;
    int inside;

    to_sensor_frame(scan, circle, &x, &y);
    away2 = x * x + y * y;
    if (away2 > reach * reach)
        return;
    free2 = away2 - radius * radius;
    inside = free2 <= 0.0;
    tangent = inside ? 0.0 : sqrt(free2);
    half = radius / tangent < TURN / 4.0 ? radius / tangent : TURN / 4.0; /* at least half of the angle it takes up */
    half = inside ? TURN / 2.0 : half + ROUGH;
    low = (inside ? 0.0 : rough_bearing(x, y)) - half;
    touch = -2.0 * TOLERANCE * radius * tangent; /* the squared half chord of a beam just outside the tangent */

    for (low = first_bearing(beams, low, 2.0 * half); low <= beams->end; low += TURN) {
        if (!beams_between(beams, low, 2.0 * half, &first, &last))
            continue;
        for (i = first; i <= last; i++) {
            double along = beams->dx[i] * x + beams->dy[i] * y, chord2 = along * along - free2, chord, distance;
            if (!(chord2 >= touch))
                continue;
            chord = sqrt(chord2 > 0.0 ? chord2 : 0.0);
            distance = along + (inside ? chord : -chord);
            distance = distance > 0.0 ? distance : 0.0;
            scan->nearest[i] = distance < scan->nearest[i] ? distance : scan->nearest[i];
        }
    }
}

static void cast_tile(const struct scan *scan, const struct beam_plane *plane, struct tiles *tiles, int64_t tile)
{
    int32_t k;
    if (tiles->tile_marks[tile] == tiles->mark)
        return;
    tiles->tile_marks[tile] = tiles->mark;
    for (k = tiles->starts[tile]; k < tiles->starts[tile + 1]; k++) {
        int32_t segment = tiles->members[k];
        if (tiles->segment_marks[segment] != tiles->mark) {
            tiles->segment_marks[segment] = tiles->mark;
            cast_segment(scan, plane->segments + 4 * (int64_t)segment);
        }
    }
}

static int64_t within(double place, int64_t count)
{
    return place > 0.0 ? (place < (double)count ? (int64_t)place : count - 1) : 0;
}

/* Cast the tiles along one beam, in order, until it has hit something nearer than the next tile. */
static void walk(const struct scan *scan, const struct beam_plane *plane, struct tiles *tiles, double x, double y,
                 double enter, int64_t beam)
{
    const double *nearest = scan->nearest + beam;
    double ux = scan->c * scan->beams->dx[beam] - scan->s * scan->beams->dy[beam];
    double uy = scan->s * scan->beams->dx[beam] + scan->c * scan->beams->dy[beam];
    double per_column = 1.0 / fabs(ux), per_row = 1.0 / fabs(uy); /* path length per tile; infinite along an axis */
    double leave = scan->max_range / tiles->side, to_column, to_row;
    int64_t column, row, step_column = ux > 0.0 ? 1 : -1, step_row = uy > 0.0 ? 1 : -1;

    column = within(x + enter * ux, tiles->columns);
    row = within(y + enter * uy, tiles->rows);
    to_column = ux != 0.0 ? fabs((double)(column + (ux > 0.0)) - x) * per_column : INFINITY;
    to_row = uy != 0.0 ? fabs((double)(row + (uy > 0.0)) - y) * per_row : INFINITY;
    while (enter <= leave && enter * tiles->side <= *nearest) {
        cast_tile(scan, plane, tiles, row * tiles->columns + column);
        if (to_column < to_row) {
            enter = to_column;
            to_column += per_column;
            column += step_column;
            if (column < 0 || column >= tiles->columns)
                return;
        } else {
            enter = to_row;
            to_row += per_row;
            row += step_row;
            if (row < 0 || row >= tiles->rows)
                return;
        }
    }
}

/* Cast the tiles around the sensor at (x, y) [tiles]; returns up to what distance [tiles] all beams are done. */
static double cast_block(const struct scan *scan, const struct beam_plane *plane, struct tiles *tiles, double x,
                         double y)
{
    int64_t column, row, first_column = (int64_t)x - BLOCK, first_row = (int64_t)y - BLOCK;
    double to_column = fmin(x - (double)first_column, (double)(first_column + 2 * BLOCK + 1) - x);
    double to_row = fmin(y - (double)first_row, (double)(first_row + 2 * BLOCK + 1) - y);
    for (row = first_row; row <= first_row + 2 * BLOCK; row++)
        for (column = first_column; column <= first_column + 2 * BLOCK; column++)
            if (row >= 0 && row < tiles->rows && column >= 0 && column < tiles->columns)
                cast_tile(scan, plane, tiles, row * tiles->columns + column);
    return fmin(to_column, to_row);
}

static void cast_tiles(const struct scan *scan, const struct beam_plane *plane, struct tiles *tiles, double x, double y)
{
    double done;
    int64_t i;
    tiles->mark++;
    for (i = 0; i < tiles->n_everywhere; i++)
        cast_segment(scan, plane->segments + 4 * (int64_t)tiles->everywhere[i]);
    done = cast_block(scan, plane, tiles, x, y);
    for (i = 0; i < scan->beams->samples; i++)
        if (scan->nearest[i] > done * tiles->side)
            walk(scan, plane, tiles, x, y, done, i);
}

static void cast_plane(const struct scan *scan, const struct beam_plane *plane, int64_t robot)
{
    struct tiles *tiles = plane->tiles;
    double x = tiles ? (scan->x - tiles->x) / tiles->side : -1.0, y = tiles ? (scan->y - tiles->y) / tiles->side : -1.0;
    int64_t i;
    for (i = 0; i < plane->n_circles; i++)
        cast_circle(scan, plane->circles + 3 * i);
    for (i = 0; i < plane->n_bodies; i++)
        if (plane->owners[i] != robot)
            cast_circle(scan, plane->moved_bodies + 3 * i);
    if (x >= 0.0 && y >= 0.0 && x <= (double)tiles->columns && y <= (double)tiles->rows)
        cast_tiles(scan, plane, tiles, x, y);
    else
        for (i = 0; i < plane->n_segments; i++)
            cast_segment(scan, plane->segments + 4 * i);
}

/* The point or circle centre `local` of a frame with this pose, in the world. */
static void to_world(const double *pose, const double *local, double *x, double *y)
{
    double c = cos(pose[2]), s = sin(pose[2]);
    *x = pose[0] + c * local[0] - s * local[1];
    *y = pose[1] + s * local[0] + c * local[1];
}

/* Distances [m] of these robots' sensors, in their rows of `distances` (n, samples); +inf beyond max_range [m]. */
int aro_cast(const struct beams *beams, const struct beam_scene *scene, int64_t n_scans, const int64_t *robots,
             double max_range, double *distances)
{
    int64_t i, k;
    for (i = 0; i < 3 * scene->n_robots; i++)
        if (!isfinite(scene->footprints[i]))
            return POSE_NOT_FINITE;
    for (i = 0; i < n_scans; i++)
        if (robots[i] < 0 || robots[i] >= scene->n_robots)
            return NO_SUCH_ROBOT;
    for (i = 0; i < scene->n_planes; i++) {
        const struct beam_plane *plane = scene->planes + i;
        for (k = 0; k < plane->n_bodies; k++) {
            double *moved = plane->moved_bodies + 3 * k;
            to_world(scene->footprints + 3 * plane->owners[k], plane->bodies + 3 * k, moved, moved + 1);
            moved[2] = plane->bodies[3 * k + 2];
        }
    }
    for (i = 0; i < n_scans; i++) {
        const double *footprint = scene->footprints + 3 * robots[i], *mount = scene->mounts + 3 * robots[i];
        double yaw = footprint[2] + mount[2];
        struct scan scan = {beams, 0.0, 0.0, cos(yaw), sin(yaw), max_range, distances + robots[i] * beams->samples};
        to_world(footprint, mount, &scan.x, &scan.y);
        for (k = 0; k < beams->samples; k++)
            scan.nearest[k] = INFINITY;
        cast_plane(&scan, scene->planes + scene->plane_of[robots[i]], robots[i]);
        for (k = 0; k < beams->samples; k++)
            if (scan.nearest[k] > max_range)
                scan.nearest[k] = INFINITY;
    }
    return OK;
}
