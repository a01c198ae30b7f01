/* Ideal differential drives as discs that walls and other discs block; kinematic.py describes the model. */

#include <math.h>
#include <stddef.h>

#include "../raycast/tiles.h"
#include "../robot/fleet.h"

#define MARGIN 1e-6 /* [m] kept free, so that rounding never moves a disc into a wall */
#define NEARBY 1.0  /* [m] the range within which walls are looked up in tiles */

/* A world's cross-sections at all heights of a robot's body, in one plane. */
struct body_section {
    const double *segments;  /* (n_segments, 2, 2) [m] */
    const struct tiles *tiles; /* of the segments */
    int64_t n_circles;
    const double *circles; /* (n_circles, 3) x, y, radius [m] */
};

struct kinematic {
    struct fleet *fleet;
    const struct body_section *sections;
    const int64_t *section_of; /* (n,) index of the one that each robot's body meets */
    double *free_travel;       /* (n,) [m] that a robot can travel before walls must be looked at; a lower bound */
    uint8_t *blocked;          /* (n,) whether a robot was blocked or pushed in its last step */
    uint8_t *crowded;          /* (n,) whether a robot may meet another one in this step */
    double separation;         /* [m] that any two robots can travel together before they meet; a lower bound */
};

/* A displacement of a disc, and the fraction of it that is free as far as is known. */
struct move {
    double radius, x, y; /* [m] of the disc, its centre */
    double dx, dy;       /* [m] */
    double length;       /* [m] */
    double free;         /* 0 to 1 */
};

/* The tiles from low to high [m] along an axis. None, with first > last: outside of all tiles, or for a pose that has
 * overflowed. */
static void tiles_between(double low, double high, double side, int64_t count, int64_t *first, int64_t *last)
{
    double from = floor(low / side), to = floor(high / side);
    *first = from > 0.0 ? (int64_t)fmin(from, (double)count) : 0;
    *last = to >= 0.0 ? (int64_t)fmin(to, (double)(count - 1)) : -1;
}

/* Visit the segments [ax, ay, bx, by] [m] within a square of half a side [m] around a point, perhaps others, some twice. */
static void visit_near(const struct body_section *section, double x, double y, double half,
                       void (*visit)(void *context, const double *segment), void *context)
{
    const struct tiles *tiles = section->tiles;
    int64_t row, last_row, column, last_column, k;
    tiles_between(x - half - tiles->x, x + half - tiles->x, tiles->side, tiles->columns, &column, &last_column);
    tiles_between(y - half - tiles->y, y + half - tiles->y, tiles->side, tiles->rows, &row, &last_row);
    for (k = 0; k < tiles->n_everywhere; k++)
        visit(context, section->segments + 4 * (int64_t)tiles->everywhere[k]);
    for (; row <= last_row && column <= last_column; row++) {
        const int32_t *starts = tiles->starts + row * tiles->columns;
        for (k = starts[column]; k < starts[last_column + 1]; k++)
            visit(context, section->segments + 4 * (int64_t)tiles->members[k]);
    }
}

struct nearest {
    double x, y, distance; /* [m] from a point to the nearest wall so far */
};

static void compare_distance(void *context, const double *segment)
{
    struct nearest *nearest = context;
    double along_x = segment[2] - segment[0], along_y = segment[3] - segment[1];
    double dx = nearest->x - segment[0], dy = nearest->y - segment[1], squared = along_x * along_x + along_y * along_y;
    double foot = (dx * along_x + dy * along_y) / (squared > 1e-30 ? squared : 1e-30);
    foot = foot < 0.0 ? 0.0 : foot > 1.0 ? 1.0 : foot;
    nearest->distance = fmin(nearest->distance, hypot(dx - foot * along_x, dy - foot * along_y));
}

/* Distance [m] from a robot's rim to the nearest wall, at most NEARBY; negative inside a wall. */
static double gap(const struct kinematic *kin, int64_t robot, double length)
{
    const struct body_section *section = kin->sections + kin->section_of[robot];
    const double *pose = kin->fleet->poses + 3 * robot, *circle;
    double radius = kin->fleet->radii[robot];
    struct nearest nearest = {pose[0], pose[1], radius + NEARBY};
    visit_near(section, pose[0], pose[1], radius + length + NEARBY, compare_distance, &nearest);
    for (circle = section->circles; circle < section->circles + 3 * section->n_circles; circle += 3)
        nearest.distance = fmin(nearest.distance, hypot(circle[0] - pose[0], circle[1] - pose[1]) - circle[2]);
    return nearest.distance - radius;
}

/* Stop the move where the disc's centre first enters a circle; it may leave one freely. */
static void stop_at_circle(struct move *move, double x, double y, double radius)
{
    double off_x = x - move->x, off_y = y - move->y, squared, towards, root, fraction;
    towards = off_x * move->dx + off_y * move->dy;
    squared = move->dx * move->dx + move->dy * move->dy;
    root = towards * towards - squared * ((off_x * off_x + off_y * off_y) - radius * radius);
    if (!(squared > 0.0 && root > 0.0 && towards > 0.0))
        return;
    fraction = (towards - sqrt(root)) / squared;
    move->free = fmin(move->free, fmax(0.0, fraction));
}

/* Stop the move where the disc first touches a segment. */
static void stop_at_segment(void *context, const double *segment)
{
    struct move *move = context;
    double along_x = segment[2] - segment[0], along_y = segment[3] - segment[1], length = hypot(along_x, along_y);
    double off_x = move->x - segment[0], off_y = move->y - segment[1], distance, approach, fraction, position;
    stop_at_circle(move, segment[0], segment[1], move->radius);
    stop_at_circle(move, segment[2], segment[3], move->radius);
    if (length == 0.0)
        return;
    along_x /= length;
    along_y /= length;
    distance = -off_x * along_y + off_y * along_x;
    approach = -(move->dy * along_x - move->dx * along_y) * (distance >= 0.0 ? 1.0 : -1.0);
    if (!(approach > 0.0))
        return;
    fraction = fmax((fabs(distance) - move->radius) / approach, 0.0);
    position = (off_x + fraction * move->dx) * along_x + (off_y + fraction * move->dy) * along_y;
    if (fraction < 1.0 && position >= 0.0 && position <= length)
        move->free = fmin(move->free, fraction);
}

/* Keep the contact margin before what was met; the fraction that was free `before` is the most. */
static void keep_margin(struct move *move, double before)
{
    if (move->free < 1.0)
        move->free = fmax(0.0, move->free - MARGIN / move->length);
    move->free = fmin(move->free, before);
}

/* Stop a robot's move at walls, and renew its free travel. */
static void stop_at_walls(struct kinematic *kin, int64_t robot, struct move *move)
{
    const struct body_section *section = kin->sections + kin->section_of[robot];
    double room = gap(kin, robot, move->length) - MARGIN, before = move->free;
    const double *circle;
    kin->free_travel[robot] = room - move->length;
    if (room >= move->length)
        return;
    move->free = 1.0;
    for (circle = section->circles; circle < section->circles + 3 * section->n_circles; circle += 3)
        stop_at_circle(move, circle[0], circle[1], circle[2] + move->radius);
    visit_near(section, move->x, move->y, move->radius + move->length + NEARBY, stop_at_segment, move);
    keep_margin(move, before);
}

/* Stop a robot's move at the other robots. */
static void stop_at_robots(const struct kinematic *kin, int64_t robot, struct move *move)
{
    const struct fleet *fleet = kin->fleet;
    double before = move->free;
    int64_t k;
    move->free = 1.0;
    for (k = 0; k < fleet->n; k++)
        if (k != robot)
            stop_at_circle(move, fleet->poses[3 * k], fleet->poses[3 * k + 1],
                           fleet->radii[k] + (move->radius + MARGIN));
    keep_margin(move, before);
}

/* Velocity v [m/s], w [rad/s] of a robot whose wheels turn as they are asked to and that nothing blocks. */
static void free_twist(const struct fleet *fleet, int64_t robot, double *v, double *w)
{
    double left = fleet->targets[2 * robot], right = fleet->targets[2 * robot + 1];
    *v = (left + right) * fleet->wheels[2 * robot] / 2.0;
    *w = (right - left) * fleet->wheels[2 * robot] / fleet->wheels[2 * robot + 1];
}

/* Mark the robots that may meet another one in this step. */
static void find_crowded(struct kinematic *kin, double dt)
{
    const struct fleet *fleet = kin->fleet;
    double longest = 0.0, v, w;
    int64_t i, k;
    for (i = 0; i < fleet->n; i++) {
        free_twist(fleet, i, &v, &w);
        longest = fmax(longest, fabs(v));
        kin->crowded[i] = 0;
    }
    longest *= dt;
    kin->separation -= 2.0 * longest;
    if (fleet->n < 2 || kin->separation >= 0.0)
        return;
    kin->separation = INFINITY;
    for (i = 0; i < fleet->n; i++)
        for (k = 0; k < i; k++) {
            double between = hypot(fleet->poses[3 * i] - fleet->poses[3 * k],
                                   fleet->poses[3 * i + 1] - fleet->poses[3 * k + 1]);
            double room = between - (fleet->radii[i] + fleet->radii[k]) - 2.0 * (longest + MARGIN);
            kin->separation = fmin(kin->separation, room);
            if (room < 0.0)
                kin->crowded[i] = kin->crowded[k] = 1;
        }
}

/* Move all robots by one step, one after the other; each meets the others where they are by then. */
static void move(struct kinematic *kin, double dt)
{
    struct fleet *fleet = kin->fleet;
    int64_t i;
    find_crowded(kin, dt);
    for (i = 0; i < fleet->n; i++) {
        double *pose = fleet->poses + 3 * i, v, w;
        int k;
        kin->blocked[i] = 0;
        free_twist(fleet, i, &v, &w);
        for (k = 0; k < 2; k++) {
            fleet->wheel_speeds[2 * i + k] = fleet->targets[2 * i + k];
            fleet->wheel_angles[2 * i + k] += fleet->targets[2 * i + k] * dt;
        }
        fleet->twists[2 * i] = v;
        fleet->twists[2 * i + 1] = w;
        if (v != 0.0) {
            struct move move = {fleet->radii[i], pose[0], pose[1], 0.0, 0.0, 0.0, 1.0};
            aro_arc(pose[2], v * dt, w * dt, &move.dx, &move.dy);
            kin->free_travel[i] -= fabs(v * dt); /* no chord is longer than its arc */
            if (kin->free_travel[i] < 0.0 || kin->crowded[i]) {
                move.length = hypot(move.dx, move.dy);
                if (kin->free_travel[i] < 0.0)
                    stop_at_walls(kin, i, &move);
                if (kin->crowded[i])
                    stop_at_robots(kin, i, &move);
            }
            pose[0] += move.free * move.dx;
            pose[1] += move.free * move.dy;
            if (move.free < 1.0) {
                fleet->twists[2 * i] = v * move.free;
                kin->blocked[i] = 1;
            }
        }
        pose[2] = aro_wrap(pose[2] + w * dt);
    }
}

/* Advance base controllers and motion by `steps` steps, from step number `first` on, at `rate` [Hz].
 * Each step takes one robot after the other. */
void aro_kinematic_advance(struct kinematic *kin, int64_t rate, int64_t first, int64_t steps)
{
    double dt = 1.0 / (double)rate;
    int64_t step;
    for (step = first; step < first + steps; step++) {
        aro_control(kin->fleet, (double)step / (double)rate, dt);
        move(kin, dt);
    }
}

/* Walls have moved by at most `travelled` [m]: push each robot radially out of the circle that overlaps it most, though
 * not into walls or other robots. */
void aro_kinematic_push(struct kinematic *kin, double travelled)
{
    struct fleet *fleet = kin->fleet;
    int64_t i, k;
    for (i = 0; i < fleet->n; i++) {
        const struct body_section *section = kin->sections + kin->section_of[i];
        double *pose = fleet->poses + 3 * i, deepest = 0.0, away = 0.0;
        struct move move = {fleet->radii[i], pose[0], pose[1], 0.0, 0.0, 0.0, 1.0};
        kin->free_travel[i] -= travelled;
        if (kin->free_travel[i] >= 0.0)
            continue;
        for (k = 0; k < section->n_circles; k++) {
            const double *circle = section->circles + 3 * k;
            double dx = pose[0] - circle[0], dy = pose[1] - circle[1], distance = hypot(dx, dy);
            double depth = circle[2] + fleet->radii[i] + MARGIN - distance;
            if (depth > deepest) {
                deepest = depth;
                away = distance;
                move.dx = dx;
                move.dy = dy;
            }
        }
        if (!(deepest > 0.0 && away > 0.0))
            continue;
        move.dx *= deepest / away;
        move.dy *= deepest / away;
        move.length = deepest;
        stop_at_walls(kin, i, &move);
        stop_at_robots(kin, i, &move);
        kin->separation = 0.0;
        pose[0] += move.free * move.dx;
        pose[1] += move.free * move.dy;
        kin->blocked[i] = 1;
    }
}

/* Whether a robot was blocked or pushed in the last step, or overlaps a wall or another robot. */
int aro_kinematic_touching(const struct kinematic *kin, int64_t robot)
{
    const struct fleet *fleet = kin->fleet;
    const double *pose = fleet->poses + 3 * robot;
    int64_t k;
    if (kin->blocked[robot] || gap(kin, robot, 0.0) < 0.0)
        return 1;
    for (k = 0; k < fleet->n; k++)
        if (k != robot && hypot(fleet->poses[3 * k] - pose[0], fleet->poses[3 * k + 1] - pose[1])
                              < fleet->radii[k] + fleet->radii[robot])
            return 1;
    return 0;
}
