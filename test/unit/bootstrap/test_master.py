"""What ./robocop finds out about a ROS master and a simulator before it starts another one."""

import contextlib
import socket
import threading
import time
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from aro_robocop_goto_as.bootstrap import master
from aro_robocop_goto_as.errors import MasterError
from aro_robocop_goto_as.process.ports import free_port

SHORT = 0.3  # [s, wall] timeout of a request


@pytest.fixture(autouse=True)
def short_timeout(monkeypatch):
    monkeypatch.setattr(master, "TIMEOUT", SHORT)


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


@contextlib.contextmanager
def silent():
    """The URI of a port that accepts connections and never answers."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"http://127.0.0.1:{server.getsockname()[1]}"


def node():
    """A ROS node's API, as far as it is used here."""
    return served(getPid=lambda caller: [1, "", 4711])


def ros_master(simulator=None):
    """A ROS master's API; `simulator` is the URI under which it knows the simulator."""
    answer = [1, "", simulator] if simulator else [-1, "unknown node", ""]
    return served(getPid=lambda caller: [1, "", 4711], lookupNode=lambda caller, name: answer)


def nobody():
    return f"http://127.0.0.1:{free_port()}"


def test_closed_port_has_no_master_and_no_simulator():
    uri = nobody()
    assert not master.master_answers(uri)
    assert master.running_simulator(uri) is None


def test_master_without_simulator():
    with ros_master() as uri:
        assert master.master_answers(uri)
        assert master.running_simulator(uri) is None


def test_simulator_that_answers_is_running():
    with node() as simulator, ros_master(simulator) as uri:
        assert master.running_simulator(uri) == "a simulator is already running"


def test_simulator_that_has_ended_but_is_still_registered_is_not_running():
    with ros_master(nobody()) as uri:
        assert master.running_simulator(uri) is None


def test_another_program_on_the_port_of_an_ended_simulator_is_no_simulator():
    with served(other=lambda: 1) as other, ros_master(other) as uri:
        assert master.running_simulator(uri) is None


def test_simulator_that_hangs_is_reported_with_its_address():
    with silent() as simulator, ros_master(simulator) as uri:
        assert simulator in master.running_simulator(uri)


@pytest.mark.parametrize("ask", [master.master_answers, master.running_simulator])
def test_port_that_never_answers_is_an_error_after_the_timeout(ask):
    with silent() as uri:
        start = time.monotonic()
        with pytest.raises(MasterError, match=rf"{uri} did not answer within {SHORT:g} s: .*ROS_MASTER_URI"):
            ask(uri)
        assert time.monotonic() - start < 20 * SHORT


@pytest.mark.parametrize("ask", [master.master_answers, master.running_simulator])
@pytest.mark.parametrize("methods", [{}, {"getPid": lambda *_: 1, "lookupNode": lambda *_: 1}])
def test_xml_rpc_server_that_is_no_master_is_an_error(ask, methods):
    with served(**methods) as uri, pytest.raises(MasterError, match="does not answer as a ROS master does"):
        ask(uri)


@pytest.mark.parametrize("ask", [master.master_answers, master.running_simulator])
@pytest.mark.parametrize("answer", [b"220 mail.example ESMTP\r\n", b"HTTP/1.0 200 OK\r\n\r\n<html>", b""])
def test_server_of_another_protocol_is_an_error(ask, answer):
    with socket.create_server(("127.0.0.1", 0)) as server:

        def reply():
            with contextlib.suppress(OSError):
                while True:
                    connection, _ = server.accept()
                    with connection:
                        connection.recv(65536)
                        connection.sendall(answer)

        thread = threading.Thread(target=reply)
        thread.start()
        try:
            uri = f"http://127.0.0.1:{server.getsockname()[1]}"
            with pytest.raises(MasterError, match="does not answer as a ROS master does"):
                ask(uri)
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join()
