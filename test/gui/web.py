"""The web page's node beside a running lab, and what the simulator says is true."""

import http.client
import os
import socket
import subprocess

from desktop import Ros
from waiting import DEADLINE, wait_for

from robocop_hosting.ports import free_port

READY = r"stage_4[\s\S]*server\s+ready"  # of simulator and bridge
REACHED = 0.17  # [m] from the goal: the server's tolerance, the error of a click, and the drift of odometry


class NoDesktop:
    """Stands in for a Desktop: the page needs none."""

    environment = dict(os.environ)

    def save_picture(self):
        """Nothing to save."""


class Web:
    """The lab without RViz, and robocop_web. Commands hold until the next one: nothing but the page stops the robot."""

    system = Ros

    def __init__(self, directory, *arguments):
        self.ros = self.system(directory, NoDesktop(), "rviz:=false", "cmd_vel_timeout:=0", *arguments)
        self.port = free_port()
        self.url = f"http://localhost:{self.port}"

    def start(self, *arguments):
        """Start robocop_web; returns its process when it answers."""
        command = ("rosrun", "aro_robocop_goto_as", "robocop_web.py", f"web_port:={self.port}", *arguments)
        process = self.ros.start("web", *command)
        wait_for(self.answers, "robocop_web answers")
        return process

    def answers(self):
        """Whether its port accepts connections."""
        with socket.socket() as probe:
            return probe.connect_ex(("localhost", self.port)) == 0

    def status(self, path="/", **headers):
        """The status of the answer to an HTTP request; 101 = the page's WebSocket is opened."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=DEADLINE)
        try:
            connection.request("GET", path, headers=headers)
            return connection.getresponse().status
        finally:
            connection.close()

    def _truth(self, robot):
        return self.ros.latest(f"/{robot}/ground_truth_odom" if robot else "/ground_truth_odom")

    def position(self, robot=""):
        """A robot's true x, y [m] in the world."""
        position = self._truth(robot)["pose"]["pose"]["position"]
        return position["x"], position["y"]

    def turn(self, robot=""):
        """A robot's true angular velocity [rad/s]; the tests turn it on the spot, where no wall is in its way."""
        return self._truth(robot)["twist"]["twist"]["angular"]["z"]

    def stands(self, robot=""):
        """Whether a robot is truly at rest."""
        twist = self._truth(robot)["twist"]["twist"]
        return abs(twist["linear"]["x"]) < 0.01 and abs(twist["angular"]["z"]) < 0.05

    def place(self, x, y):
        """Put the robot somewhere in the map [m]."""
        pose = f"{{header: {{frame_id: map}}, pose: {{position: {{x: {x}, y: {y}}}, orientation: {{w: 1.0}}}}}}"
        self._run("rosservice", "call", "/robocop_sim/set_pose", f"{{pose: {pose}}}")

    def set_factor(self, factor):
        """Set the real-time factor."""
        self._run("rosrun", "dynamic_reconfigure", "dynparam", "set", "/robocop_sim", "real_time_factor", str(factor))

    def _run(self, *command):
        subprocess.run(command, env=self.ros.environment, check=True, timeout=DEADLINE, stdout=subprocess.DEVNULL)

    def sim(self):
        """The simulator's newest report."""
        return self.ros.latest("/robocop_sim/status")
