"""Programs under the grader's agent, with a stub of the grader's end of the wire."""

import json
import os
import pickle
import socket
import struct
import subprocess
import sys
from typing import List, NamedTuple, Tuple

from support import ROOT

from robocop_grading.agent import wire

AGENT = os.path.join(ROOT, "src", "robocop_grading", "agent")
STEP = 10**7  # [ns] of simulated time between two requests
PATIENCE = 60.0  # [s, wall] for a program to do what it does at one time


class Answer(NamedTuple):
    """What the agent says when the program is done."""

    done: int
    next: int


class Program:
    """A program under the agent."""

    def __init__(self, folder, text, parameters=(), offered=(), answer=b""):
        """`offered`: headers of connections; `answer`: to each call of a service."""
        script = folder / "script.py"
        script.write_text("import time\nstart = time.monotonic()\n" + text)
        mine, theirs = socket.socketpair()
        self.process = subprocess.Popen(
            [sys.executable, AGENT, f"{theirs.fileno()},0", str(script), "argument"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            pass_fds=[theirs.fileno()],
        )
        theirs.close()
        mine.settimeout(PATIENCE)
        self.published: List[Tuple[str, bytes]] = []
        self.told = {}  # the last TOPICS
        self._channel, self._frames, self._answer = mine, mine.makefile("rb"), answer
        self.send(wire.SETUP, pickle.dumps((dict(parameters), list(offered))))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self._channel.close()

    def send(self, kind, body):
        self._channel.sendall(wire.frame(kind, body))

    def go_on(self, until, clock=0, messages=()):
        """Let simulated time go on until this time [ns]; the agent's answer, or nothing if the program has ended.

        `clock`: what /clock shows then [ns]; `messages`: of the grader's topics.
        """
        try:
            self.send(wire.GO, wire.go(until, clock, messages))
            while True:
                size, kind = wire.HEAD.unpack(self._frames.read(wire.HEAD.size))
                body = self._frames.read(size)
                if kind == wire.DONE:
                    return Answer(*wire.TIMES.unpack(body))
                if kind == wire.MESSAGE:
                    self.published.append(wire.split(body))
                elif kind == wire.TOPICS:
                    self.told = json.loads(body)
                elif kind == wire.CALL:
                    self.send(wire.REPLY, self._answer)
        except (OSError, struct.error):
            return None

    def output(self, seconds):
        """Let it live for this simulated time, or until it ends; what it has printed."""
        for step in range(1, int(seconds * 1e9) // STEP + 1):
            if self.go_on(step * STEP) is None:
                self.process.wait(PATIENCE)
                break
        else:
            self.process.kill()
        return self.process.stdout.read().splitlines()
