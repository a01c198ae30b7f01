"""An action client of the campaign's own, on raw topics: it believes no library about what became of a goal."""

import collections
import itertools
import math

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from aro_robocop_goto_as.msg import GoToPositionActionFeedback, GoToPositionActionGoal, GoToPositionActionResult
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from system import BRIDGE, CLIENT, SERVER, SIMULATOR, Violation, connections_from, is_connected, publisher, wait_for

TERMINAL = {
    GoalStatus.PREEMPTED: "PREEMPTED",
    GoalStatus.SUCCEEDED: "SUCCEEDED",
    GoalStatus.ABORTED: "ABORTED",
    GoalStatus.REJECTED: "REJECTED",
    GoalStatus.RECALLED: "RECALLED",
}
STATES_OF = {  # the terminal states that belong to the first word of a result
    "REACHED": ("SUCCEEDED",),
    "PREEMPTED": ("PREEMPTED",),
    **dict.fromkeys(
        ("OBSTACLE", "STUCK", "TIMEOUT", "NO_ODOM", "NO_SCAN", "BAD_GOAL", "SHUTDOWN", "ERROR"), ("ABORTED",)
    ),
}
FORGOTTEN = GoalStatus.RECALLING  # of a goal that is cancelled so late that actionlib has forgotten it
WALL_TIME = 1e9  # [s] the stamps of a server on wall time are later, simulated ones earlier
SLOWEST = 0.003, 0.02  # [m/s], [rad/s] at rest

ATTEMPTS = 100  # to find a place that the robot can drive to
NEAR = 1.2  # [m] farther returns are in no goal's way
SCAN_AGE = 0.5  # [s] simulated; scans come at 5 Hz, and topics do not arrive in step
CLEAR_AHEAD, CLEAR_ASIDE, CLEAR_AROUND = 0.45, 0.25, 0.2  # [m] more than the server's cone and the robot need


def _is_free(returns, turn, distance):
    """Whether the robot can turn by an angle [rad] and drive so far [m] without an obstacle, by (angle, distance)."""
    for angle, far in returns:
        ahead, aside = far * math.cos(angle - turn), far * math.sin(angle - turn)
        if far < CLEAR_AROUND or (0.0 < ahead < distance + CLEAR_AHEAD and abs(aside) < CLEAR_ASIDE):
            return False
    return True


def _moves(_time, v, w):
    """Whether a robot with these velocities [m/s], [rad/s] is not at rest."""
    v_max, w_max = SLOWEST
    return abs(v) > v_max or abs(w) > w_max


class _Lists(dict):
    """Lists by goal id; one that is looked up before it exists is found empty, and only `add` makes one."""

    def __missing__(self, _goal):
        return ()

    def add(self, goal, value):
        """Append a value to a goal's list; called from one thread."""
        self.setdefault(goal, []).append(value)


class Client:
    """One robot: sends goals to its server, records what is said about them and how the robot moves."""

    def __init__(self, system, namespace="", obstacles=False, lockstep=False):
        """`obstacles`: whether to look for free places, by the scan. `lockstep`: the simulator's mode."""
        prefix = f"/{namespace}" if namespace else ""
        self._system, self._lockstep = system, lockstep
        self.namespace = namespace
        self.action = f"{prefix}/robocop_goto_as"
        self.server = f"{prefix}/{SERVER}"
        self.numbers = itertools.count(1)
        self.sent = 0  # goals
        self.odom = self.position = None
        self.ended_at = 0.0  # [s] simulated, of the last result
        self.truth = collections.deque(maxlen=3000)  # (stamp [s], v [m/s], w [rad/s])
        self.commands = collections.deque(maxlen=3000)
        self.forget()
        self.goal_topic = publisher(f"{self.action}/goal", GoToPositionActionGoal)
        self.cancel_topic = publisher(f"{self.action}/cancel", GoalID)
        self.click_topic = publisher(f"{prefix}/move_base_simple/goal", PoseStamped)
        rospy.Subscriber(f"{self.action}/result", GoToPositionActionResult, self._on_result)
        rospy.Subscriber(f"{self.action}/status", GoalStatusArray, self._on_status)
        rospy.Subscriber(f"{self.action}/feedback", GoToPositionActionFeedback, self._on_feedback)
        rospy.Subscriber(f"{self.action}/goal", GoToPositionActionGoal, self._on_goal)
        rospy.Subscriber(f"{prefix}/cmd_vel", Twist, self.commands.append)
        rospy.Subscriber(f"{prefix}/odom", Odometry, self._on_odom)
        self._scan = None
        if obstacles:
            rospy.Subscriber(f"{prefix}/scan", rospy.AnyMsg, self._on_scan)
        rospy.Subscriber(f"{prefix}/ground_truth_odom", Odometry, self._on_truth)

    def last_command_of(self, node):
        """The last velocity command that a node has sent; None if there was none."""
        of_node = [message for message in list(self.commands) if message._connection_header["callerid"] == node]
        return of_node[-1] if of_node else None

    def forget(self):
        """Forget all goals."""
        self.expected = []  # ids of the goals that must have an ending
        self.lost = set()  # ids of those whose server was ended before they were
        self.clicked = {}  # by id: goals of the bridge
        self.results, self.states, self.feedback = _Lists(), _Lists(), _Lists()

    # -- what arrives --

    def _on_result(self, message):
        if message.header.stamp.to_sec() < WALL_TIME:
            self.ended_at = message.header.stamp.to_sec()
        self.results.add(message.status.goal_id.id, message)

    def _on_status(self, message):
        for status in message.status_list:
            if self.states[status.goal_id.id][-1:] != [status.status]:
                self.states.add(status.goal_id.id, status.status)

    def _on_feedback(self, message):
        self.feedback.add(message.status.goal_id.id, message.feedback)

    def _on_goal(self, message):
        if BRIDGE in message.goal_id.id:
            self.clicked[message.goal_id.id] = message.goal

    def _on_odom(self, message):
        self.odom = message

    def _on_scan(self, message):
        self._scan = message  # not read before it is needed, because that takes longer than to receive it

    def _on_truth(self, message):
        twist, self.position = message.twist.twist, message.pose.pose.position
        self.truth.append((message.header.stamp.to_sec(), twist.linear.x, twist.angular.z))

    def restart_time(self):
        """Forget the times of what was recorded: time starts again."""
        self.ended_at = 0.0
        self.truth.clear()

    # -- connections --

    def wait_for_server(self):
        """Wait until the server that runs now is connected to this client."""
        wanted = {f"{self.action}/{topic}" for topic in ("result", "status", "feedback")}
        for topic in (self.goal_topic, self.cancel_topic):
            wait_for(lambda topic=topic: is_connected(topic, self.server), f"{self.server} subscribes to {topic.name}")
        wait_for(lambda: wanted <= connections_from(self._system, self.server), f"{self.server} sends its topics")

    def wait_for_simulator(self):
        """Wait until the simulator that runs now sends this robot's topics here, and is connected to its server."""
        simulator, prefix = "/" + SIMULATOR, f"/{self.namespace}" if self.namespace else ""
        commands = {f"{prefix}/cmd_vel", f"{prefix}/tick_answer"} if self._lockstep else {f"{prefix}/cmd_vel"}
        for sender, receiver, wanted in (
            (simulator, CLIENT, {"/clock", f"{prefix}/odom", f"{prefix}/ground_truth_odom"}),
            (simulator, self.server, {"/clock", f"{prefix}/odom", f"{prefix}/scan"}),
            (self.server, simulator, commands),
        ):
            wait_for(
                lambda by=sender, to=receiver, topics=wanted: topics <= connections_from(self._system, by, to),
                f"{sender} sends {wanted} to {receiver}",
            )

    # -- goals --

    def send(self, x, y, z=0.0, goal_id=None, stamp=None, expected=True):
        """Send a goal in odom [m]; its id."""
        message = GoToPositionActionGoal()
        name = f"{rospy.get_name()}-{next(self.numbers)}" if goal_id is None else goal_id
        message.goal_id = GoalID(rospy.Time() if stamp is None else stamp, name)
        message.goal.position.x, message.goal.position.y, message.goal.position.z = x, y, z
        if expected and name not in self.expected:
            self.expected.append(name)
            self.sent += 1
        self.goal_topic.publish(message)
        return name

    def send_near(self, rng, farthest=0.5):
        """Send a goal at a random place near the robot."""
        return self.send(*self.place_near(rng, farthest))

    def place_near(self, rng, farthest=0.5, free=False):
        """A random place near the robot, in odom [m]; in a world with obstacles one that the robot can drive to.

        If none is found, any place, or None if it has to be `free`.
        """
        here, q = self.odom.pose.pose.position, self.odom.pose.pose.orientation
        returns = self._returns()
        for attempt in range(ATTEMPTS):
            # To turn around takes longer than to drive there.
            widest = math.pi if rng.random() < 0.1 or attempt > ATTEMPTS / 10 else 0.5
            turn, distance = rng.uniform(-widest, widest), rng.uniform(0.15, farthest)
            if _is_free(returns, turn, distance):
                break
        else:
            if free:
                return None
        angle = 2.0 * math.atan2(q.z, q.w) + turn
        return here.x + distance * math.cos(angle), here.y + distance * math.sin(angle)

    def rests(self):
        """Whether the robot was at rest when it was last seen."""
        return bool(self.truth) and not _moves(*self.truth[-1])

    def _returns(self):
        """The newest scan's returns as (angle [rad], distance [m]); none in a world without obstacles."""
        if self._scan is None:
            return []
        scan = wait_for(self._scan_of_now, self._behind)
        angles = (scan.angle_min + number * scan.angle_increment for number in range(len(scan.ranges)))
        return [(angle, distance) for angle, distance in zip(angles, scan.ranges) if distance < NEAR]

    def _scan_of_now(self):
        """The newest scan; None while it or the odometry is older than what is known of the robot's motion."""
        scan = LaserScan().deserialize(self._scan._buff)
        return scan if min(self._stamps(scan)) >= self.truth[-1][0] - SCAN_AGE else None

    def _stamps(self, scan):
        return scan.header.stamp.to_sec(), self.odom.header.stamp.to_sec()

    def _behind(self):
        stamps = self._stamps(LaserScan().deserialize(self._scan._buff))
        return f"scan and odometry, at {stamps} s, from where the robot is seen at {self.truth[-1][0]} s"

    def cancel(self, goal_id="", stamp=None):
        """Cancel one goal, those up to a stamp, or all."""
        self.cancel_topic.publish(GoalID(rospy.Time() if stamp is None else stamp, goal_id))

    def lose_goals(self):
        """The server is ended now: what has no result yet may never have one."""
        self.lost.update(goal for goal in self.expected if not self.results[goal])

    def all_ended(self):
        """Whether each goal that must end has a result."""
        return all(self.results[goal] for goal in self.expected if goal not in self.lost)

    # -- invariants --

    def require_one_ending_each(self):
        """Violation unless every goal has exactly one result and terminal state, which agree."""
        for goal in self.expected:
            self._require_one_ending(goal)

    def _require_one_ending(self, goal):
        results, states = self.results[goal], self.states[goal]
        if len(results) != 1 and not (goal in self.lost and not results):
            raise Violation(f"goal {goal} has {len(results)} results: {[r.result.message for r in results]}")
        ended = [state for state in states if state in TERMINAL]
        after = states[states.index(ended[0]) + 1 :] if ended else []
        if any(state != FORGOTTEN for state in after):
            raise Violation(f"goal {goal} went through the states {states}")
        for message in results:
            word, _, text = message.result.message.partition(": ")
            state = TERMINAL.get(message.status.status, message.status.status)
            consistent = state in STATES_OF.get(word, ()) and text and message.result.success == (word == "REACHED")
            if not consistent and state != "RECALLED":  # whose result is actionlib's own, an empty one
                raise Violation(f"goal {goal} ended {state}, success {message.result.success}: {message.result}")
            if ended and ended != [message.status.status]:
                raise Violation(f"goal {goal}: result {state}, but status {states}")

    def word(self, goal):
        """The first word of a goal's result; PREEMPTED for one that was replaced or cancelled before it began."""
        if self.results[goal][0].status.status == GoalStatus.RECALLED:
            return "PREEMPTED"
        return self.results[goal][0].result.message.partition(": ")[0]

    def require_rest_since(self, stamp):
        """Violation if the robot has moved since a simulated time [s]."""
        moving = [(v, w) for time, v, w in list(self.truth) if time >= stamp and _moves(time, v, w)]
        if moving:
            raise Violation(f"robot {self.namespace!r} moves after {stamp:.2f} s, when it should rest: {moving[-1]}")
