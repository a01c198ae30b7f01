"""What docs/ tells the reader to type works in a running system: shell commands as printed, Python as one session."""

import itertools
import sys
import unittest

from documentation import blocks, commands
from harness import Robot, wait_for
from systems import Process

# Commands, and headings of Python sections, that are not run here.
EXCEPTIONS = {
    "3. A server": "serves until it is interrupted",
    "rostopic echo -n 2 /my_action/": "shows the feedback of section 3's server",
    "rosrun actionlib_tools axclient.py": "is a window, which test/gui opens",
}
ONCE = (
    "rosmsg",
    "rosrun dynamic_reconfigure",
    "rosrun aro_robocop_goto_as robocop_goto.py",
    "rosservice",
    "rostopic list",
    "rostopic pub",
)
ENDLESS = ("rostopic echo",)
PROGRAMS = ("rosmsg", "rosservice", "rostopic", "rosrun")


def excepted(text):
    return any(text.startswith(exception) for exception in EXCEPTIONS)


def python_sections():
    """The Python programs of docs/lab.md: the blocks of each group of headings that share a session."""
    lab = [block for block in blocks() if block.language == "python" and block.place.startswith("lab.md")]
    for heading, group in itertools.groupby(lab, key=lambda block: block.heading):
        yield heading, "\n".join(line for block in group for line in block.lines)


class DocumentedCommands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()

    def setUp(self):
        self.robot.reset()

    def shell(self, command):
        return Process("bash", "-c", command)

    def test_every_shell_command_works(self):
        printed = [command for command in commands(*PROGRAMS) if not excepted(command)]
        endless = {command: self.shell(command) for command in printed if command.startswith(ENDLESS)}
        once = [command for command in printed if command.startswith(ONCE)]
        self.assertEqual(sorted([*endless, *once]), sorted(printed), "a command of another kind")
        self.assertGreater(len(once), 5)
        try:
            for command in once:
                with self.shell(command) as process:
                    self.assertEqual(process.wait_for_exit(), 0, f"{command}: {process.output}")
                self.assertNotIn("success: False", process.output, command)
            for command, process in endless.items():
                wait_for(lambda process=process: process.output, f"output of {command}")
        finally:
            for process in endless.values():
                process.__exit__()

    def test_every_python_section_runs(self):
        sections = [(heading, text) for heading, text in python_sections() if not excepted(heading)]
        self.assertGreater(len(sections), 2)
        for heading, text in sections:
            with Process(sys.executable, "-c", text) as process:
                self.assertEqual(process.wait_for_exit(), 0, f"{heading}: {process.output}")
