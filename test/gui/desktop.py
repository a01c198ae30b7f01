"""For tests with real windows: an X server and a ROS system of their own, screen contents, mouse and keyboard.

Every wait is for a condition and has a deadline, long enough for a busy machine: reaching it always means a failure.
"""

import os
import re
import signal
import subprocess

import numpy as np
import yaml
from systems import Process, System
from waiting import DEADLINE


class Desktop:
    """An X server of its own: `with Desktop(directory) as desktop`."""

    def __init__(self, directory, screen="1280x860x24"):
        self.directory = directory
        self.screen = screen
        self.size = tuple(map(int, screen.split("x")[:2]))  # width, height [pixel]
        self.frame_buffer = directory / "Xvfb_screen0"

    def __enter__(self):
        from_server, to_us = os.pipe()
        # Without -noreset the server restarts when its last client leaves, and drops a client that connects meanwhile.
        command = ["Xvfb", "-displayfd", str(to_us), "-screen", "0", self.screen, "-fbdir", self.directory, "-noreset"]
        self.server = Process(*command, pass_fds=[to_us])
        os.close(to_us)
        with open(from_server) as chosen:
            display = chosen.readline().strip()
        assert display, f"Xvfb did not start: {self.server.output}"
        self.environment = {**os.environ, "DISPLAY": f":{display}", "LIBGL_ALWAYS_SOFTWARE": "1"}
        return self

    def __exit__(self, *_):
        self.server.end(signal.SIGTERM)

    def _run(self, *command):
        """Output of an X tool; empty when it fails, as for a window that was just closed."""
        return subprocess.run(
            command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=DEADLINE
        ).stdout

    def save_picture(self):
        """Save the whole screen as screenshot.png."""
        self._run("convert", f"xwd:{self.frame_buffer}", self.directory / "screenshot.png")

    def input(self, *actions):
        """Mouse and keyboard actions, as xdotool's arguments. The X server keeps their order: no pauses are needed."""
        subprocess.run(["xdotool", *map(str, actions)], env=self.environment, check=True, timeout=DEADLINE)

    def quit_by_menu(self, window):
        """Choose the last entry of a window's first menu."""
        x, y, _, _ = self.geometry(window)
        self.input("mousemove", x + 20, y + 10, "click", 1, "key", "Up", "key", "Return")

    def window(self, title):
        """Id of a visible window by its title, a regular expression; None if there is none."""
        found = self._run("xdotool", "search", "--onlyvisible", "--name", title).split()
        return int(found[0]) if found else None

    def canvas(self, window):
        """Id of the largest unnamed child of a window, which is the one OpenGL draws in; None if there is none."""
        sizes = {}
        for line in self._run("xwininfo", "-tree", "-id", str(window)).decode(errors="replace").splitlines():
            # as in "   0x600004 (has no name): ()  820x689+0+0  +404+102"
            found = re.match(r" +(0x[0-9a-f]+) \(has no name\).* (\d+)x(\d+)[+-]", line)
            if found:
                sizes[int(found[1], 16)] = int(found[2]) * int(found[3])
        return max(sizes, key=sizes.get, default=None)

    def geometry(self, window):
        """A window's x, y of the upper left corner on the screen, width and height [pixel]; zeros if it is gone."""
        lines = self._run("xdotool", "getwindowgeometry", "--shell", str(window)).decode().split()
        values = dict(line.split("=") for line in lines)
        return tuple(int(values.get(name, 0)) for name in ("X", "Y", "WIDTH", "HEIGHT"))

    def pixels(self, window):
        """The part of the screen that a window covers: (height, width, 3) red, green, blue from 0 to 255.

        Read from the X server's frame buffer, a file in xwd's format, so it neither disturbs nor waits for the
        window's program.
        """
        data = self.frame_buffer.read_bytes()
        header = np.frombuffer(data, dtype=">u4", count=25).tolist()  # fields as in X11/XWDFile.h
        start, rows, stride = header[0] + 12 * header[19], header[5], header[12]
        screen = np.frombuffer(data, np.uint8, rows * stride, start).reshape(rows, stride // 4, 4)
        x, y, wide, high = self.geometry(window)
        return screen[y : y + high, x : x + wide, 2::-1].astype(int)


class Ros(System):
    """The whole lab by roslaunch on a master of its own: `with Ros(directory, desktop, "rviz:=true") as ros`.

    After a failure a screenshot is saved before the windows are closed.
    """

    def __init__(self, directory, desktop, *arguments):
        super().__init__(directory, desktop.environment)
        self.desktop = desktop
        self.arguments = arguments

    def __enter__(self):
        try:
            self.launch()
        except BaseException:
            self.end_all()
            raise
        return self

    def launch(self):
        """Start the master and what comes with it; its process. May be called again when that has ended."""
        launch = self.start("roslaunch", *self.command())
        self.wait(self.master.is_online, "a ROS master", launch)
        return launch

    def command(self):
        """What starts the master."""
        return ["roslaunch", "-p", self.port, "aro_robocop_goto_as", "robocop_goto_as.launch", *self.arguments]

    def __exit__(self, failure, *_):
        try:
            if failure:
                self.desktop.save_picture()
        finally:
            self.end_all()


class Master(Ros):
    """Only a ROS master, on simulated time: `with Master(directory, desktop) as ros`."""

    def launch(self):
        """Start the master; its process."""
        return self.start_master()


class Recorder:
    """All messages of a topic from a publisher, by `rostopic echo`."""

    def __init__(self, ros, publisher, topic):
        self.ros, self.publisher, self.topic = ros, publisher, topic
        name = f"echo{topic.replace('/', '_')}_{len(ros.running)}"  # a topic may be recorded several times
        self.process = ros.start(name, "rostopic", "echo", topic, stderr=subprocess.DEVNULL)

    def connected(self):
        """Whether the publisher is connected."""
        node = self.ros.subscriber(self.topic, f"/rostopic_{self.process.pid}_")
        return node is not None and self.ros.linked(node, self.publisher, self.topic)

    def messages(self):
        """The messages received so far, as dictionaries."""
        return [yaml.safe_load(text) for text in self.process.output.split("\n---\n")[:-1]]
