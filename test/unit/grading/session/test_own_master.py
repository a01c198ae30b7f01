"""A master in this process has its port for itself, or does not start."""

import socket
import xmlrpc.client

from aro_robocop_goto_as.process.ports import free_port
from robocop_grading.session.own_master import start_master


def test_master_answers_at_its_port():
    port = free_port()
    master = start_master(port)
    try:
        assert xmlrpc.client.ServerProxy(f"http://localhost:{port}").getPid("/test")[0] == 1
    finally:
        master.shutdown("the test is over")


def test_no_master_starts_at_a_port_that_is_taken():
    with socket.create_server(("", 0)) as taken:
        assert start_master(taken.getsockname()[1]) is None
