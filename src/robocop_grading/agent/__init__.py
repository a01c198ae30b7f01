"""Runs inside the hand-in's process: its threads live in simulated time, and its topics are on one wire to the grader.

    python agent CHANNEL SCRIPT [ARGUMENT...]

    scheduler    which thread runs, what the others wait for, and simulated time
    locks, clock, files, threads    Python's ways to wait, each of which tells the scheduler
    stuck        threads that wait in a way that none of these sees; child processes (processes)
    ros          rospy's time
    memory_socket, ros_graph, connections    rospy's topics and services, and the ROS master, without the network
    noetic       names that the lab's Python 3.8 and NumPy still have
    wire         what the grader and the agent say to each other
    request_loop the grader's requests to go on until a simulated time, and the answers

docs/agent.md follows one thread's turn through these modules, and says what depends on each constant.

It imports nothing but the standard library and ROS's own, so that it runs in any environment that the hand-in was built
in. A hand-in that deceives it harms only itself: points come from what the grader sees on topics.
"""

SWITCH = 5e-4  # [s] after which a busy loop lets another thread run, such as the one that answers the grader


def install(descriptor: int, clock_ns: int) -> None:
    """Take over the process's time before anything of the hand-in runs, and start to answer the grader.

    `clock_ns` is what /clock shows.
    """
    import sys

    from . import clock, connections, files, locks, noetic, request_loop, ros, threads
    from .scheduler import start_new_thread

    sys.setswitchinterval(SWITCH)
    locks.install()
    clock.install()
    files.install()
    threads.register_main()
    threads.install()
    answers = request_loop.RequestLoop(descriptor, clock_ns)
    connections.install(answers.grader)
    ros.install(answers.clock)
    noetic.install()
    start_new_thread(answers.serve, ())
