"""A ROS master of its own, and the processes that a test starts on it, each with its output in files."""

import contextlib
import os
import signal
import subprocess
import xmlrpc.client

import rosgraph
import yaml
from waiting import DEADLINE, wait_for

from aro_robocop_goto_as.process.ports import free_port

END_TIMEOUT = 40.0  # [s, wall] for a process to end; roslaunch needs 17 s to kill a node that does not end
CALLER = "/system_test"


def end(process, *signals):
    """Send one signal after the other, SIGKILL last, until the process has ended; its exit status."""
    for number in (*signals, signal.SIGKILL):
        if process.poll() is None:
            process.send_signal(number)
        with contextlib.suppress(subprocess.TimeoutExpired):
            return process.wait(END_TIMEOUT)
    raise AssertionError(f"process {process.pid} outlived SIGKILL: {process.args}")


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
        """Start a process that is ended with this system by these signals; its output goes to NAME.log and NAME.err."""
        log, errors = (self.directory / f"{name}.{kind}" for kind in ("log", "err"))
        with open(log, "wb") as out, open(errors, "wb") as err:
            options = {"stdout": out, "stderr": err, "env": self.environment, **options}
            process = subprocess.Popen(list(map(str, command)), **options)
        process.text = lambda: log.read_text(errors="replace") + errors.read_text(errors="replace")
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
            condition, lambda: "\n".join([what, *(p.text()[-3000:] for p in processes)]), poll=0.02, given_up=failed
        )

    def end_all(self, *kept):
        """End all processes but these."""
        for process, signals in reversed(self.running):
            if process not in kept:
                if process.stdin is not None:
                    process.stdin.close()
                end(process, *signals)
        self.running = [(process, signals) for process, signals in self.running if process in kept]

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

    def offers(self, service):
        """Whether a node offers a service."""
        return self._registered(2, service, "/") is not None

    def _registered(self, kind, name, prefix):
        try:
            nodes = dict(self.master.getSystemState()[kind]).get(name, [])
        except OSError:  # no master answers
            return None
        return next((node for node in nodes if node.startswith(prefix)), None)
