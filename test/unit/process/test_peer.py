"""What the process at the other end of a connection does: real processes, connected by TCP."""

import signal
import socket
import sys
from typing import Iterator, Tuple

import psutil
import pytest
from waiting import wait_for

from aro_robocop_goto_as.process.peer import Peer, _owners

SPIN, SLEEP, THREAD = "while True: pass", "time.sleep(1e6)", "threading.Thread(target=spin).start(); time.sleep(1e6)"
Ends = Tuple[socket.socket, psutil.Popen]


@pytest.fixture(name="ends")
def _ends(request: pytest.FixtureRequest) -> Iterator[Ends]:
    """A connection, and the process at its other end, which does what the test's parameter says."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        program = (
            "import socket, threading, time\n"
            "def spin():\n"
            "    while True: pass\n"
            f"end = socket.create_connection({server.getsockname()})\n"
            "end.send(b'.')\n"
            f"{request.param}\n"
        )
        process = psutil.Popen([sys.executable, "-c", program])
        try:
            end = server.accept()[0]
            with end:
                end.settimeout(60.0)
                assert end.recv(1) == b"."
                _owners.cache_clear()  # a connection that stalls has existed for longer than a second
                yield end, process
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()


@pytest.mark.parametrize("ends", [SPIN, THREAD], indirect=True)
def test_process_that_wants_a_processor_wants_to_run_until_it_has_used_its_patience(ends: Ends) -> None:
    end, process = ends
    wait_for(lambda: Peer(end, 1e6).wants_to_run(), "a running thread", 60.0, 0.01)
    peer = Peer(end, 0.05)
    wait_for(lambda: not peer.wants_to_run(), "the end of its patience", 60.0, 0.01)
    assert sum(process.cpu_times()[:2]) >= 0.05


@pytest.mark.parametrize("ends", [SLEEP], indirect=True)
def test_process_that_sleeps_does_not_want_to_run(ends: Ends) -> None:
    wait_for(lambda: not Peer(ends[0], 1e6).wants_to_run(), "sleep", 60.0, 0.01)


@pytest.mark.parametrize("ends", [SPIN], indirect=True)
def test_process_that_is_stopped_or_gone_does_not_want_to_run(ends: Ends) -> None:
    end, process = ends
    peer = Peer(end, 1e6)
    process.send_signal(signal.SIGSTOP)
    wait_for(lambda: not peer.wants_to_run(), "the stop", 60.0, 0.01)
    process.send_signal(signal.SIGCONT)
    wait_for(peer.wants_to_run, "the continuation", 60.0, 0.01)
    process.kill()
    process.wait()
    assert not peer.wants_to_run() and not Peer(end, 1e6).wants_to_run()


def test_connection_of_this_process_with_itself_tells_nothing() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        near = socket.create_connection(server.getsockname())
        far = server.accept()[0]
        with near, far:
            assert not Peer(near, 1e6).wants_to_run()
