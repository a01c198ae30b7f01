"""The life of a node, from init_node and its parameters to shutdown by a signal or an error."""

import contextlib
import os
import signal
import sys
import threading
import time
from typing import Any, Iterator, Type, TypeVar

import rosgraph
import rospy

from ..errors import MasterError, RobocopError
from ..names import SIMULATOR, robocop
from ..param_loading import from_dict
from ..process.signals import ending_signals
from . import graph

HELP = """\
{0}
usage: rosrun aro_robocop_goto_as {1} {2}
Names and meanings: docs/interfaces.md. ./robocop run and roslaunch start it with everything else."""
MASTER_PERIOD = 0.5  # [s, wall] between two looks for a ROS master
MASTER_WATCH_PERIOD = 2.0  # [s, wall] between two looks whether it is still there
T = TypeVar("T")


def answer_help(about: str, arguments: str = "[_PARAMETER:=VALUE...] [TOPIC:=OTHER...]", others: bool = False) -> None:
    """End the program with three lines about a node if --help was given; needs no master.

    others: whether the node may have other options; otherwise they are refused
    """
    program, options = os.path.basename(sys.argv[0]), [word for word in sys.argv[1:] if word.startswith("-")]
    if {"-h", "--help"} & set(options):
        print(HELP.format(about, program, arguments))
        sys.exit()
    if options and not others:
        sys.exit(f"{program}: there is no option {options[0]}; there is: --help")


def wait_for_master() -> None:
    """Return when there is a ROS master. rospy's own wait for one, in init_node, can't be ended by a signal."""
    if rosgraph.is_master_online():
        return
    uri = rosgraph.get_master_uri()
    print(f"waiting for a ROS master at {uri}: start {robocop()} run or roscore there", file=sys.stderr)
    try:
        while not rosgraph.is_master_online():
            time.sleep(MASTER_PERIOD)
    except KeyboardInterrupt:
        sys.exit(128 + signal.SIGINT)


def leave_name_to_another(node_name: str, always: bool = False) -> None:
    """End the program if a node of its name runs, which the master would end, and with it perhaps a whole system.

    always: also if roslaunch has not started this node. A node that is started by hand takes the other node's place,
    as is usual in ROS.
    """
    given = rosgraph.names.load_mappings(sys.argv)
    if not always and "__log" not in given:  # which roslaunch gives to all of its nodes
        return
    name = rosgraph.names.ns_join(rosgraph.names.get_ros_namespace(), given.get("__name", node_name))
    kind = "a simulator" if node_name == SIMULATOR else "a node of this name"
    try:
        running = graph.running_node(name, kind)
    except MasterError as error:
        sys.exit(f"{node_name}: {error}")
    if running:
        uri = rosgraph.get_master_uri()
        sys.exit(f"{node_name}: {running} as {name} on {uri}; stop it first, or use another ROS_MASTER_URI")


@contextlib.contextmanager
def node(name: str, **options: Any) -> Iterator[None]:
    """rospy.init_node for the block in which the node lives; a RobocopError in it is logged, with exit status 1.

    rospy shuts down inside its signal handler. If the signal interrupts a call to the master, the handler waits forever
    for the lock that this call holds. Here a thread shuts down, so that the call can complete.
    """
    wait_for_master()
    leave_name_to_another(name, always=name == SIMULATOR)
    log = rosgraph.names.load_mappings(sys.argv).get("__log")
    if log:  # unless it is in this folder itself, rospy replaces the link `latest`; nodes that do so at once fail
        os.environ["ROS_LOG_DIR"] = os.path.dirname(log)
    for number in ending_signals():
        signal.signal(number, _shut_down)
    try:
        rospy.init_node(name, disable_signals=True, **options)
        yield
    except RobocopError as error:
        rospy.logfatal("%s: %s", error.code, error)
        sys.exit(1)
    except rospy.ROSException as error:  # shutdown during start, or while publishing
        if not rospy.core.is_shutdown_requested():
            raise
        rospy.logdebug("%s", error)
        sys.exit()
    finally:  # threads that wait for rospy's end would keep the process alive
        rospy.signal_shutdown("the node has ended")


def end_with_master() -> None:
    """End the node when the ROS master's port is closed, because nobody could find the node; watches from a thread."""

    def watch() -> None:
        while not rospy.is_shutdown():
            with contextlib.suppress(MasterError):  # it is busy
                if not graph.master_answers():
                    rospy.logfatal("the ROS master has ended, and so does %s", rospy.get_name())
                    rospy.signal_shutdown("the ROS master has ended")
            time.sleep(MASTER_WATCH_PERIOD)

    threading.Thread(target=watch, daemon=True).start()


def load_params(cls: Type[T]) -> T:
    """All private parameters as `cls`; ParameterError names the node and each key that is wrong."""
    return from_dict(cls, rospy.get_param("~", {}), f"parameters of {rospy.get_name()}")


def _shut_down(number: int, _: object) -> None:
    threading.Thread(target=rospy.signal_shutdown, args=(f"signal {number}",)).start()
