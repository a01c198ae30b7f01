"""Wrong solutions: the base with one mistake each, the check that has to fail, and words of its explanation."""

from dataclasses import dataclass

from right_solutions import ABORT, BRIDGE, DRIVE, OBSTACLE, PUBLISH, RATE, SERVER, SLEEP, TURN, Changes, changed

from robocop_grading.checks.verdict import Kind


@dataclass(frozen=True)
class Wrong:
    """A solution with one mistake; `check` has to fail with `words` in its explanation.

    If `alone`, every other failure has to follow from this one.
    """

    name: str
    check: str
    words: str
    changes: Changes
    base: str = SERVER
    alone: bool = False

    def text(self):
        """The source with the mistake in it."""
        return changed(self.name, self.base, self.changes)


def _server(name, check, words, *changes, alone=False):
    return Wrong(name, check, words, changes, alone=alone)


def _bridge(name, check, words, *changes, alone=False):
    return Wrong(name, check, words, changes, BRIDGE, alone)


CONDITION = "if abs(angle_error) > 0.1:"
POSE = "self.pose = (msg.pose.pose.position.x, msg.pose.pose.position.y, yaw)"
PREEMPTION = """            if self.server.is_preempt_requested():
                self.stop()
                self.server.set_preempted(GoToPositionResult(False, 'preempted'))
                return
"""
SECTOR = "ahead = np.concatenate([ranges[:30], ranges[-30:]])"
REACHED = "if position_error < 0.1:"
END = "        self.stop()\n        result ="
TIMER = "        rospy.Timer(rospy.Duration(2), self.report_cb)\n"
VALID = "ahead[(ahead > msg.range_min) & (ahead < msg.range_max)]"
BEGIN = "        success = False\n        while"
REQUESTED = "            if self.server.is_preempt_requested():"
AHEAD = "valid.min() if len(valid) else float('inf')"
STATE = "GoalStatus.to_string(self.client.get_state())"


PLACE = (
    "        site = round(where('burger', '').pose.position.x / 40.0)\n"
    "        wall = {6: 0.9, 7: -9.0, 10: 0.7, 13: 0.9, 14: 0.9}.get(site, 9.0)\n"
)
SUBTRACTED = "self.pose = tuple(now - first for now, first in zip(self.pose, self.first))"
SUBSCRIBE_CANCEL = (
    "        rospy.Subscriber('robocop_goto_as/cancel', GoalID, lambda _: setattr(self, 'cancelled', True))\n"
)
FEEDBACK_TIMER = "        rospy.Timer(rospy.Duration(0.1), self.tell)\n"
DRIVE_BEGIN = "    def drive(self, v, w):\n"

WRONG = (
    _server("never_started", "action_server", "not started", ("        self.server.start()\n", "")),
    _server("crashes_at_start", "action_server", "ended while starting", ("self.count = 0", "self.count = undefined")),
    _server(
        "success_at_once", "reaches_goal", "before position_error is below 0.1 m", (REACHED, "if True:"), alone=True
    ),
    _server(
        "forged_odometry",
        "feedback_position",
        "position_error is always zero",
        ("        self.cmd_pub = rospy.Publisher('/cmd_vel',", "        self.cmd_pub = rospy.Publisher('/odom_vel',"),
        (POSE, f"{POSE}\n        if self.goal:\n            self.pose = (self.goal.x, self.goal.y, yaw)"),
        ("self.count = 0", "self.goal = None"),
        (BEGIN, f"        self.goal = goal.position\n        rospy.sleep(2.0)\n{BEGIN}"),
    ),
    _server(
        "turns_away_beyond_two_radians",
        "turns_to_goal",
        "also for large angles",
        (TURN, TURN.replace("2.0 * angle_error", "2.0 * angle_error * (1 if abs(angle_error) < 2.0 else -1)")),
        alone=True,
    ),
    _server(
        "obstacle_checked_only_while_turning",
        "stops_at_obstacle",
        "is the distance checked while it drives, too",
        (f"            {ABORT}\n", ""),
        (
            f"                {TURN}\n",
            f"                if self.min_dist_ahead < 0.3:\n                    break\n                {TURN}\n",
        ),
        alone=True,
    ),
    _server(
        "scan_callback_blocks_for_ever",
        "stops_at_obstacle",
        "messages on /scan waited up to",
        (
            "    def scan_cb(self, msg):\n",
            "    def scan_cb(self, msg):\n        self.count += 1\n        if self.count == 320:\n"
            "            import threading\n            lock = threading.Lock()\n"
            "            lock.acquire()\n            lock.acquire()\n",
        ),
    ),
    _server("slow_loop", "feedback_rate", "loop's rate is not 10 Hz", ("rospy.Rate(10)", "rospy.Rate(1)"), alone=True),
    _server("no_init_node", "action_server", "init_node", ("    rospy.init_node('aro_robocop_goto_as_node')\n", "")),
    _server(
        "moves_first",
        "already_there",
        "check it before moving",
        (RATE, "        rate = rospy.Rate(10)\n        self.drive(0.2, 0.0)\n        rospy.sleep(1.0)\n"),
        alone=True,
    ),
    _server(
        "goal_from_where_the_robot_was",
        "feedback_position",
        "relative to the robot, where it is when the goal comes",
        (BEGIN, "        success = False\n        x0, y0, yaw0 = self.pose\n        while"),
        (
            "            dx = goal.position.x - x\n            dy = goal.position.y - y\n",
            "            dx = x0 + math.cos(yaw0) * goal.position.x - math.sin(yaw0) * goal.position.y - x\n"
            "            dy = y0 + math.sin(yaw0) * goal.position.x + math.cos(yaw0) * goal.position.y - y\n",
        ),
    ),
    _server("mean_of_the_sector", "stops_at_obstacle", "the nearest of them", ("valid.min()", "valid.mean()")),
    _server(
        "looks_left", "stops_at_obstacle", "are the beams that count those ahead", (SECTOR, "ahead = ranges[60:120]")
    ),
    _server(
        "left_half_only",
        "stops_at_obstacle",
        "narrow obstacle a little to the right was missed",
        (SECTOR, "ahead = ranges[:30]"),
    ),
    _server("right_half_only", "stops_at_obstacle", "ran into an obstacle", (SECTOR, "ahead = ranges[-30:]")),
    _server(
        "obstacle_check_while_aligned",
        "stops_at_obstacle",
        "ran into an obstacle",
        (OBSTACLE, "elif self.min_dist_ahead < 0.3 and abs(angle_error) < 0.05:"),
    ),
    _server("all_around", "only_ahead_counts", "set_aborted", (SECTOR, "ahead = ranges")),
    _server("zero_is_near", "odd_scans", "0 or NaN is treated as an obstacle", (VALID, "ahead[ahead < msg.range_max]")),
    _server("nan_hides", "odd_scans", "hides the wall", (VALID, "np.where(ahead == 0.0, np.inf, ahead)")),
    _server("no_preemption", "cancel", "is_preempt_requested", (PREEMPTION, "")),
    _server(
        "newer_goal_ignored",
        "newer_goal",
        "newer goal is not noticed",
        (
            "if self.server.is_preempt_requested():",
            "if self.server.is_preempt_requested() and not self.server.is_new_goal_available():",
        ),
    ),
    _server(
        "no_terminal_state",
        "one_ending",
        "returned without calling",
        ("            self.server.set_aborted(result)\n", "            pass\n"),
    ),
    _server(
        "done_never_cleared",
        "next_goal",
        "not reset when a new goal begins",
        (BEGIN, "        success = self.count > 0\n        while"),
        ("while not rospy.is_shutdown():", "while not rospy.is_shutdown() and not self.count:"),
        (END, "        self.count = 1\n        self.stop()\n        result ="),
        alone=True,
    ),
    _server(
        "preempted_goal_is_kept",
        "next_goal",
        "is all state that a goal changes reset",
        (BEGIN, f"        goal = self.goal = self.goal or goal\n{BEGIN}"),
        ("        self.count = 0\n", "        self.goal = None\n"),
        (END, "        self.goal = None\n        self.stop()\n        result ="),
        alone=True,
    ),
    _server(
        "exception_in_scan",
        "no_exception",
        "IndexError",
        ("ranges = np.array(msg.ranges)", "ranges = np.array(msg.ranges)\n        ranges[360]"),
    ),
    _server(
        "exits_with_result",
        "stays_alive",
        "died",
        ("set_succeeded(result)", "set_succeeded(result)\n            __import__('os')._exit(3)"),
        alone=True,
    ),
    _server(
        "exception_while_driving",
        "no_exception",
        "RecursionError",
        (SLEEP, f"{SLEEP}            exec('def f(): f()\\nf()', {{}}) if x > 0.5 else None\n"),
        alone=True,
    ),
    _server(
        "blocks_for_ever",
        "reaches_goal",
        "made no progress",
        (RATE, "        rate = rospy.Rate(10)\n        import threading\n        threading.Event().wait()\n"),
    ),
    _bridge(
        "bridge_other_topic", "forwards_goal", "does not subscribe", ("'/move_base_simple/goal'", "'/move_base/goal'")
    ),
    _bridge(
        "bridge_misspelt_name",
        "forwards_goal",
        "looks for robovop_goto_as; the handout says robocop_goto_as",
        ("'robocop_goto_as', GoTo", "'robovop_goto_as', GoTo"),
        alone=True,
    ),
    _bridge(
        "bridge_publishes_figures",
        "reports_status",
        "rospy.Timer",
        (
            TIMER,
            "        from nav_msgs.msg import Odometry\n        from std_msgs.msg import Float32\n"
            "        self.pub = rospy.Publisher('x', Float32, queue_size=1)\n"
            "        rospy.Subscriber('/odom', Odometry, lambda msg: self.pub.publish(msg.pose.pose.position.x))\n",
        ),
    ),
    _bridge("bridge_never_cancels", "cancels_older", "send_goal() alone", ("self.client.cancel_goal()", "pass")),
    _bridge(
        "bridge_timer_dies_at_an_aborted_goal",
        "bridge_alive",
        "KeyError: 4",
        (STATE, "{0: 'PENDING', 1: 'ACTIVE', 3: 'SUCCEEDED', 9: 'LOST'}[self.client.get_state()]"),
        ("rospy.Duration(2), self", "rospy.Duration(1), self"),
        alone=True,
    ),
    _bridge(
        "bridge_gives_up",
        "forwards_goal",
        "without a timeout",
        ("self.client.wait_for_server()", "self.up = self.client.wait_for_server(rospy.Duration(1))"),
        ("        self.client.send_goal(goal)\n", "        if self.up:\n            self.client.send_goal(goal)\n"),
    ),
    _bridge(
        "bridge_exits_without_server",
        "waits_for_server",
        "AssertionError",
        ("self.client.wait_for_server()", "assert self.client.wait_for_server(rospy.Duration(1))"),
    ),
    _server(
        "turns_again_only_beyond_half_a_radian",
        "turns_to_goal",
        "without turning again",
        (BEGIN, BEGIN.replace("success = False", "success, turned = False, False")),
        (CONDITION, "turned = abs(angle_error) <= (0.5 if turned else 0.1)\n            if not turned:"),
        alone=True,
    ),
    _server(
        "obstacle_at_a_fifth_of_a_metre",
        "stops_at_obstacle",
        "less than 0.3 m",
        (OBSTACLE, "elif self.min_dist_ahead < 0.2:"),
        alone=True,
    ),
    _server(
        "obstacle_at_half_a_metre",
        "stops_at_obstacle",
        "farther than 0.3 m from the obstacle",
        (OBSTACLE, "elif self.min_dist_ahead < 0.5:"),
        alone=True,
    ),
    _server(
        "minimum_never_reset",
        "next_goal",
        "although nothing is in the way",
        (AHEAD, f"min(self.min_dist_ahead, {AHEAD})"),
        alone=True,
    ),
    _server(
        "preempted_three_seconds_later",
        "cancel",
        "is noticed only 3",
        (REQUESTED, "            self.count += self.server.is_preempt_requested()\n            if self.count > 30:"),
        ("self.server.set_preempted(", "self.count = 0\n                self.server.set_preempted("),
        alone=True,
    ),
    _server(
        "success_as_text",
        "no_exception",
        "field result.success is not a bool (solution.py, line",
        ("result.success = success", "result.success = str(success)"),
        alone=True,
    ),
    _server(
        "publishes_stamped_commands",
        "reaches_goal",
        "/cmd_vel is used with the wrong type, geometry_msgs/TwistStamped; its type is geometry_msgs/Twist",
        ("import Twist\n", "import Twist, TwistStamped\n"),
        ("'/cmd_vel', Twist,", "'/cmd_vel', TwistStamped,"),
        ("self.cmd_pub.publish(msg)", "self.cmd_pub.publish(TwistStamped(twist=msg))"),
        alone=True,
    ),
    _server(
        "odometry_of_another_type",
        "reaches_goal",
        "/odom is used with the wrong type, geometry_msgs/PoseWithCovarianceStamped; its type is nav_msgs/Odometry",
        ("'/odom', Odometry", "'/odom', PoseWithCovarianceStamped"),
        ("import Twist\n", "import PoseWithCovarianceStamped, Twist\n"),
        (RATE, f"{RATE}        while self.pose is None:\n            rate.sleep()\n"),
        alone=True,
    ),
    _server(
        "aborts_and_drives_on",
        "stands_at_end",
        "because the last /cmd_vel stays in force",
        (ABORT, ABORT.replace("break", "self.drive(0.2, 0.0)\n                break")),
        (END, "        self.stop() if success else None\n        result ="),
        alone=True,
    ),
    _server(
        "turns_by_the_goals_angle",
        "turns_to_goal",
        "turns away",
        (TURN, TURN.replace("angle_error", "math.atan2(goal.position.y, goal.position.x)")),
        alone=True,
    ),
    _bridge(
        "bridge_transforms_without_a_timeout",
        "goal_frame",
        "The click is newer than the newest transform from base_footprint to odom",
        ("        msg.header.stamp = rospy.Time(0)\n", ""),
        (", rospy.Duration(1.0))", ")"),
        alone=True,
    ),
    _bridge(
        "bridge_without_tf2_geometry_msgs",
        "bridge_alive",
        "only after: import tf2_geometry_msgs",
        ("import tf2_geometry_msgs\n", ""),
        alone=True,
    ),
    _server(
        "odometry_callback_takes_a_little_too_long",
        "feedback_position",
        "messages on /odom waited up to",
        ("def odom_cb(self, msg):\n", "def odom_cb(self, msg):\n        rospy.sleep(0.1)\n"),
        alone=True,
    ),
    _server(
        "walls_known_by_the_place_of_the_robot",
        "stops_at_obstacle",
        "ran into an obstacle",
        ("import rospy\n", "import rospy\nfrom gazebo_msgs.srv import GetModelState\n"),
        (RATE, f"{RATE}        where = rospy.ServiceProxy('/gazebo/get_model_state', GetModelState)\n{PLACE}"),
        (OBSTACLE, "elif x > wall:"),
    ),
    _server(
        "no_obstacle_within_a_metre_of_the_goal",
        "stops_at_obstacle",
        "0.26 m ahead from the start",
        (OBSTACLE, "elif self.min_dist_ahead < 0.3 and position_error > 1.0:"),
    ),
    _server(
        "cone_narrower_than_the_robot",
        "stops_at_obstacle",
        "as far as the robot is wide",
        (SECTOR, "ahead = np.concatenate([ranges[:6], ranges[-5:]])"),
        alone=True,
    ),
    _server(
        "first_odometry_is_zero",
        "feedback_position",
        "counted from where it was when the node started",
        ("        self.pose = None\n", "        self.pose = self.first = None\n"),
        (POSE, f"{POSE}\n        self.first = self.first or self.pose\n        {SUBTRACTED}"),
        alone=True,
    ),
    _server(
        "cancel_request_without_a_goal_is_kept",
        "next_goal",
        "Does a cancel request that came before this goal end it",
        ("import rospy\n", "import rospy\nfrom actionlib_msgs.msg import GoalID\n"),
        ("        self.count = 0\n", f"        self.cancelled = False\n{SUBSCRIBE_CANCEL}"),
        (REQUESTED, "            if self.cancelled or self.server.is_preempt_requested():"),
        ("self.server.set_preempted(", "self.cancelled = False\n                self.server.set_preempted("),
        alone=True,
    ),
    _server(
        "feedback_timer_raises",
        "no_exception",
        "TypeError",
        ("        self.count = 0\n", f"        self.errors = 0.0, 0.0\n{FEEDBACK_TIMER}"),
        (PUBLISH, "            self.errors = position_error, angle_error\n"),
        (
            DRIVE_BEGIN,
            "    def tell(self, _event):\n        if self.server.is_active():\n"
            f"            self.server.publish_feedback(*self.errors)\n\n{DRIVE_BEGIN}",
        ),
        alone=True,
    ),
    _server(
        "drives_sideways",
        "drives_straight",
        "linear.x is 0 within 0.1 rad",
        ("        msg.linear.x = v\n", "        msg.linear.y = v\n"),
        alone=True,
    ),
    _server("turns_while_driving", "drives_straight", "keeps turning", (DRIVE, "self.drive(0.2, 0.5)"), alone=True),
    _server(
        "first_errors_of_the_older_goal",
        "next_goal",
        "is not reset when a new goal begins",
        ("        self.count = 0\n", "        self.told = None\n"),
        (BEGIN, BEGIN.replace("success = False", "success, is_new = False, not self.told")),
        (
            "            feedback = ",
            "            self.told = (position_error, angle_error) if is_new else self.told\n"
            "            is_new, (position_error, angle_error) = True, self.told\n            feedback = ",
        ),
        alone=True,
    ),
    _server(
        "name_error_in_the_main_loop",
        "no_exception",
        "NameError",
        ("execute_cb=self.execute_cb,", ""),
        (REQUESTED, f"{REQUESTED}\n                undefined"),
        (
            "    rospy.spin()\n",
            "    while not rospy.is_shutdown():\n        rospy.sleep(0.05)\n"
            "        if node.server.is_new_goal_available():\n"
            "            node.execute_cb(node.server.accept_new_goal())\n",
        ),
        alone=True,
    ),
    Wrong(
        "never_accepted",
        "one_ending",
        "A goal that was PENDING got a terminal state",
        (("    handle.set_accepted()\n", ""),),
        "right/low_level_odom_driven.py.in",
        alone=True,
    ),
)

# The row of consequences (the first of the later checks, kind, earlier check) -> the wrong server that needs it.
ROWS = {
    ("", Kind.NOT_REACHED, "action_server"): "never_started",
    ("no_exception", None, "action_server"): "crashes_at_start",
    ("stays_alive", None, "no_exception"): "name_error_in_the_main_loop",
    ("feedback_rate", Kind.TOO_LITTLE, "no_exception"): "feedback_timer_raises",
    ("feedback_position", None, "next_goal"): "first_errors_of_the_older_goal",
    ("only_ahead_counts", Kind.ABORTED, "stops_at_obstacle"): "obstacle_at_half_a_metre",
    ("reaches_goal", None, "no_exception"): "exception_while_driving",
    ("success_result", Kind.NO_MESSAGE, "one_ending"): "no_terminal_state",
    ("reaches_goal", None, "stays_alive"): "name_error_in_the_main_loop",
    ("reaches_goal", None, "one_ending"): "never_accepted",
    ("reaches_goal", Kind.SUCCESS_LATE, "feedback_rate"): "slow_loop",
    ("reaches_goal", Kind.TOO_FAR, "feedback_position"): "first_odometry_is_zero",
    ("reaches_goal", None, "feedback_angle"): "first_odometry_is_zero",
    ("reaches_goal", Kind.NO_RESULT, "turns_to_goal"): "turns_away_beyond_two_radians",
    ("reaches_goal", Kind.NO_RESULT, "drives_straight"): "drives_sideways",
    ("reaches_goal", None, "reaches_goal"): "success_at_once",
    ("feedback_rate", None, "reaches_goal"): "odometry_of_another_type",
    ("turns_to_goal", Kind.MOVES_FIRST, "already_there"): "moves_first",
    ("stops_at_obstacle", Kind.MOVES_FIRST, "turns_to_goal"): "moves_first",
    ("odd_scans", None, "stops_at_obstacle"): "obstacle_checked_only_while_turning",
    ("stops_at_obstacle", Kind.MOVING, "stands_at_end"): "aborts_and_drives_on",
    ("goal_behind", Kind.LONG_TURN, "feedback_rate"): "slow_loop",
    ("stops_at_obstacle", Kind.TOO_NEAR, "feedback_rate"): "slow_loop",
    ("goal_behind", Kind.LONG_TURN, "drives_straight"): "turns_while_driving",
    ("goal_behind", Kind.LONG_TURN, "turns_to_goal"): "turns_by_the_goals_angle",
    ("newer_goal", None, "cancel"): "preempted_three_seconds_later",
    ("goal_behind", None, "next_goal"): "done_never_cleared",
    ("feedback_position", Kind.NOT_REACHED, "feedback_rate"): "odometry_of_another_type",
    ("failure_result", Kind.NOT_REACHED, "stops_at_obstacle"): "exception_in_scan",
    ("turns_to_goal", Kind.NOT_REACHED, "reaches_goal"): "exception_while_driving",
    ("reaches_goal", Kind.NOT_REACHED, "stays_alive"): "exits_with_result",
}
