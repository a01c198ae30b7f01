"""Runs inside the hand-in's process: its threads live in simulated time, and the grader learns when they all wait.

    python agent CHANNEL SCRIPT [ARGUMENT...]

    scheduler    which thread runs, and for what the others wait; simulated time
    readers      threads that wait for files and sockets, and what is on its way to them
    locks, clock, files, threads    Python's ways to wait, each of which tells the scheduler
    stuck        threads that wait in a way that none of these sees; other processes
    ros          rospy's time; calls to the grader's own ports, whose answers come without simulated time
    channel      the grader's requests to go on until a simulated time, and the answers

It imports nothing but the standard library, so that it runs in any environment that the hand-in was built in. A hand-in
that deceives it harms only itself: points come from what the grader sees on topics.
"""

import sys
from typing import Set

SWITCH = 5e-4  # [s] after which a busy loop lets another thread run, such as the one that answers the grader


def install(descriptor: int, clock_ns: int, ports: Set[int]) -> None:
    """Take over the process's time before anything of the hand-in runs, and start to answer the grader.

    `clock_ns` is what /clock shows, `ports` are those of the grader's master and node.
    """
    from . import channel, clock, files, locks, readers, ros, scheduler, threads

    sys.setswitchinterval(SWITCH)
    locks.install()
    clock.install()
    files.install()
    readers.grader_ports.update(ports)
    threads.register_main()
    threads.install()
    ros.install(clock_ns, ports)
    scheduler.start_new_thread(channel.Channel(descriptor, ports).serve, ())
