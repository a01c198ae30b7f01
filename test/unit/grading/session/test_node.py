"""A node's turns and its end, with a program in place of the agent."""

import os
import sys
from types import SimpleNamespace

import pytest
from std_msgs.msg import String
from support import ROOT

from robocop_grading.errors import GraderLostError
from robocop_grading.session import node as module
from robocop_grading.session.job import Job
from robocop_grading.session.node import Node
from robocop_grading.session.topics import Topics
from robocop_grading.submission import CHANNEL

TURN = 10**7  # [ns]
# Answers each request to go on, after something that it does.
AGENT = """
import os, sys, time
sys.path.insert(0, SRC)
from robocop_grading.agent import wire
channel = int(sys.argv[1].split(",")[0])
requests = os.fdopen(channel, "rb", closefd=False)
def request():
    size, kind = wire.HEAD.unpack(requests.read(wire.HEAD.size))
    return kind, requests.read(size)
while True:
    kind, body = request()
    if kind == wire.GO:
        until, _ = wire.TIMES.unpack_from(body)
        TURN
        os.write(channel, wire.frame(wire.DONE, wire.TIMES.pack(until, until + 5)))
"""


class Watched(Node):
    """A node that is `do`, with the lines that it prints and the texts that it publishes on /said."""

    def __init__(self, folder, do, cpu_time=60.0, used=0.0):
        self.lines, self.said, self.waits, self.now, topics = [], [], 0, 0, Topics()
        topics.subscribe("/said", String, lambda message: self.said.append(message.data))
        text = AGENT.replace("SRC", repr(os.path.join(ROOT, "src"))).replace("TURN", do)
        command = (sys.executable, "-u", "-c", text, CHANNEL)
        job = Job("server", command, dict(os.environ), folder, folder, None, {}, cpu_time, 60.0, print)
        services = SimpleNamespace(headers=lambda: [])
        super().__init__(job, topics, services, self.lines.append, self.wait, 0, 0, used)

    def wait(self):
        self.waits += 1

    def turn(self):
        """One turn; the reason why it is over, if it is."""
        self.now += TURN
        self.run_until(self.now, self.now, lambda: None)
        return self.how_ended(self.now / 1e9).reason if self.has_ended() else None


@pytest.fixture
def started(tmp_path):
    """Starts nodes."""
    nodes = []

    def start(do, **options):
        nodes.append(Watched(tmp_path, do, **options))
        return nodes[-1]

    yield start
    for node in nodes:
        node.end()


def test_a_node_lives_until_the_time_that_it_is_told(started):
    node = started("print(until)")
    assert [node.turn() for _ in range(3)] == [None] * 3
    assert node.lines == [str(number * TURN) for number in (1, 2, 3)] and node.next_ns == 3 * TURN + 5


def test_what_a_node_says_before_it_ends_by_itself_counts(started):
    last = r"os.write(channel, wire.frame(wire.MESSAGE, wire.named('/said', b'\x06\0\0\0\2\0\0\0ab')))"
    node = started(f"{last}; print('bye'); sys.exit(3)")
    assert node.turn() == "" and node.how_ended(1.0).status == 3
    assert (node.said, node.lines) == (["ab"], ["bye"])
    calls = []
    node.run_until(2 * TURN, 0, lambda: calls.append("as ever"))
    assert calls == ["as ever"]


@pytest.mark.parametrize(
    "do, did",
    [
        ("time.sleep(600)", "stopped answering"),
        ("os.close(channel); time.sleep(600)", "closed its connection to"),
        ("while True: time.sleep(0.01)", "stopped answering"),
    ],
)
def test_a_node_that_does_nothing_is_ended_with_the_reason(do, did, started, monkeypatch):
    monkeypatch.setattr(module, "MAX_IDLE", 0.5)
    assert started(do).turn() == f"it {did} the grader, which has ended it"


def test_an_answer_that_has_come_counts_although_the_time_for_it_is_over(started, monkeypatch):
    monkeypatch.setattr(module, "POLL_PERIOD", 60.0)
    monkeypatch.setattr(module, "MAX_IDLE", -1.0)
    assert started("pass").turn() is None


def test_node_that_works_is_waited_for_and_what_has_to_be_done_meanwhile_is_done(started, monkeypatch):
    monkeypatch.setattr(module, "MAX_IDLE", 1.0)
    monkeypatch.setattr(module, "MIN_WORK", 0.02)
    node = started("end = time.process_time() + 2.0\n        while time.process_time() < end: pass")
    assert node.turn() is None and node.waits > 1


def test_processor_time_of_earlier_nodes_counts(started):
    node = started("while True: pass", cpu_time=100.0, used=99.5)
    assert node.turn() == "its processes together used more than 100 s of processor time"
    assert 100.0 < node.used < 110.0


LIES = [
    ("wire.HEAD.pack(2**31, wire.DONE)", "can't be read"),
    ("wire.frame(77, b'')", "can't be read"),
    ("wire.frame(wire.DONE, b'done')", "can't be read"),
    ("wire.frame(wire.MESSAGE, bytes([2, 0, 255, 255]))", "can't be read"),
    ("wire.frame(wire.DONE, wire.TIMES.pack(1, 2))", "did not go on"),
]


@pytest.mark.parametrize("answer, words", LIES)
def test_an_answer_that_no_agent_gives_ends_the_run(answer, words, started):
    with pytest.raises(GraderLostError, match=words):
        started(f"os.write(channel, {answer})").turn()
