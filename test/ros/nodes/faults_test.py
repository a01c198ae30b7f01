"""When the server or the simulator ends, each goal ends once, the robot stops, and the next goal is reached.

What goes wrong with odometry, scans and goals is in server_test.py and test/unit/ros/server.
"""

import psutil
import rospy
from harness import ACTION, SERVER, SIMULATOR, SystemTest, call_simulator, script, wait_for, wait_for_connection
from systems import Process

SCRIPTS = {SIMULATOR: "robocop_sim.py", SERVER: "robocop_goto_as.py"}
MODE = ("_sync:=lockstep", "_real_time_factor:=10", "_drive:=kinematic", "_lockstep_timeout:=0.5", "_world:=empty")
TOPICS = {  # that each node sends to this one, and that it receives
    SIMULATOR: (("odom", "ground_truth_odom"), ()),
    SERVER: (
        ("cmd_vel", "/rosout", *(f"{ACTION}/{name}" for name in ("status", "feedback", "result"))),
        (f"{ACTION}/goal", f"{ACTION}/cancel"),
    ),
}
FAR = (2.0, 0.0)  # in odom [m]: free way for ten simulated seconds
MAX_GROWTH = 3  # threads, and files: those of a connection that is being opened


class Faults(SystemTest):
    @classmethod
    def setUpClass(cls):
        cls.nodes = {}
        cls.addClassCleanup(cls.end_nodes)
        for node in SCRIPTS:
            cls.start(node)
        super().setUpClass()

    @classmethod
    def start(cls, node):
        """Start a node; the former one of this name, if any."""
        former = cls.nodes.get(node)
        cls.nodes[node] = Process(script(SCRIPTS[node]), f"__name:={node[1:]}", *(MODE if node == SIMULATOR else ()))
        return former

    @classmethod
    def end_nodes(cls):
        for node in reversed(list(cls.nodes.values())):
            node.__exit__()

    def restart(self, node):
        """Start a node that has ended, and wait until it serves this one."""
        former = self.start(node)
        self.assertIsNotNone(former.poll())
        self.wait_until_connected(node)

    def wait_until_connected(self, node):
        sent, received = TOPICS[node]
        for topic in sent:
            wait_for_connection(node, topic)
        for topic in received:
            wait_for_connection(node, topic, received=True)

    def tearDown(self):
        super().tearDown()
        self.robot.wait_until_it_stands()
        self.robot.reset()
        self.goals.send(0.2, 0.1).result("REACHED")
        for name, node in self.nodes.items():
            self.assertIsNone(node.poll(), f"{name} has ended: {node.output}")
            self.assertNotIn("Traceback", node.output)

    def drive(self):
        """A goal to which the robot drives."""
        goal = self.goals.send(*FAR)
        self.robot.wait_until_it_drives(0.1)
        return goal

    def test_server_is_killed(self):
        goal = self.drive()
        self.nodes[SERVER].kill()
        self.nodes[SERVER].wait_for_exit()
        self.robot.wait_for_standstill()
        self.assertEqual(goal.results(), [])
        self.restart(SERVER)
        self.goals.clear()
        self.drive()

    def test_server_is_told_to_end_while_the_clock_is_stopped(self):
        goal = self.drive()
        call_simulator("pause")
        self.addCleanup(call_simulator, "unpause")
        self.nodes[SERVER].terminate()
        self.assertIn("the server is shutting down", goal.result("SHUTDOWN").result.message)
        self.assertEqual(self.nodes[SERVER].wait_for_exit(), 0)
        call_simulator("unpause")
        self.robot.wait_until_it_stands()
        self.restart(SERVER)

    def test_goto_says_that_its_goal_is_recalled_after_one_that_was_stamped_in_the_future(self):
        self.goals.send(0.1, 0.0, stamp=rospy.Time(1_700_000_000)).result("REACHED")
        with Process(script("robocop_goto.py"), 0.2, 0.0, "--frame", "odom") as command:
            self.assertEqual(command.wait_for_exit(), 1)
        self.assertIn("RECALLED: This goal was canceled because another goal was received", command.output)
        self.nodes[SERVER].terminate()
        self.assertEqual(self.nodes[SERVER].wait_for_exit(), 0)
        self.restart(SERVER)

    def test_simulator_is_killed_and_the_server_ends_when_time_starts_again(self):
        goal = self.drive()
        self.nodes[SIMULATOR].kill()
        self.nodes[SIMULATOR].wait_for_exit()
        self.restart(SIMULATOR)
        goal.result("SHUTDOWN")
        self.assertEqual(self.nodes[SERVER].wait_for_exit(), 1)
        self.assertRegex(self.nodes[SERVER].output, r"CLOCK: simulated time was set back from \d+\.\d to \d+\.\d s")
        self.restart(SERVER)
        self.goals.clear()  # also the error in the log

    def test_goals_leave_no_threads_or_files_behind(self):
        before = self.usage()
        for number in range(30):
            self.goals.send(0.1, 0.1 * (number % 2)).result("REACHED")
        wait_for(
            lambda: all(new <= old + MAX_GROWTH for old, new in zip(before, self.usage())),
            lambda: f"as many threads and files as {before}; there are {self.usage()}",
        )

    def usage(self):
        processes = [psutil.Process(node.pid) for node in self.nodes.values()]
        return [count for process in processes for count in (process.num_threads(), process.num_fds())]
