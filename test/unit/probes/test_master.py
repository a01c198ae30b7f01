"""What ./robocop finds out about a ROS master and a simulator before it starts another one."""

import contextlib
import socket
import threading
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from aro_robocop_goto_as.cli.system_commands import refuse_second_simulator
from aro_robocop_goto_as.errors import MasterError
from aro_robocop_goto_as.probes import master

SHORT, LONG = 0.3, 60.0  # [s, wall] timeouts of a request that is never answered, and of any other one


@pytest.fixture(autouse=True)
def long_timeout(monkeypatch):
    monkeypatch.setattr(master, "TIMEOUT", LONG)


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


def test_simulator_runs_if_the_master_knows_one_that_answers_as_a_node():
    with nobody() as uri:
        assert not master.master_answers(uri) and master.running_simulator(uri) is None
    with ros_master() as uri:
        assert master.master_answers(uri) and master.running_simulator(uri) is None
    with node() as simulator, ros_master(simulator) as uri:
        assert master.running_simulator(uri) == "a simulator is already running"
    with nobody() as ended, ros_master(ended) as uri:
        assert master.running_simulator(uri) is None
    with served(other=lambda: 1) as another_program, ros_master(another_program) as uri:
        assert master.running_simulator(uri) is None


def test_a_second_simulator_is_refused_with_a_command_that_ends_only_the_first_one(monkeypatch):
    with node() as simulator, ros_master(simulator) as uri:
        monkeypatch.setenv("ROS_MASTER_URI", uri)
        with pytest.raises(SystemExit, match="shell rosnode kill /robocop_sim, or use another ROS_MASTER_URI"):
            refuse_second_simulator()


@pytest.mark.parametrize("topic", ["/clock", "/red/odom"])
def test_no_simulator_runs_where_nobody_publishes_time_or_odometry_any_more(topic):
    def no_simulator(publisher, use_sim_time=False):
        state = [[[topic, ["/a"]], ["/rosout", ["/b"]]], [], []]
        with served(
            lookupNode=lambda *_: [1, "", publisher],
            getSystemState=lambda _: [1, "", state],
            getParam=lambda *_: [1, "", True] if use_sim_time else [-1, "not set", 0],
        ) as uri:
            return master.no_simulator(uri)

    with nobody() as ended:
        assert no_simulator(ended) == "no simulator is running: ./robocop run starts one"
        assert "/use_sim_time is set, so time stands still" in no_simulator(ended, use_sim_time=True)
        assert master.no_simulator(ended) == ""
    with node() as publisher:
        assert no_simulator(publisher) == ""
        assert ("time stands still" in no_simulator(publisher, use_sim_time=True)) == (topic != "/clock")


def test_simulator_that_hangs_is_reported_with_its_address_and_how_to_remove_it(monkeypatch):
    def shorten():  # for the next request, which is that to the simulator
        monkeypatch.setattr(master, "TIMEOUT", SHORT)

    with silent() as server, ros_master(uri_of(server), shorten) as uri:
        assert f"{uri_of(server)}; ./robocop shell rosnode cleanup removes it" in master.running_simulator(uri)


def test_port_that_never_answers_is_asked_once_and_is_an_error_after_the_timeout(monkeypatch):
    monkeypatch.setattr(master, "TIMEOUT", SHORT)
    with silent() as server:
        uri = uri_of(server)
        with pytest.raises(MasterError, match=rf"{uri} did not answer within {SHORT:g} s: .*ROS_MASTER_URI"):
            master.running_simulator(uri)
        server.accept()[0].close()
        server.setblocking(False)
        with pytest.raises(BlockingIOError):
            server.accept()


NO_MASTER = "does not answer as a ROS master does"


@pytest.mark.parametrize("methods", [{}, {"getPid": lambda *_: 1}])
def test_xml_rpc_server_that_is_no_master_is_an_error(methods):
    with served(**methods) as uri, pytest.raises(MasterError, match=NO_MASTER):
        master.master_answers(uri)


@pytest.mark.parametrize("answer", [b"220 mail.example ESMTP\r\n", b"HTTP/1.0 200 OK\r\n\r\n<html>"])
def test_server_of_another_protocol_is_an_error(answer):
    with socket.create_server(("127.0.0.1", 0)) as server:

        def reply():
            connection, _ = server.accept()
            with connection:
                request = b""
                while b"</methodCall>" not in request:  # what is unread at the end would reset the connection
                    request += connection.recv(65536)
                connection.sendall(answer)

        thread = threading.Thread(target=reply)
        thread.start()
        with pytest.raises(MasterError, match=NO_MASTER):
            master.master_answers(uri_of(server))
        thread.join()


def test_topics_of_a_type_that_are_published_and_not_subscribed_are_unheard():
    twist = "geometry_msgs/Twist"
    published = ["/cmd_vel", "/navi", "/odom", "/unknown"]
    kinds = [["/cmd_vel", twist], ["/navi", twist], ["/odom", "nav_msgs/Odometry"]]
    state = [[[topic, ["/a"]] for topic in published], [["/cmd_vel", ["/robocop_sim"]]], []]
    with served(getSystemState=lambda _: [1, "", state], getTopicTypes=lambda _: [1, "", kinds]) as uri:
        assert master.unheard(uri, twist) == ["/navi"]
