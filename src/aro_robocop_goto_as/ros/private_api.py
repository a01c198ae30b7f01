"""Everything that uses private parts of rospy, actionlib, roslaunch, viser and argparse, each with the reason."""

import argparse
import contextlib
import re
import select
import socket
import threading
from typing import Any, Callable, Dict, Iterator, List, Optional, Set, Tuple, Union

import actionlib
import rospy

LARGEST_REQUEST = 1 << 20  # [byte] that a page may send at once


# -- rospy --


def sender(message: Any) -> str:
    """Name of the node that published a received message; rospy exposes it only in the connection header."""
    return str(message._connection_header["callerid"])


def publishers_of(subscriber: rospy.Subscriber) -> Set[str]:
    """Names of the nodes a subscriber is connected to; rospy's public API only counts connections."""
    return {link.callerid_pub for link in subscriber.impl.connections}


def is_connected_to(publisher: rospy.Publisher, node: str) -> bool:
    """Whether a publisher is connected to this node; rospy's public API only counts connections."""
    return bool(publisher.impl.has_connection(node))


def is_topic_connected_to(topic: str, node: str) -> bool:
    """Whether this process publishes a topic, by its resolved name, and is connected to this node for it."""
    implementation = rospy.topics.get_topic_manager().get_publisher_impl(topic)
    return implementation is not None and bool(implementation.has_connection(node))


def connections_of(publisher: rospy.Publisher) -> List[Tuple[Any, socket.socket]]:
    """A publisher's connections that are open, with their sockets.

    rospy offers no socket options but the subscriber's TCP_NODELAY, and no way to send to several topics at once.
    """
    topic = publisher.impl
    connections = [] if topic is None else topic.connections
    open_ones = [(connection, getattr(connection, "socket", None)) for connection in connections]
    return [(connection, connected) for connection, connected in open_ones if connected is not None]


def live_connections(publisher: rospy.Publisher) -> List[Any]:
    """The connections whose subscribers are still there; rospy drops one that was closed only when it writes to it."""
    live = []
    for connection in publisher.impl.connections:
        connected = getattr(connection, "socket", None)
        if connected is None:
            continue
        poll = select.poll()
        with contextlib.suppress(OSError, ValueError):  # it is being closed
            poll.register(connected, select.POLLRDHUP | select.POLLHUP | select.POLLERR)
            if not poll.poll(0):
                live.append(connection)
    return live


def subscriber_of(connection: Any) -> str:
    """Name of the node to which a publisher's connection goes; rospy's public API has no names of subscribers."""
    return str(connection.endpoint_id)


def messages_sent(connection: Any) -> int:
    """How many messages were sent to one subscriber; rospy's public API does not count them."""
    return int(connection.stat_num_msg)


def write_message(publisher: rospy.Publisher, data: Union[bytes, bytearray]) -> None:
    """Write a serialized message, preceded by its length, to all subscribers, like the end of rospy's publish.

    rospy serializes into a BytesIO and copies that; there is no way to hand it bytes. The topic's lock, statistics and
    the handling of failed connections are the same.
    """
    topic = publisher.impl
    if topic is None or topic.closed:
        if rospy.is_shutdown():
            return
        raise rospy.ROSException("publish() to a closed topic")
    failed = []
    topic.acquire()
    try:
        topic.seq += 1
        for connection in topic.connections:
            try:
                connection.write_data(data)
            except Exception:  # as rospy: whatever it is, this subscriber is lost, and only this one
                failed.append(connection)
        topic.message_data_sent += len(data)
    finally:
        topic.release()
    for connection in failed:
        disconnect(publisher, connection)


def disconnect(publisher: rospy.Publisher, connection: Any) -> None:
    """Disconnect a subscriber, unless that has happened already.

    After a connection's own close(), rospy fails to stop watching its socket, as that is closed. While a duplicate is
    open, the system reports the old descriptor's number, and rospy disconnects the next subscriber that gets it.
    """
    topic = publisher.impl
    if topic is not None:
        with topic.c_lock, contextlib.suppress(Exception):  # whatever it is, as rospy
            if connection in topic.connections:
                topic.remove_connection(connection)


def count_message(publisher: rospy.Publisher, size: int) -> None:
    """Count a message of `size` bytes that was sent to a publisher's subscribers; rospy's statistics show it."""
    topic = publisher.impl
    if topic is not None:
        topic.seq += 1
        topic.message_data_sent += size


def count_sent(connection: Any, size: int) -> None:
    """Count a message of `size` bytes that was sent to one subscriber, as rospy's write_data does."""
    connection.stat_bytes += size
    connection.stat_num_msg += 1


def set_latched(publisher: rospy.Publisher, message: Any) -> None:
    """Set the message that a latching topic sends to new subscribers, for use with write_message."""
    publisher.impl.latch = message


def message_definition(kind: Any) -> Tuple[str, str]:
    """Type name of a message class, and its definition with those of its parts; genpy has no public names for them."""
    return kind._type, kind._full_text


def clock_condition() -> Optional[threading.Condition]:
    """The condition that rospy notifies at each /clock message; None on wall-clock time.

    rospy.sleep and rospy.Rate wait on it as well, but neither can be interrupted while /clock is paused.
    """
    return None if rospy.rostime.is_wallclock() else rospy.rostime.get_rostime_cond()


def shutdown_has_begun() -> bool:
    """Whether shutdown was requested; rospy.is_shutdown() turns true only after the on_shutdown hooks."""
    return bool(rospy.core.is_shutdown_requested())


# -- actionlib --


def connected_to_server(client: actionlib.ActionClient) -> bool:
    """Whether all five topics of an action client are connected to its server, without waiting.

    actionlib's wait_for_server measures its timeout in ROS time: on a paused simulator it never returns.
    """
    if client.last_status_msg is None:
        return False
    server = sender(client.last_status_msg)
    return all(server in publishers_of(topic) for topic in (client.result_sub, client.feedback_sub)) and all(
        is_connected_to(topic, server) for topic in (client.pub_goal, client.pub_cancel)
    )


def goal_senders(server: actionlib.ActionServer) -> int:
    """How many nodes can send goals to an action server; actionlib keeps its topics to itself."""
    return int(server.goal_sub.get_num_connections())


def has_client(server: actionlib.ActionServer) -> bool:
    """Whether somebody can send goals to an action server, and hears of their status and result."""
    topics = (server.goal_sub, server.status_pub, server.result_pub)
    return all(topic.get_num_connections() > 0 for topic in topics)


def set_default_result(server: actionlib.SimpleActionServer, make_result: Callable[[], Any]) -> None:
    """The result of goals that the server ends by itself, before they are accepted; actionlib's is empty."""
    server.action_server.ActionResultType = make_result


def ignore_future_cancels(server: actionlib.SimpleActionServer) -> None:
    """Have a cancel with a stamp in the future affect only goals received so far; call before server.start().

    actionlib recalls every goal with an earlier stamp: after the clock is set back that is every goal.
    """
    inner = server.action_server
    receive_goal = inner.internal_goal_callback

    def receive_goal_despite_future_cancel(goal: Any) -> None:
        with inner.lock:
            if inner.last_cancel > rospy.get_rostime():
                inner.last_cancel = rospy.Time()
        receive_goal(goal)

    inner.internal_goal_callback = receive_goal_despite_future_cancel  # start() subscribes with it


def keep_results(server: actionlib.SimpleActionServer, count: int) -> None:
    """Keep at least this many results for a slow subscriber; actionlib keeps 50, and each older one is lost for good.

    The length is otherwise read from a parameter, which would hold for all action servers of the namespace.
    """
    topic = server.action_server.result_pub.impl
    if topic.queue_size == 0 or topic.queue_size > count:  # 0: all
        return
    with topic.c_lock:
        topic.set_queue_size(count)
        for connection in topic.connections:  # of subscribers that came before
            connection._queue_size = count


def replace_status_timer(
    server: actionlib.SimpleActionServer, start_timer: Callable[[float, Callable[[], None]], rospy.Timer]
) -> None:
    """Publish the status list from another timer; actionlib's ends for good when the clock is set back."""
    inner = server.action_server
    if inner.status_timer is not None:
        inner.status_timer.shutdown()
        inner.status_timer = start_timer(1.0 / inner.status_frequency, lambda: inner.publish_status_async(None))


def forget_later_stamps(server: actionlib.SimpleActionServer, goal: actionlib.ServerGoalHandle) -> None:
    """Let a received goal replace goals with a later stamp; call from the server's internal_goal_callback.

    SimpleActionServer refuses goals stamped earlier than the newest it has seen, so after the clock is set back it
    would refuse every goal. The order of arrival is enough: a client's messages arrive in order.
    """
    with server.action_server.lock, server.lock:
        stamp = goal.get_goal_id().stamp
        for handle in (server.current_goal, server.next_goal):
            if handle.get_goal() and handle.get_goal_id().stamp > stamp:
                handle.get_goal_id().stamp = stamp


# -- roslaunch --


def load_launch_files(parent: Any) -> None:
    """Load the files of a ROSLaunchParent that is not started yet; its start() loads them only if nobody has."""
    parent._load_config()


def add_early_listener(parent: Any, listener: Any) -> None:
    """Add a process listener to a ROSLaunchParent that is not started yet, so that it misses no process.

    ROSLaunchParent itself adds listeners when all nodes are up; one may have ended by then.
    """
    start_process_monitor = parent._start_pm

    def start_process_monitor_with_listener() -> None:
        start_process_monitor()
        parent.pm.add_process_listener(listener)

    parent._start_pm = start_process_monitor_with_listener


def install_roslaunch_signal_handlers() -> None:
    """Install roslaunch's signal handlers now; roslaunch does it when it starts the first process."""
    from roslaunch import pmon  # here, because its import takes long and most nodes don't need it

    pmon._init_signal_handlers()


# -- viser --


@contextlib.contextmanager
def checked_requests(
    refusal: Callable[[Any], str], headers: Dict[str, str], listening: Optional[socket.socket] = None
) -> Iterator[None]:
    """A viser server made in this block answers only HTTP requests for which `refusal` returns an empty string.

    Every answer gets these headers. With a `listening` socket it accepts its connections, and opens no port itself.
    viser passes no such options on to websockets' serve(), which it calls before its constructor returns.
    """
    from websockets.asyncio import server as websockets_server  # not installed where the page has never been used

    serve = websockets_server.serve

    def checking_serve(handler: Any, host: str, port: int, process_request: Any, **options: Any) -> Any:
        def process(connection: Any, request: Any) -> Any:
            reason = refusal(request.headers)
            response = connection.respond(403, reason + "\n") if reason else process_request(connection, request)
            if response is not None:
                response.headers.update(headers)
            return response

        options = {**options, "process_request": process, "max_size": LARGEST_REQUEST}
        return serve(handler, host, port, **options) if listening is None else serve(handler, sock=listening, **options)

    setattr(websockets_server, "serve", checking_serve)  # noqa: B010  mypy refuses to assign to a module's function
    try:
        yield
    finally:
        setattr(websockets_server, "serve", serve)  # noqa: B010


# -- argparse --


def accept_scientific_notation(parser: argparse.ArgumentParser) -> None:
    """Let a parser accept -5e-1 as a number; argparse treats it as an unknown option."""
    parser._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
