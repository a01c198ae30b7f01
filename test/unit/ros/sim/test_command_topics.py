"""A node counts as answering from the moment its connections are complete, and again when it returns."""

import threading

from aro_robocop_goto_as.ros.sim.command_topics import AnsweringNodes
from aro_robocop_goto_as.ros.waiting import wait_until


def test_node_is_answering_once_its_connections_are_complete():
    complete = threading.Event()
    nodes = AnsweringNodes(lambda node: complete.is_set())
    assert nodes.among({"/a"}) == set()
    complete.set()
    assert wait_until(lambda: nodes.among({"/a"}) == {"/a"}, 10.0)
    assert nodes.among(set()) == set()
    assert wait_until(lambda: nodes.among({"/a"}) == {"/a"}, 10.0)


def test_node_with_a_registration_left_over_is_answering_after_the_patience():
    nodes = AnsweringNodes(lambda node: False, patience=0.05)
    assert wait_until(lambda: nodes.among({"/a"}) == {"/a"}, 10.0)


def test_node_that_waits_for_a_processor_is_waited_for_beyond_the_patience():
    looks = threading.Semaphore(0)

    class Starved:
        wants = True

        def wants_to_run(self):
            looks.release()
            return self.wants

    peer = Starved()
    nodes = AnsweringNodes(lambda node: False, patience=0.01, peer_of=lambda node: peer)
    assert nodes.among({"/a"}) == set()
    assert all(looks.acquire(timeout=10.0) for _ in range(5)) and nodes.among({"/a"}) == set()
    peer.wants = False
    assert wait_until(lambda: nodes.among({"/a"}) == {"/a"}, 10.0)


def test_one_node_does_not_wait_for_another():
    nodes = AnsweringNodes(lambda node: node == "/b")
    assert wait_until(lambda: nodes.among({"/a", "/b"}) == {"/b"}, 10.0)


def test_node_that_left_before_it_was_connected_is_not_answering_when_it_returns():
    looks = threading.Semaphore(0)
    complete = threading.Event()

    def is_ready(node):
        looks.release()
        return complete.is_set()

    nodes = AnsweringNodes(is_ready, patience=60.0)
    nodes.among({"/gone"})
    assert looks.acquire(timeout=10.0)
    waiting = next(thread for thread in threading.enumerate() if thread.name == "connections of /gone")
    nodes.among(set())
    complete.set()
    waiting.join(10.0)
    complete.clear()
    assert nodes.among({"/gone"}) == set()
    assert looks.acquire(timeout=10.0)
    assert nodes.among({"/gone"}) == set()
    complete.set()
    assert wait_until(lambda: nodes.among({"/gone"}) == {"/gone"}, 10.0)
