"""Ordinary mistakes in a server, to be made together: each changes the base and leaves the others possible."""

from typing import Dict, NamedTuple, Sequence

from right_solutions import PUBLISH, SERVER, Changes, changed

LOOP = "        while not rospy.is_shutdown():\n"
MESSAGE = "            result.message = 'finished successfully'\n"
BEGIN = "        self.count = 0\n"


class Mistake(NamedTuple):
    """What a mistake changes, and the checks that don't pass because of it."""

    lost: str
    changes: Changes
    excludes: str = ""  # the mistake that can't be made beside it
    beside: str = ""  # checks that don't pass because of it only where another mistake makes the robot turn again


MISTAKES: Dict[str, Mistake] = {
    "drives_first": Mistake(
        "turns_to_goal already_there stops_at_obstacle",
        ((LOOP, f"        self.drive(0.15, 0.0)\n        rospy.sleep(1.0)\n{LOOP}"),),
    ),
    "never_ends": Mistake(
        "reaches_goal goal_behind already_there far_goal "
        "only_ahead_counts odd_scans newer_goal next_goal success_result",
        (
            ("if position_error < 0.1:", "if position_error < 0.0:"),
            ("abs(angle_error) > 0.1:", "abs(angle_error) > 0.1 and position_error > 0.1:"),
            ("self.drive(0.2,", "self.drive(0.0 if position_error < 0.1 else 0.2,"),
        ),
        excludes="success_kept",
    ),
    "never_preempted": Mistake(
        "cancel newer_goal",
        (("if self.server.is_preempt_requested():", "if False:"),),
    ),
    "preempted_twice": Mistake(
        "one_ending",
        (("'preempted'))\n                return\n", "'preempted'))\n                break\n"),),
    ),
    "turns_away": Mistake(
        "turns_to_goal reaches_goal goal_behind far_goal stops_at_obstacle "
        "newer_goal next_goal drives_straight success_result failure_result",
        (("2.0 * angle_error))", "-2.0 * angle_error))"),),
        beside="only_ahead_counts odd_scans",
    ),
    "turns_while_driving": Mistake(
        "drives_straight goal_behind",
        (("0.2, 0.0)", "0.2, 0.5)"),),
    ),
    "heading_threshold": Mistake(
        "turns_to_goal",
        (("if abs(angle_error) > 0.1", "if abs(angle_error) > 0.4"),),
    ),
    "feedback_slow": Mistake(
        "feedback_rate",
        (
            (LOOP, f"        self.count = 0\n{LOOP}            self.count += 1\n"),
            (PUBLISH, f"            if self.count % 5 == 0:\n    {PUBLISH}"),
        ),
    ),
    "distance_squared": Mistake(
        "feedback_position",
        (("= position_error\n", "= position_error ** 2\n"),),
    ),
    "angle_not_wrapped": Mistake(
        "feedback_angle turns_to_goal goal_behind",
        (("= wrap(math.atan2(dy, dx) - yaw)", "= math.atan2(dy, dx) - yaw"),),
    ),
    "scan_ignored": Mistake(
        "stops_at_obstacle odd_scans failure_result",
        (("self.min_dist_ahead < 0.3", "self.min_dist_ahead < 0.0"),),
        excludes="aborts_early",
    ),
    "aborts_early": Mistake(
        "stops_at_obstacle only_ahead_counts odd_scans",
        (("self.min_dist_ahead < 0.3", "self.min_dist_ahead < 0.5"),),
        excludes="scan_ignored",
    ),
    "all_beams_count": Mistake(
        "only_ahead_counts",
        (("np.concatenate([ranges[:30], ranges[-30:]])", "ranges"),),
    ),
    "odd_ranges_count": Mistake(
        "odd_scans",
        (("(ahead > msg.range_min) & (ahead < msg.range_max)", "~(ahead > msg.range_max)"),),
    ),
    "never_stopped": Mistake(
        "stands_at_end",
        (("    def stop(self):\n        self.drive(0.0, 0.0)\n", "    def stop(self):\n        pass\n"),),
    ),
    "no_message": Mistake(
        "success_result",
        ((MESSAGE, ""),),
    ),
    "raises_at_second_goal": Mistake(
        "goal_behind newer_goal next_goal no_exception",
        (
            (f"{BEGIN}        self.cmd_pub", f"        self.goals = 0\n{BEGIN}        self.cmd_pub"),
            (LOOP, f"        self.goals += 1\n        if self.goals == 2:\n            raise ValueError\n{LOOP}"),
        ),
    ),
    "success_kept": Mistake(
        "goal_behind next_goal",
        (
            (f"{BEGIN}        self.cmd_pub", f"        self.done = False\n{BEGIN}        self.cmd_pub"),
            (
                " < 0.1:\n                success = True\n",
                " < 0.1 or self.done:\n                success = self.done = True\n",
            ),
        ),
        excludes="never_ends",
    ),
}
# Allowed, and costs nothing alone.
ALLOWED: Dict[str, Changes] = {"turns_slowly": (("max(-0.8, min(0.8,", "max(-0.5, min(0.5,"),)}


def with_mistakes(names: Sequence[str]) -> str:
    """The source of a server with these mistakes."""
    changes = {**{name: it.changes for name, it in MISTAKES.items()}, **ALLOWED}
    return changed("+".join(names), SERVER, tuple(change for name in names for change in changes[name]))
