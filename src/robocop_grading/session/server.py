"""The server's scenarios: goals sent to it on the action's topics, as by any client."""

import math
from typing import Callable, List, Tuple

import rospy
from actionlib_msgs.msg import GoalID
from aro_robocop_goto_as.msg import GoToPositionActionGoal, GoToPositionGoal
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, compose
from aro_robocop_goto_as.goto import Errors, track_progress
from aro_robocop_goto_as.ros import graph, markers

from .. import record as rec
from ..handout import ACTION
from ..plan import Plan, Push, Scenario, Step
from ..record import Record
from .display import is_shown
from .node import Node
from .run import Run
from .stage import Stage, outlines

START_TIMEOUT = 20.0  # [s] for the node to connect to the recorder of /rosout
SERVER_TIMEOUT = 5.0  # [s] for its action server to connect, counted from then on
WARM_UP = 0.5  # [s] of each scenario: new odometry and scans reach the node
AT_END = 0.25  # [s] before a result, in which the robot was where it ended
AFTER = 1.2  # [s] after each terminal state, to see whether the robot stops
MARKERS = "/aro_robocop_goto_as_node/markers"  # of this package's server, in the bag only: a replay shows them
Launch = Callable[[Stage], Node]


class ServerRun:
    """One submission's server, restarted after a scenario that left it in a bad state."""

    def __init__(self, plan: Plan, launch: Launch, stage: Stage) -> None:
        self.plan = plan
        self.limits = plan.limits
        self.launch = launch
        self.stage = stage
        self.run = Run(stage, "server")
        self.goal_topic, self.cancel_topic = _topics()
        self._used = False  # the node has served a scenario
        self._pushes: List[Push] = []  # that are still to come
        self._pushed_until = 0.0  # [s]

    def start(self, bag: str = "") -> Record:
        """Start the node; the record says whether its action server came up."""
        self.run.begin(0, bag=bag)
        up = self._bring_up()
        servers = graph.action_servers()
        unpublished = [topic for topic in graph.unpublished_topics() if not is_shown(topic)]
        self.run.settle(0.3)
        return self.run.finish(
            "start", up=up, servers=tuple(servers), types=tuple(servers.values()), unpublished=tuple(unpublished)
        )

    def _bring_up(self) -> bool:
        run = self.run
        run.death_recorded, run.known, self._used = False, {}, False
        run.node = self.launch(self.stage)
        log = run.subscribers["log"]
        run.wait_for(lambda: log.get_num_connections() > 0, START_TIMEOUT)
        up = run.wait_for(self._connected, SERVER_TIMEOUT)
        run.settle(0.2)
        return up and not run.death_recorded

    def _connected(self) -> bool:
        """Whether all five topics are connected, so that no message is lost."""
        return (
            self.goal_topic.get_num_connections() > 0
            and self.cancel_topic.get_num_connections() > 0
            and all(self.run.subscribers[name].get_num_connections() for name in ("result", "feedback", "status"))
        )

    # -- one scenario --

    def scenario(self, index: int, scenario: Scenario, bag: str) -> Record:
        """Run its script to the end, or until it can't continue.

        If a goal ends otherwise than it should, with a node that has served other scenarios, the scenario is repeated
        with a new node: what earlier scenarios have left behind in a node is judged where one scenario has several
        goals, and must not fail the others.
        """
        used = self._used
        record = self._play(index, scenario, bag)
        return self._play(index, scenario, bag) if used and self._unexpected(record) else record

    def _play(self, index: int, scenario: Scenario, bag: str) -> Record:
        run = self.run
        run.begin(index, scenario.odd_scan, bag)
        problem = ""
        run.ended.clear()
        self._pushes = list(scenario.pushes)
        if run.node is None or run.node.status() is not None:
            self._end_node()
            if not self._bring_up():
                problem = "the node did not come up again"
        self._used = True
        if not problem:
            run.settle(WARM_UP)
            for number, step in enumerate(scenario.steps, 1):
                problem = self._step(index, f"{scenario.name}-{number}", step)
                if problem:
                    break
        if problem:
            run.settle(AFTER)
        record = run.finish(scenario.name, obstacles=outlines(self.plan, scenario.name), problem=problem)
        if problem or self._unclean(record):
            self._end_node()
        return record

    def _unclean(self, record: Record) -> bool:
        """Whether the node has to be restarted, so that its state does not affect the next scenario."""
        text = "\n".join(line.text for line in record.lines)
        ended = all(len(rec.results_of(record, goal)) == 1 for goal in record.goals)
        return bool(record.deaths) or not ended or self._unexpected(record) or "Traceback" in text or "[ERROR]" in text

    def _unexpected(self, record: Record) -> bool:
        """Whether a goal ended in another state than it should, in the open by an abort, or elsewhere by a success."""
        for goal in record.goals:
            for result in rec.results_of(record, goal)[:1]:
                at_end = rec.samples_between(record, result.time - AT_END, result.time)
                far = result.status == rec.ABORTED and all(
                    sample.ahead > self.limits.abort_farthest for sample in at_end
                )
                elsewhere = result.status == rec.SUCCEEDED and all(
                    rec.errors_at(sample, goal)[0] > self.limits.reached for sample in at_end
                )
                if far or elsewhere or rec.status_name(result.status) != goal.ends:
                    return True
        return False

    def _end_node(self) -> None:
        if self.run.node is not None:
            self.run.node.end()
            self.run.node = None
            self.stage.run_jobs()  # its last messages belong to the previous scenario
            # rospy drops a dead subscriber only on the next write; new publishers count only the next node.
            for topic in (self.goal_topic, self.cancel_topic):
                topic.unregister()
            self.goal_topic, self.cancel_topic = _topics()

    def _step(self, index: int, name: str, step: Step) -> str:
        """Run one step of a script; returns the problem, or an empty text."""
        run = self.run
        if step.place:
            self.stage.teleport(index, Pose2D(*step.place))
            run.settle(WARM_UP)
            return ""
        if step.goal:
            goal = self._send(name, step)
            run.digest()
        elif step.cancel:
            goal = run.parts["goals"][-1]
            run.add("cancels", rec.Cancel(self.stage.now, goal.id))
            self.cancel_topic.publish(GoalID(id=goal.id))
            run.digest()
        if step.run:
            return self._advance(goal, step.run)
        problem = self._until_end(goal)
        if not problem or step.ends == "PREEMPTED":
            run.settle(AFTER)
        return problem

    def _send(self, name: str, step: Step) -> rec.Goal:
        x, y = step.goal
        if step.of == "robot":
            there = compose(self.stage.odom_from_footprint(), Pose2D(x, y))
            x, y = there.x, there.y
        goal = rec.Goal(name, x, y, self.stage.now, step.ends or "PREEMPTED")
        self.run.add("goals", goal)
        message = GoToPositionActionGoal(goal=GoToPositionGoal())
        message.header.stamp = message.goal_id.stamp = self.stage.stamp
        message.goal_id.id = name
        message.goal.position.x, message.goal.position.y = x, y
        self.stage.keep(f"{ACTION}/goal", message)
        self.stage.keep(MARKERS, MarkerArray(markers.goal(self.limits.reached, x, y, self.stage.robot.odom_frame)))
        self.goal_topic.publish(message)
        return goal

    def _advance(self, goal: rec.Goal, seconds: float) -> str:
        for _ in range(int(round(seconds * 10))):
            if goal.id in self.run.ended:
                return "the goal ended too early"
            problem = self._tick()
            if problem:
                return problem
        return ""

    def _until_end(self, goal: rec.Goal) -> str:
        """Tick until the goal has ended; returns the problem, or an empty text."""
        started, progress = self.stage.now, None
        while goal.id not in self.run.ended:
            problem = self._tick()
            if problem:
                return problem
            now = self.stage.now
            errors = Errors(*rec.errors_at(self.stage.odom_from_footprint(), goal))
            progress = track_progress(progress, errors, now, self.limits.stall_distance, self.limits.stall_angle)
            if now - progress.since > self.limits.stall:
                return f"the robot made no progress for {self.limits.stall:g} s, and the goal did not end"
            if now - started > self.limits.goal_time:
                return f"the goal did not end within {self.limits.goal_time:g} s"
        return ""

    def _tick(self) -> str:
        self._push()
        self.run.tick()
        if self.run.node is None or self.run.node.status() is not None:
            return "the node died"
        return ""

    def _push(self) -> None:
        """Push the robot where the plan says so."""
        here = self.stage.odom_from_footprint()
        if self.stage.now >= self._pushed_until - 1e-6:
            self.stage.push(None)
        if self._pushes and math.hypot(here.x, here.y) > self._pushes[0].after:
            push = self._pushes.pop(0)
            self.stage.push(Twist2D(push.v, push.w))
            self._pushed_until = self.stage.now + push.seconds

    def close(self) -> None:
        """End the node."""
        if self.run.node is not None:
            self.run.node.end()


def _topics() -> Tuple[rospy.Publisher, rospy.Publisher]:
    """Publishers of goals and cancel requests."""
    return (
        rospy.Publisher(f"{ACTION}/goal", GoToPositionActionGoal, queue_size=10),
        rospy.Publisher(f"{ACTION}/cancel", GoalID, queue_size=10),
    )
