"""What ./robocop finds out about a ROS master and a simulator before it starts another one."""

import contextlib
import socket
import threading
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from aro_robocop_goto_as.cli import commands
from aro_robocop_goto_as.errors import MasterError
from aro_robocop_goto_as.ros import graph

SIMULATOR = "/robocop_sim"
SHORT, LONG = 0.3, 60.0  # [s, wall] timeouts of a request that is never answered, and of any other one


@pytest.fixture(autouse=True)
def long_timeout(monkeypatch):
    monkeypatch.setattr(graph, "TIMEOUT", LONG)


@pytest.fixture
def use(monkeypatch):
    """A function that makes a URI that of the master."""
    return lambda uri: monkeypatch.setenv("ROS_MASTER_URI", uri)


@contextlib.contextmanager
def served(**methods):
    """The URI of an XML-RPC server that has these methods."""
    with SimpleXMLRPCServer(("127.0.0.1", 0), SimpleXMLRPCRequestHandler, logRequests=False) as server:
        for name, method in methods.items():
            server.register_function(method, name)
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}"
        finally:
            server.shutdown()
            thread.join()


def uri_of(server):
    return f"http://127.0.0.1:{server.getsockname()[1]}"


def silent():
    """A port that accepts connections and never answers."""
    return socket.create_server(("127.0.0.1", 0))


def node():
    """A ROS node's API, as far as it is used here."""
    return served(getPid=lambda caller: [1, "", 4711])


def ros_master(simulator=None, asked=lambda: None):
    """A ROS master's API; `simulator` is the URI under which it knows the simulator, for which it is asked."""

    def look_up(caller, name):
        asked()
        return [1, "", simulator] if simulator else [-1, "unknown node", ""]

    return served(getPid=lambda caller: [1, "", 4711], lookupNode=look_up)


@contextlib.contextmanager
def nobody():
    """The URI of a port that refuses connections; no other program can get it meanwhile."""
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        yield uri_of(bound)


def test_simulator_runs_if_the_master_knows_one_that_answers_as_a_node(use):
    with nobody() as uri:
        use(uri)
        assert not graph.master_answers() and not graph.running_node(SIMULATOR)
    with ros_master() as uri:
        use(uri)
        assert graph.master_answers() and not graph.running_node(SIMULATOR)
    with node() as simulator, ros_master(simulator) as uri:
        use(uri)
        assert graph.running_node(SIMULATOR, "a simulator") == "a simulator is already running"
    with nobody() as ended, ros_master(ended) as uri:
        use(uri)
        assert not graph.running_node(SIMULATOR)


def test_a_second_simulator_is_refused_with_a_command_that_ends_only_the_first_one(use):
    with node() as simulator, ros_master(simulator) as uri:
        use(uri)
        commands.require_system(starts_simulator=False)
        with pytest.raises(SystemExit, match="shell rosnode kill /robocop_sim, or use another ROS_MASTER_URI"):
            commands.require_system()


@pytest.mark.parametrize("topic", ["/clock", "/red/odom"])
def test_no_simulator_runs_where_nobody_publishes_time_or_odometry_any_more(use, topic):
    def no_simulator(publisher, use_sim_time=False):
        state = [[[topic, ["/a"]], ["/rosout", ["/b"]]], [], []]
        with served(
            lookupNode=lambda *_: [1, "", publisher],
            getSystemState=lambda _: [1, "", state],
            getTopicTypes=lambda _: [1, "", []],
            hasParam=lambda *_: [1, "", use_sim_time],
            getParam=lambda *_: [1, "", True],
        ) as uri:
            use(uri)
            return graph.no_simulator()

    with nobody() as ended:
        assert no_simulator(ended) == "no simulator is running: ./robocop run starts one"
        assert "/use_sim_time is set, so time stands still" in no_simulator(ended, use_sim_time=True)
        use(ended)
        assert graph.no_simulator() == ""
    with node() as publisher:
        assert no_simulator(publisher) == ""
        assert ("time stands still" in no_simulator(publisher, use_sim_time=True)) == (topic != "/clock")


def test_simulator_that_hangs_is_reported_with_its_address_and_how_to_remove_it(use, monkeypatch):
    def shorten():  # for the next request, which is that to the simulator
        monkeypatch.setattr(graph, "TIMEOUT", SHORT)

    with silent() as server, ros_master(uri_of(server), shorten) as uri:
        use(uri)
        assert f"{uri_of(server)}; ./robocop shell rosnode cleanup removes it" in graph.running_node(SIMULATOR)


def test_port_that_never_answers_is_an_error_after_the_timeout(use, monkeypatch):
    monkeypatch.setattr(graph, "TIMEOUT", SHORT)
    with silent() as server:
        use(uri_of(server))
        with pytest.raises(MasterError, match=rf"{uri_of(server)} did not answer within {SHORT:g} s: .*ROS_MASTER_URI"):
            graph.running_node(SIMULATOR)
        assert socket.getdefaulttimeout() is None


def mail_server(server):
    """Answer a request as another kind of server."""
    connection, _ = server.accept()
    with connection:
        request = b""
        while b"</methodCall>" not in request:  # what is unread at the end would reset the connection
            request += connection.recv(65536)
        connection.sendall(b"220 mail.example ESMTP\r\n")


def test_what_answers_in_another_way_is_no_master(use):
    with served() as uri:
        use(uri)
        with pytest.raises(MasterError, match="does not answer as a ROS master does"):
            graph.master_answers()
    with silent() as server:
        use(uri_of(server))
        thread = threading.Thread(target=mail_server, args=[server])
        thread.start()
        with pytest.raises(MasterError, match="does not answer as a ROS master does"):
            graph.master_answers()
        thread.join()
