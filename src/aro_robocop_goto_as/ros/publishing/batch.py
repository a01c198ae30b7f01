"""Messages of one step, filled and sent together: one call of batch.c writes them all to their subscribers' sockets.

For each message and each subscriber, rospy would take a lock, test the connection's state, and release and take the
interpreter's lock.
"""

import ctypes
import functools
import threading
from typing import Any, Sequence, Set, Tuple

from ... import compiled
from ...compiled import structure
from .packed import PackedMessage
from .publisher import DirectPublisher
from .rospy_internals import disconnect, latch_lock

_FieldStruct, _ParcelStruct, _BatchStruct = (
    structure("ros/publishing/batch.c", name) for name in ("field", "parcel", "batch")
)

TopicMessage = Tuple[DirectPublisher, PackedMessage]


@functools.lru_cache(maxsize=None)
def _library() -> ctypes.PyDLL:
    library = compiled.load("batch", "ros/publishing/batch.c")
    library.aro_send.restype = ctypes.c_int64
    library.aro_send.argtypes = [ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64]
    return library


class Batch:
    """Messages that are sent together, again and again, to the present subscribers of their topics.

    One thread sends, and no other thread publishes on these topics, except rospy, which sends to new subscribers of a
    latched topic; at most one of the topics is latched.
    """

    def __init__(
        self, messages: Sequence[TopicMessage], last: Sequence[TopicMessage] = (), filled: Sequence[PackedMessage] = ()
    ) -> None:
        """`last`: messages sent after all others, such as the clock; `filled`: messages filled but not sent."""
        sent = [*messages, *last]
        self._kept = sent, filled  # batch.c also fills messages without a subscriber
        self._parcels = [(topic, message, link) for topic, message in sent for link in topic.links]
        fields = [
            _FieldStruct(field.kind, field.size, message.address + field.offset, field.source_address)
            for message in (*(message for _, message in sent), *filled)
            for field in message.fields
        ]
        parcels = [
            _ParcelStruct(message.address, link.address, message.size, link.descriptor)
            for _, message, link in self._parcels
        ]
        self._field_structs = (_FieldStruct * len(fields))(*fields)
        self._parcel_structs = (_ParcelStruct * len(parcels))(*parcels)
        self._struct = _BatchStruct(
            len(fields),
            len(parcels),
            sum(len(topic.links) for topic, _ in messages),
            ctypes.addressof(self._field_structs),
            ctypes.addressof(self._parcel_structs),
        )
        self._pointer, self._fill_and_send = ctypes.addressof(self._struct), _library().aro_send
        locks = [lock for lock in (latch_lock(topic) for topic, _ in sent) if lock is not None]
        self._lock: Any = locks[0] if locks else threading.Lock()

    def send(self, stamp_ns: int, more: bool = False) -> None:
        """Send everything at a simulated time [ns].

        `more`: the next messages follow at once, and the kernel may join them with these (MSG_MORE; 0.2 s at most).

        It waits for publisher.STALL_TIMEOUT at most, for all subscribers together: a stopped node can have many
        topics. A subscriber that has taken nothing by then misses messages until it reads again.
        """
        with self._lock:
            if self._fill_and_send(self._pointer, stamp_ns, more):
                self._finish()

    def _finish(self) -> None:
        """Send the rest of messages that were sent in part; a subscriber that is gone is disconnected."""
        lost: Set[int] = set()  # ids of connections
        may_wait = True
        for (topic, message, link), parcel in zip(self._parcels, self._parcel_structs):
            if parcel.taken != message.size and id(link.connection) not in lost:
                stood = link.stands_still
                try:
                    sent = link.finish(message.data.data, parcel.taken, may_wait)
                except OSError:  # as rospy: this subscriber is lost, and only this one
                    lost.add(id(link.connection))
                    disconnect(topic, link.connection)
                else:
                    may_wait = may_wait and (sent or stood)
