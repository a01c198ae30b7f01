"""Right solutions: whole files, and a base with changes that the handout allows."""

from pathlib import Path
from typing import Tuple

HERE = Path(__file__).resolve().parent
SERVER, BRIDGE = "base_server.py.in", "base_bridge.py.in"
Changes = Tuple[Tuple[str, str], ...]  # what is replaced, and by what


def changed(name, base, changes):
    """The source of a base with changes."""
    text = (HERE / base).read_text()
    for old, new in changes:
        assert text.count(old) >= 1, f"{name}: {old!r} is not in {base}"
        text = text.replace(old, new)
    return text


TURN = "self.drive(0.0, max(-0.8, min(0.8, 2.0 * angle_error)))"
DRIVE = "self.drive(0.2, 0.0)"
OBSTACLE = "elif self.min_dist_ahead < 0.3:"
ABORT = f"{OBSTACLE}\n                success = False\n                break"
RATE = "        rate = rospy.Rate(10)\n"
SLEEP = "            rate.sleep()\n"
IMPORT = "import math\n"
SUBSCRIBERS = """        rospy.Subscriber('/odom', Odometry, self.odom_cb)
        rospy.Subscriber('/scan', LaserScan, self.scan_cb)
"""
POSE_READ = "            x, y, yaw = self.pose\n"
PUBLISH = "            self.server.publish_feedback(feedback)\n"

CHANGED = {
    # At the robot's limits and twice as often as in the handout's example; only beams within 15 degrees count as ahead;
    # prints exceptions that it has caught.
    "fast_and_often": (
        (TURN, TURN.replace("0.8", "1.6")),
        (DRIVE, "self.drive(0.22, 0.0)"),
        (RATE, "        rate = rospy.Rate(20)\n"),
        ("ranges[:30], ranges[-30:]", "ranges[:16], ranges[-15:]"),
        (IMPORT, f"{IMPORT}import traceback\n"),
        (
            POSE_READ,
            "            try:\n                {}['no transform yet']\n"
            f"            except KeyError:\n                traceback.print_exc()\n{POSE_READ}",
        ),
    ),
    # Drives and turns slowly, paced by the wall clock: time.sleep instead of a Rate. Interprets the handout so that an
    # obstacle ahead aborts the goal also while the robot turns.
    "slow_by_the_wall_clock": (
        (TURN, "self.drive(0.0, math.copysign(0.25, angle_error))"),
        (DRIVE, "self.drive(0.06, 0.0)"),
        (IMPORT, f"{IMPORT}import time\n"),
        (RATE, ""),
        (SLEEP, "            time.sleep(0.1)\n"),
        (
            "            if abs(angle_error) > 0.1:",
            "            if self.min_dist_ahead < 0.3:\n                break\n            if abs(angle_error) > 0.1:",
        ),
        (f"            {ABORT}\n", ""),
    ),
    # Corrects its heading while driving if the error is within 0.1 rad, slows down towards the goal, and publishes a
    # command only if it differs from the last one.
    "steers_continuously": (
        (DRIVE, "self.drive(min(0.2, 0.05 + 0.4 * position_error), 1.5 * angle_error)"),
        (
            "    def drive(self, v, w):\n",
            "    last = None\n\n    def drive(self, v, w):\n        if (v, w) == self.last:\n            return\n"
            "        self.last = v, w\n",
        ),
    ),
    # The loop is a coroutine, paced by asyncio.sleep in the main thread's event loop.
    "asyncio_loop": (
        (IMPORT, f"import asyncio\n{IMPORT}"),
        ("        self.pose = None\n", "        self.loop = asyncio.new_event_loop()\n        self.pose = None\n"),
        (
            RATE,
            "        asyncio.run_coroutine_threadsafe(self.execute(goal), self.loop).result()\n\n"
            "    async def execute(self, goal):\n",
        ),
        (SLEEP, "            await asyncio.sleep(0.1)\n"),
        ("    rospy.spin()\n", "    node.loop.run_forever()\n"),
    ),
    # Stands still for a second between turning and driving.
    "pauses_before_driving": (
        (RATE, f"{RATE}        pause = 0\n"),
        (TURN, f"pause = 10\n                {TURN}"),
        (
            "            else:\n                self.drive(0.2",
            "            elif pause:\n                pause -= 1\n                self.stop()\n"
            "            else:\n                self.drive(0.2",
        ),
    ),
    # Commands at 100 Hz, each of them logged; feedback at 10 Hz.
    "hundred_hertz": (
        (
            "        self.cmd_pub.publish(msg)\n",
            "        rospy.loginfo('command %.3f m/s %.3f rad/s, nearest %.3f m', v, w, self.min_dist_ahead)\n"
            "        rospy.logdebug('pose %s', self.pose)\n        self.cmd_pub.publish(msg)\n",
        ),
        (RATE, "        rate = rospy.Rate(100)\n"),
        (PUBLISH, f"            self.count += 1\n            if self.count % 10 == 1:\n    {PUBLISH}"),
    ),
    # The loop is a generator; a Timer takes its next step, and the execute callback waits for its end.
    "timer_generator": (
        (IMPORT, f"{IMPORT}import threading\n"),
        (
            RATE,
            "        steps, done = self.execute(goal), threading.Event()\n\n"
            "        def step(_event):\n            if not done.is_set() and next(steps, 'end') == 'end':\n"
            "                done.set()\n\n"
            "        timer = rospy.Timer(rospy.Duration(0.1), step)\n"
            "        while not done.wait(0.05):\n            pass\n"
            "        timer.shutdown()\n\n    def execute(self, goal):\n",
        ),
        (SLEEP, "            yield\n"),
    ),
    # Odometry and scan are got by rospy.wait_for_message in the loop, which has no Rate.
    "wait_for_message": (
        (SUBSCRIBERS, ""),
        (RATE, ""),
        (
            POSE_READ,
            "            self.odom_cb(rospy.wait_for_message('/odom', Odometry))\n"
            f"            self.scan_cb(rospy.wait_for_message('/scan', LaserScan, timeout=1.0))\n{POSE_READ}",
        ),
        (SLEEP, ""),
    ),
    # Odometry and scan are got by rospy.wait_for_message in two threads of an executor.
    "wait_for_message_executor": (
        (IMPORT, f"{IMPORT}from concurrent.futures import ThreadPoolExecutor\n"),
        (SUBSCRIBERS, "        self.executor = ThreadPoolExecutor(2)\n"),
        (RATE, ""),
        (
            POSE_READ,
            "            odom = self.executor.submit(rospy.wait_for_message, '/odom', Odometry)\n"
            "            scan = self.executor.submit(rospy.wait_for_message, '/scan', LaserScan)\n"
            f"            self.odom_cb(odom.result())\n            self.scan_cb(scan.result(timeout=2.0))\n{POSE_READ}",
        ),
        (SLEEP, ""),
    ),
}

RIGHT = {
    **{
        path.name[: -len(".py.in")]: path.read_text()
        for path in sorted([*HERE.glob("base_*.py.in"), *(HERE / "right").glob("*.py.in")])
    },
    **{name: changed(name, SERVER, changes) for name, changes in CHANGED.items()},
}
