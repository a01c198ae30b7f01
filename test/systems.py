"""Processes that a test starts, each in a session of its own, and ROS systems of their own that they make up."""

import contextlib
import os
import signal
import subprocess
import tempfile
import xmlrpc.client

import psutil
import rosgraph
import yaml
from waiting import DEADLINE, wait_for

from robocop_hosting.ports import free_port

END_TIMEOUT = 40.0  # [s, wall] for a process to end; roslaunch needs 17 s to kill a node that does not end
CALLER = "/system_test"


class Process(subprocess.Popen):
    """A program whose output goes to a file; as a context manager it ends with the block."""

    def __init__(self, *command, log=None, **options):
        self._log = open(log, "w+b") if log else tempfile.TemporaryFile()
        options = {"stdout": self._log, "stderr": self._log, **options}
        super().__init__(list(map(str, command)), start_new_session=True, **options)

    def __exit__(self, *_):
        self.end(signal.SIGINT)

    @property
    def output(self):
        """What it has written so far."""
        return os.pread(self._log.fileno(), os.fstat(self._log.fileno()).st_size, 0).decode(errors="replace")

    def wait_for_exit(self, deadline=DEADLINE):
        """Wait until it ends by itself; its exit status."""
        try:
            return self.wait(deadline)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{self.args} still runs after {deadline:g} s:\n{self.output}") from None

    def interrupt(self, number=signal.SIGINT):
        """Send a signal as a terminal does: also to what it has started, as a shell waits for that one's end."""
        if self.poll() is None:
            os.killpg(self.pid, number)

    def end(self, *signals):
        """Send one signal after the other, SIGKILL last, until it has ended; its exit status."""
        for number in (*signals, signal.SIGKILL):
            self.interrupt(number)
            with contextlib.suppress(subprocess.TimeoutExpired):
                return self.wait(END_TIMEOUT)
        raise AssertionError(f"process {self.pid} outlived SIGKILL: {self.args}")


def is_running(uri, node):
    """Return whether a node answers; a master also lists nodes that were killed."""
    try:
        return rosgraph.is_master_online(rosgraph.Master(CALLER, uri).lookupNode(node))
    except rosgraph.MasterException:
        return False


class System:
    """Its settings and processes; as a context manager it ends what still runs, the newest first."""

    def __init__(self, directory, environment=os.environ):
        self.directory = directory
        self.port = free_port()
        self.uri = f"http://localhost:{self.port}"
        self.environment = {
            **environment,
            "ROS_MASTER_URI": self.uri,
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": str(directory / "ros"),
            "ROS_LOG_DIR": str(directory / "ros" / "log"),
            "PYTHONUNBUFFERED": "1",
        }
        self.environment.pop("ROS_IP", None)
        self.master = rosgraph.Master(CALLER, self.uri)
        self.running = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end_all()

    # -- processes --

    def start(self, name, *command, signals=(signal.SIGINT, signal.SIGTERM), **options):
        """Start a process that is ended with this system by these signals; its output goes to NAME.log."""
        options = {"log": self.directory / f"{name}.log", "env": self.environment, **options}
        process = Process(*command, **options)
        self.running.append((process, signals))
        return process

    def start_master(self):
        """A master alone, on simulated time; its process."""
        master = self.start("master", "rosmaster", "--core", "-p", self.port)
        self.wait(self.master.is_online, "the master", master)
        self.master.setParam("/use_sim_time", True)
        self.master.setParam("/run_id", "test")  # as roscore does; two launches at once would each choose one
        return master

    def wait(self, condition, what, *processes):
        """The first true value of a condition; these processes may not end or fail meanwhile."""

        def failed():
            return any(process.poll() not in (None, 0) for process in processes)

        return wait_for(
            condition, lambda: "\n".join([what, *(p.output[-3000:] for p in processes)]), poll=0.02, given_up=failed
        )

    def end_all(self, *kept):
        """End all processes but these, and kill what they have left behind."""
        for process, signals in reversed(self.running):
            if process not in kept:
                if process.stdin is not None:
                    process.stdin.close()
                process.end(*signals)
        self.running = [(process, signals) for process, signals in self.running if process in kept]
        while not kept and self.processes():
            for process in self.processes():
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)

    def processes(self, word=""):
        """Ids of all its processes with a word on their command line, nodes in sessions of their own included."""
        found = []
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):  # ended meanwhile, or another user's
                is_own = process.environ().get("ROS_HOME") == self.environment["ROS_HOME"]
                found += [process.pid] if is_own and word in "\0".join(process.cmdline()) else []
        return found

    # -- what the master and the nodes say --

    def latest(self, topic):
        """One message of a topic by `rostopic echo`."""
        command = ["rostopic", "echo", "-n", "1", topic]
        done = subprocess.run(command, env=self.environment, stdout=subprocess.PIPE, check=True, timeout=DEADLINE)
        return next(yaml.safe_load_all(done.stdout))

    def linked(self, node, partner, topic):
        """Whether a node has a connection with a partner on a topic, in either direction.

        Only for Python nodes: a C++ node, such as RViz, sometimes corrupts its heap when it is asked while it makes
        connections. Ask its partner instead.
        """
        try:
            with xmlrpc.client.ServerProxy(self.master.lookupNode(node)) as proxy:
                code, _, links = proxy.getBusInfo(CALLER)
            names = (partner, self.master.lookupNode(partner))
        except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
            return False
        return code == 1 and any(link[1] in names and link[4] == topic and link[5] for link in links)

    def subscriber(self, topic, prefix):
        """Name of a node that subscribes to a topic, by its prefix; None if there is none."""
        return self._registered(1, topic, prefix)

    def publisher(self, topic, prefix):
        """Name of a node that publishes a topic, by its prefix; None if there is none."""
        return self._registered(0, topic, prefix)

    def _registered(self, kind, name, prefix):
        try:
            nodes = dict(self.master.getSystemState()[kind]).get(name, [])
        except OSError:  # no master answers
            return None
        return next((node for node in nodes if node.startswith(prefix)), None)


class Program(System):
    """A system that one program starts, and that ends with it."""

    command = ("rosrun", "aro_robocop_goto_as")
    deadline = DEADLINE  # [s, wall] for any one condition, and for its end
    poll = 0.01  # [s, wall]

    def __init__(self, directory, *arguments, **environment):
        super().__init__(directory, {**os.environ, **environment})
        self.process = self.start("program", *self.command, *arguments, stdin=subprocess.DEVNULL, signals=())

    @property
    def output(self):
        """What it has written so far."""
        return self.process.output

    def wait_until(self, condition, what):
        """The first true value of a condition, while the program runs."""

        def problem():
            return f"{what} (exit status {self.process.poll()}): {self.output}"

        return wait_for(condition, problem, self.deadline, self.poll, given_up=lambda: self.process.poll() is not None)

    def wait_for_process(self, word):
        """The id of a process with this word on its command line, once there is one."""
        return self.wait_until(lambda: self.processes(word), f"{word} runs")[0]

    def wait_for_exit(self):
        """Its exit status; by then none of its processes may be left."""
        status = self.process.wait_for_exit(self.deadline)
        assert self.processes() == []
        return status
