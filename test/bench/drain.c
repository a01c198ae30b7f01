/* Reads the connections of the bench's client and counts their messages.
 *
 * Link and the function are mirrored in client.py, which compiles this file.
 */

#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <time.h>

#define EVENTS 64
#define READ_SIZE (1 << 18)    /* [bytes] per call */
#define NANOSECONDS 1000000000 /* per second */

/* A connection. Each frame is a length of 4 bytes, little-endian, and the message, which begins with a std_msgs/Header.
 * https://wiki.ros.org/ROS/TCPROS */
typedef struct {
    int64_t messages; /* complete ones */
    int64_t first_ns; /* stamp of the first message [ns] */
    int64_t last_ns;  /* stamp of the last complete message [ns] */
    int64_t first_at; /* when the first message was complete [ns, CLOCK_MONOTONIC] */
    int64_t left;     /* bytes of the present message that are still to come after its head; < 0: it has no header */
    uint32_t head[4]; /* length, seq, secs, nsecs of the present message, as far as they have arrived */
    uint32_t filled;  /* bytes of head that have arrived */
    uint32_t open;    /* 0 once the connection has ended */
} Link;

static int64_t now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (int64_t)time.tv_sec * NANOSECONDS + time.tv_nsec;
}

/* Counts the messages that `size` more bytes complete, up to one that is too short for a header. */
static void count(Link *link, const uint8_t *data, size_t size)
{
    while (size > 0 && link->left >= 0) {
        size_t part = sizeof link->head - link->filled;
        if (part > 0) {
            part = part < size ? part : size;
            memcpy((uint8_t *)link->head + link->filled, data, part);
            link->filled += (uint32_t)part;
            if (link->filled >= sizeof link->head[0])
                link->left = (int64_t)link->head[0] - (int64_t)(sizeof link->head - sizeof link->head[0]);
        } else {
            part = (size_t)link->left < size ? (size_t)link->left : size;
            link->left -= (int64_t)part;
        }
        data += part;
        size -= part;
        if (link->filled == sizeof link->head && link->left == 0) {
            link->last_ns = (int64_t)link->head[2] * NANOSECONDS + link->head[3];
            if (link->messages++ == 0) {
                link->first_ns = link->last_ns;
                link->first_at = now();
            }
            link->filled = 0;
        }
    }
}

/* Reads the sockets in the epoll set as data arrives, until the descriptor `stop`, which is in it too, is ready.
 * links[fd] belongs to the socket fd. After each round it rests for `pause` [ns], below a second, so that it is not woken
 * for every single message. Returns 0, or errno. */
int32_t aro_drain(int32_t epoll, int32_t stop, Link *links, int64_t pause)
{
    uint8_t data[READ_SIZE];
    struct epoll_event events[EVENTS];
    const struct timespec rest = {0, (long)pause};
    for (;;) {
        int i, ready = epoll_wait(epoll, events, EVENTS, -1);
        if (ready < 0 && errno != EINTR)
            return errno;
        for (i = 0; i < ready; i++) {
            const int fd = events[i].data.fd;
            ssize_t size;
            if (fd == stop)
                return 0;
            size = recv(fd, data, sizeof data, MSG_DONTWAIT);
            if (size > 0)
                count(&links[fd], data, (size_t)size);
            else if (size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
                links[fd].open = 0;
                epoll_ctl(epoll, EPOLL_CTL_DEL, fd, NULL);
            }
        }
        nanosleep(&rest, NULL);
    }
}
