"""rospy's connections without the network: to the grader, on the wire, and to the node itself.

rospy reaches the master and nodes by xmlrpc.client, and topics and services by TCPROSTransport. Both stay: requests
to the master, to the grader and to the node itself are answered here, and a MemorySocket takes the place of a socket.
So latching, queue_size, _connection_header and the errors of wrong types are rospy's own, and all of this happens in
no simulated time.
"""

import xmlrpc.client
from typing import Any, Dict, Optional

from .memory_socket import MemorySocket, accept
from .ros_graph import SimulatorProxy
from .scheduler import scheduler


def _to_itself() -> MemorySocket:
    """Connect the node to one of its own topics or services; return the node's end."""
    mine: MemorySocket = MemorySocket(lambda data: theirs.feed(data))
    theirs = MemorySocket(mine.feed)
    mine.on_close, theirs.on_close = theirs.end, mine.end
    accept(theirs)
    return mine


def _answer(api: Any, body: Any) -> Any:
    """The answer that xmlrpc.client would get from a server."""
    arguments, method = xmlrpc.client.loads(body)
    function = None if str(method).startswith("_") else getattr(api, str(method), None)
    if function is None:  # as xmlrpc.server; such as system.multicall, by which rospy takes leave of the master
        raise xmlrpc.client.Fault(1, f"<class 'Exception'>:method \"{method}\" is not supported")
    result = function(*arguments)
    return xmlrpc.client.loads(xmlrpc.client.dumps((result,), methodresponse=True))[0]


def install(grader: SimulatorProxy) -> None:
    """Have rospy use these connections."""
    _install_requests(grader)
    _install_transport(grader)


def _install_requests(grader: SimulatorProxy) -> None:
    """Have requests to the master, to the grader and to the node itself answered here."""
    from rospy.impl import masterslave

    cls: Any = xmlrpc.client.Transport
    request = cls.request

    def answered(transport: Any, host: Any, path: str, body: bytes, verbose: bool = False) -> Any:
        api = grader.api(host) if isinstance(host, str) else None
        if api is None:
            return request(transport, host, path, body, verbose)
        grader.has_news |= api is grader.master
        return _answer(api, body)

    cls.request = answered

    handler: Any = masterslave.ROSHandler
    make = handler.__init__

    def noted(self: Any, *arguments: Any, **options: Any) -> None:
        make(self, *arguments, **options)
        grader.node = self

    handler.__init__ = noted


def _install_transport(grader: SimulatorProxy) -> None:
    """Have connections to the grader and to the node itself use a MemorySocket."""
    import rospy
    from rosgraph.network import write_ros_handshake_header
    from rospy.impl import tcpros_base

    transport: Any = tcpros_base.TCPROSTransport
    connect, write_header = transport.connect, transport.write_header

    def connected(self: Any, host: str, port: int, node: str, timeout: Optional[float] = None) -> None:
        if port == grader.port:
            self.socket = grader.connect(self.protocol)
        elif scheduler.active and grader.node is not None and port == tcpros_base.get_tcpros_server_address()[1]:
            self.socket = _to_itself()
        else:
            connect(self, host, port, node, timeout)
            return
        self.endpoint_id, self.dest_address = node, (host, port)
        self.write_header()
        self.read_header()

    def written(self: Any) -> None:
        if isinstance(self.socket, MemorySocket):  # rospy polls until it can be written to
            self.stat_bytes += write_ros_handshake_header(self.socket, self.protocol.get_header_fields())
        else:
            write_header(self)

    transport.connect, transport.write_header = connected, written
    # A topic with a queue would have a thread for each subscriber, and drop messages if that is not scheduled in time.
    rospy.topics.QueuedConnection = lambda connection, _size: connection


def topics(grader: SimulatorProxy) -> Dict[str, Any]:
    """What the node publishes and subscribes to: name, checksum and name of the type; nothing before init_node().

    Without rospy's locks, which a waiting thread may hold.
    """
    from rospy.topics import get_topic_manager

    manager = get_topic_manager()
    found = [
        [[name, it.data_class._md5sum, it.data_class._type] for name, it in list(topics.items()) if it.data_class]
        for topics in ((manager.pubs, manager.subs) if grader.node is not None else ({}, {}))
    ]
    return {"published": found[0], "subscribed": found[1]}
