"""`./robocop teleop`: the robot moves only while a key is held. The simulator itself never stops it here."""

import os
import pty
import signal
import termios
import unittest

from harness import Robot, script, wait_for
from systems import Process

TURNS = 0.5  # [rad/s]
MOVES = 0.05  # [m/s]


class Terminal:
    """`robocop teleop` in a terminal: `press` sends keys to it."""

    def __init__(self, *arguments):
        self.keyboard, self.screen = pty.openpty()
        self.settings = termios.tcgetattr(self.screen)
        self.program = Process(script("robocop_teleop.py"), *arguments, stdin=self.screen)

    def __enter__(self):
        self.program.__enter__()
        wait_for(lambda: "Ctrl-C quits" in self.program.output, lambda: f"teleop is ready: {self.program.output}")
        return self

    def __exit__(self, *failure):
        self.program.__exit__(*failure)
        os.close(self.screen)
        self.hang_up()

    def press(self, keys):
        os.write(self.keyboard, keys.encode())

    def hang_up(self):
        if self.keyboard is not None:
            os.close(self.keyboard)
            self.keyboard = None


class Teleop(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.nobodys = Terminal("--robot", "nobody")  # here, because it waits for a while
        cls.addClassCleanup(cls.nobodys.__exit__)

    def setUp(self):
        self.robot.reset()

    def hold_until(self, terminal, key, moved):
        """Repeat a key, as a keyboard does, until the robot's true twist shows it."""

        def repeat():
            terminal.press(key)
            return moved(self.robot.truth.newest().twist.twist)

        wait_for(repeat, f"the robot moves by {key!r}")

    def test_robot_drives_while_a_key_is_held_and_stops_when_it_is_released(self):
        with Terminal() as terminal:
            self.hold_until(terminal, "w", lambda twist: twist.linear.x > MOVES)
            self.robot.wait_until_it_stands()
            self.hold_until(terminal, "\x1b[C", lambda twist: twist.angular.z < -TURNS)
            self.robot.wait_until_it_stands()

    def test_interrupt_stops_the_robot_and_restores_the_terminal(self):
        with Terminal() as terminal:
            self.hold_until(terminal, "a", lambda twist: twist.angular.z > TURNS)
            terminal.program.send_signal(signal.SIGINT)
            self.assertEqual(terminal.program.wait_for_exit(), 0, terminal.program.output)
            self.assertEqual(termios.tcgetattr(terminal.screen), terminal.settings)
        self.robot.wait_until_it_stands()
        self.assertNotIn("Traceback", terminal.program.output)

    def test_closed_terminal_stops_the_robot(self):
        with Terminal() as terminal:
            self.hold_until(terminal, "d", lambda twist: twist.angular.z < -TURNS)
            terminal.hang_up()
            self.assertEqual(terminal.program.wait_for_exit(), 0, terminal.program.output)
        self.robot.wait_until_it_stands()

    def test_robot_that_is_not_there_is_reported(self):
        program = self.nobodys.program
        self.assertEqual(program.wait_for_exit(), 1)
        self.assertIn("nobody subscribes to /nobody/cmd_vel", program.output)
