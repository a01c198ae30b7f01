/* Fills the messages of one step with the simulation's numbers, and sends them to all their subscribers.
 *
 * ROS's messages are little-endian, as all processors are for which Debian builds ROS 1.
 */

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/types.h>

#define ARO_BATCH_VERSION 7 /* changes with each structure and function that Python uses */
#define NANOSECONDS 1000000000

/* What a field of a message is made of */
enum {
    HEADER,  /* seq, stamp: the uint32 of the last message, which is counted on; NULL: always 0 */
    STAMP,   /* of the step: seconds, nanoseconds */
    POSE,    /* position and quaternion, 7 doubles: 3 doubles x, y [m], yaw [rad] */
    TWIST,   /* linear and angular, 6 doubles: 2 doubles v [m/s], w [rad/s] */
    DOUBLES, /* `count` doubles: the same */
    FLOATS   /* `count` 32-bit floats: as many doubles */
};

struct field {
    int64_t kind, count;
    uint8_t *to; /* in the bytes of a message, not aligned */
    void *from;  /* numbers of the simulation */
};

/* A message for one subscriber. */
struct parcel {
    const uint8_t *data;
    const int64_t *stands; /* whether the subscriber has stopped reading: it gets nothing here */
    int64_t size, socket;
    int64_t taken; /* bytes that the socket took, or -errno */
};

struct batch {
    int64_t n_fields, n_parcels;
    int64_t n_first; /* parcels that must all be sent before the others are */
    const struct field *fields;
    struct parcel *parcels;
};

int aro_batch_version(void) { return ARO_BATCH_VERSION; }

/* Write a field of a message, at the simulated time stamp [s, ns]. */
static void fill(const struct field *field, const uint32_t *stamp)
{
    const double *from = field->from;
    double pose[7] = {0.0}, twist[6] = {0.0};
    uint32_t header[3] = {0, stamp[0], stamp[1]}, *last = field->from;
    int64_t i;
    switch (field->kind) {
    case HEADER:
        if (last != NULL)
            header[0] = ++*last;
        memcpy(field->to, header, sizeof header);
        break;
    case STAMP:
        memcpy(field->to, stamp, 2 * sizeof *stamp);
        break;
    case POSE:
        pose[0] = from[0];
        pose[1] = from[1];
        pose[5] = sin(from[2] / 2.0);
        pose[6] = cos(from[2] / 2.0);
        memcpy(field->to, pose, sizeof pose);
        break;
    case TWIST:
        twist[0] = from[0];
        twist[5] = from[1];
        memcpy(field->to, twist, sizeof twist);
        break;
    case DOUBLES:
        memcpy(field->to, from, (size_t)field->count * sizeof *from);
        break;
    case FLOATS:
        for (i = 0; i < field->count; i++) {
            float value = (float)from[i];
            memcpy(field->to + sizeof value * (size_t)i, &value, sizeof value);
        }
        break;
    }
}

/* Whether a parcel before parcel i has the same socket and was not sent whole: parts of two would be mixed. */
static int is_behind_another(const struct batch *batch, int64_t i)
{
    int64_t k;
    for (k = 0; k < i; k++)
        if (batch->parcels[k].socket == batch->parcels[i].socket && batch->parcels[k].taken < batch->parcels[k].size)
            return 1;
    return 0;
}

/* Fill and send the messages of a step at simulated time stamp_ns [ns], as far as the sockets take them without waiting.
 * more: the next step follows at once, so the kernel may join its messages with these; one wake-up of the subscriber for
 * several steps. Returns how many parcels are not sent whole. Those of subscribers that stand still delay no others. */
int64_t aro_send(struct batch *batch, int64_t stamp_ns, int64_t more)
{
    const int flags = MSG_DONTWAIT | MSG_NOSIGNAL | (more ? MSG_MORE : 0);
    uint32_t stamp[2] = {(uint32_t)(stamp_ns / NANOSECONDS), (uint32_t)(stamp_ns % NANOSECONDS)};
    int64_t i, incomplete = 0, standing = 0;
    for (i = 0; i < batch->n_fields; i++)
        fill(batch->fields + i, stamp);
    for (i = 0; i < batch->n_parcels; i++) {
        struct parcel *parcel = batch->parcels + i;
        parcel->taken = 0;
        if (*parcel->stands) {
            standing++;
            continue;
        }
        if (!incomplete || (i < batch->n_first && !is_behind_another(batch, i))) {
            ssize_t sent;
            do
                sent = send((int)parcel->socket, parcel->data, (size_t)parcel->size, flags);
            while (sent < 0 && errno == EINTR);
            parcel->taken = sent < 0 ? -(int64_t)errno : (int64_t)sent;
        }
        incomplete += parcel->taken != parcel->size;
    }
    return incomplete + standing;
}
