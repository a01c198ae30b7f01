/* Sends the messages of one step to all their subscribers in one call.
 *
 * The function is mirrored in outbox.py; ARO_SENDER_VERSION changes with it.
 */

#include <errno.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/types.h>

#define ARO_SENDER_VERSION 2

int aro_sender_version(void) { return ARO_SENDER_VERSION; }

/* Sends the sizes[i] bytes at the address data[i] to sockets[i] for each i < n, as far as the socket takes them at once;
 * taken[i] is the number of bytes that it took, or -errno. */
void aro_send(int64_t n, const int32_t *sockets, const uint64_t *data, const int64_t *sizes, int64_t *taken)
{
    int64_t i;
    for (i = 0; i < n; i++) {
        ssize_t sent;
        do
            sent = send(sockets[i], (const void *)(uintptr_t)data[i], (size_t)sizes[i], MSG_DONTWAIT | MSG_NOSIGNAL);
        while (sent < 0 && errno == EINTR);
        taken[i] = sent < 0 ? -(int64_t)errno : (int64_t)sent;
    }
}
