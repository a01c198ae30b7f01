"""The processes under test: a ROS master of its own, simulator, servers and bridge, which a fault may kill or freeze.

Whatever ends is started again by `restart`, and only that: everything else has to recover by itself.
"""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import xmlrpc.client
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # test/, as pytest has it

import psutil
import rosgraph
import roslib.packages
import rospy
import waiting

from aro_robocop_goto_as.process.orphans import end_with_parent
from aro_robocop_goto_as.process.ports import free_port

PACKAGE = "aro_robocop_goto_as"
SIMULATOR, BRIDGE, MASTER = "robocop_sim", "robocop_rviz_goto_ac_node", "master"
SERVER = "aro_robocop_goto_as_node"
SCRIPTS = {SIMULATOR: "robocop_sim.py", SERVER: "robocop_goto_as.py", BRIDGE: "robocop_rviz_goto_ac.py"}
BROKEN_SERVER = Path(__file__).with_name("broken_server.py")
DEADLINE = 60.0  # [s, wall] which only a failure reaches
POLL = 0.002  # [s, wall]
CONNECTING = 0.2  # [s, wall] between two checks of the connections of a node that starts
CLIENT = "/fault_campaign"


class Violation(AssertionError):
    """An invariant that does not hold."""


def wait_for(condition, what, deadline=DEADLINE):
    """The first true value of a condition; Violation with `what`, which may be callable, after the deadline."""
    return waiting.wait_for(condition, what, deadline, POLL, error=Violation)


class System:
    """One ROS system; its processes by the full names of their nodes."""

    def __init__(self, folder, mistake=None):
        """`folder` for logs; `mistake`: of a server to start instead, by its name in broken_server.py."""
        self.folder = Path(folder)
        port = free_port()
        uri = f"http://localhost:{port}"
        log = {"ROS_LOG_DIR": str(self.folder / "log"), "ROS_HOME": str(self.folder)}
        os.environ.update(ROS_MASTER_URI=uri, ROS_HOSTNAME="localhost", **log)
        os.environ.pop("ROS_IP", None)
        self.mistake = mistake
        self.processes = {}
        self.log_offsets = {}
        self.master = rosgraph.Master(CLIENT, uri)
        self.servers = []
        self._start(MASTER, "rosmaster", "--core", "-p", str(port))

    def start_nodes(self, servers, simulator):
        """`servers`: their namespaces; `simulator`: its parameters, None for a campaign that is the robot itself."""
        wait_for(self.master.is_online, "the master answers")
        self.master.setParam("/use_sim_time", True)
        if simulator is not None:
            self.master.setParam(f"/{SIMULATOR}", simulator)
            self.start("/" + SIMULATOR)
        self.servers = [f"/{name}/{SERVER}" if name else f"/{SERVER}" for name in servers]
        for server in self.servers:
            self.start(server)
        if servers == [""]:
            self.start("/" + BRIDGE)

    # -- processes --

    def _start(self, name, *command):
        log = self.folder / (name.strip("/").replace("/", "-") + ".log")
        self.log_offsets.setdefault(log, 0)
        with open(log, "ab") as file:
            self.processes[name] = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=file,
                start_new_session=True,
                preexec_fn=end_with_parent(signal.SIGKILL),  # it may be stopped
            )

    def start(self, node, *arguments):
        """Start a node by its full name."""
        namespace, _, name = node.rpartition("/")
        command = [roslib.packages.find_node(PACKAGE, SCRIPTS[name])[0]]
        if self.mistake is not None and name == SERVER:
            command = [sys.executable, str(BROKEN_SERVER), self.mistake]
        self._start(node, *command, f"__name:={name}", f"__ns:={namespace or '/'}", *arguments)

    def take_over(self, node):
        """Start a second node of this name, upon which the first one has to end by itself."""
        first = self.processes[node]
        self.start(node)
        try:
            first.wait(DEADLINE)
        except subprocess.TimeoutExpired:
            first.kill()
            first.wait()
            raise Violation(f"{node} still runs {DEADLINE:g} s after another one took its name") from None

    def kill(self, node):
        """SIGKILL, if it still runs."""
        self.processes[node].kill()
        self.processes[node].wait()

    def send_signal(self, node, number):
        """Send a signal to a process."""
        self.processes[node].send_signal(number)

    def end(self, node, number=signal.SIGKILL):
        """End a process with a signal, and wait until it has ended."""
        self.send_signal(node, number)
        try:
            self.processes[node].wait(DEADLINE)
        except subprocess.TimeoutExpired:
            raise Violation(f"{node} still runs {DEADLINE:g} s after {signal.Signals(number).name}") from None

    def restart(self, node):
        """Start a process again that has ended."""
        assert self.processes[node].poll() is not None
        self.start(node)

    def close(self):
        """End everything."""
        for number in (signal.SIGCONT, signal.SIGTERM):
            for name, process in self.processes.items():
                if name != MASTER and process.poll() is None:
                    process.send_signal(number)
        for name, process in reversed(list(self.processes.items())):
            with contextlib.suppress(subprocess.TimeoutExpired):
                if name != MASTER:
                    process.wait(20.0)
            if process.poll() is None:
                process.kill()
                process.wait()

    # -- what they say and use --

    def require_health(self):
        """Violation if a process has ended by itself or logged a traceback."""
        for name, process in self.processes.items():
            if process.poll() is not None:
                raise Violation(f"{name} ended by itself with status {process.returncode}")
        for log, offset in self.log_offsets.items():
            with open(log, encoding="utf-8", errors="replace") as file:
                file.seek(offset)
                text = file.read()
                self.log_offsets[log] = file.tell()
            # The timer of actionlib's server may publish once more when rospy has closed its topics.
            if text.count("Traceback") > text.count("ROSException: publish() to a closed topic"):
                raise Violation(f"a traceback in {log.name}:\n{text[text.index('Traceback') :][:2000]}")

    def usage(self):
        """By process: its id, RSS [MiB], number of threads and of file descriptors."""
        used = {}
        for name, child in self.processes.items():
            process = psutil.Process(child.pid)
            with process.oneshot():
                rss = process.memory_info().rss / 2**20
                used[name] = (child.pid, rss, process.num_threads(), process.num_fds())
        return used

    def api(self, node):
        """The XML-RPC interface of a node; OSError or rosgraph.MasterException while it can't be found."""
        return xmlrpc.client.ServerProxy(self.master.lookupNode(node))


def connections_from(system, node, to=CLIENT):
    """Topics that a node sends to another, or to this one, as it says itself; empty while it does not answer."""
    return _topics(system, node, to, "o")


def topics_received(system, node):
    """Topics that a node receives from this one, as it says itself; empty while it does not answer."""
    return _topics(system, node, rospy.get_node_uri(), "i")


def _topics(system, node, end, direction):
    try:
        return {link[4] for link in system.api(node).getBusInfo(CLIENT)[2] if link[1:3] == [end, direction]}
    except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
        return set()


def is_connected(publisher, node):
    """Whether a node that still lives receives a publisher of this node."""
    links = [link for link in list(publisher.impl.connections) if link.endpoint_id == node]
    return any(link.socket is not None and _is_open(link.socket) for link in links)


def _is_open(link):
    try:
        return link.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT) != b""
    except BlockingIOError:
        return True
    except OSError:
        return False


def publisher(topic, kind):
    """A publisher that drops nothing."""
    return rospy.Publisher(topic, kind, queue_size=10000, tcp_nodelay=True)
