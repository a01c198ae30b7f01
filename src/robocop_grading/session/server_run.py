"""The server's scenarios: goals sent to it on the action's topics, as by any client."""

import math
from typing import List

from actionlib_msgs.msg import GoalID
from aro_robocop_goto_as.msg import GoToPositionActionGoal, GoToPositionGoal
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.geometry import Pose2D, Twist2D, compose
from aro_robocop_goto_as.ros import markers

from .. import record as rec
from ..handout import ACTION
from ..plan import AGAIN, TICK
from ..record import Record
from ..scenarios import START, Push, Scenario, Step
from ..sites import SITE
from .job import Job
from .progress import Progress
from .run import Run
from .scenario_bag import MARKERS
from .stage import Stage

START_TIMEOUT = 20.0  # [s] for the node to come up: it publishes /rosout
SERVER_TIMEOUT = 30.0  # [s] for its action server to connect, counted from then on: it may wait for Gazebo
WARM_UP = 0.5  # [s] of each scenario: new odometry and scans reach the node
START_PUSH = Twist2D(0.3, 0.4)  # [m/s], [rad/s] before the node starts
START_PUSH_TIME = 1.5  # [s]
AFTER = 1.2  # [s] after each terminal state, to see whether the robot stops
GOAL, CANCEL = f"{ACTION}/goal", f"{ACTION}/cancel"


class ServerRun(Run):
    """One submission's server, restarted after a scenario that left it in a bad state."""

    def __init__(self, job: Job, stage: Stage) -> None:
        super().__init__(job, stage)
        self.listen_to_server()
        self.limits = job.plan.limits
        self.topics.advertise(GOAL, GoToPositionActionGoal)
        self.topics.advertise(CANCEL, GoalID)
        self._has_served = False  # the node, a scenario
        self._pushes: List[Push] = []  # that are still to come
        self._pushed_until = 0.0  # [s]

    def scenarios(self) -> None:
        """Start the node, then all scenarios, if its action server comes up."""
        self.announce(START)
        start = self._start()
        for scenario in self.plan.scenarios:
            if start.up and self.plan.examines(self.job.part, scenario.name):
                self.announce(scenario.name)
                self._scenario(scenario)

    def _start(self) -> Record:
        """Start the node where odometry is not zero; the record says whether its action server came up."""
        self.begin(START, SITE)
        self.stage.push(START_PUSH)
        self.settle(START_PUSH_TIME)
        self.stage.push(None)
        self.settle(AFTER)
        up = self._bring_up()
        names = self.action_fields("/result")
        self.settle(0.3)
        return self.finish(START, up=up, **names)

    def _bring_up(self) -> bool:
        self.known, self._has_served = {}, False
        self.launch()
        self.wait_for(lambda: self.topics.node_publishes("/rosout"), START_TIMEOUT)
        up = self.wait_for(self._connected, SERVER_TIMEOUT)
        self.settle(0.2)
        return up and not self.end_recorded

    def _connected(self) -> bool:
        """Return whether the node has all five topics, with the right types."""
        heard = all(self.topics.node_publishes(f"{ACTION}/{name}") for name in ("result", "feedback", "status"))
        return heard and self.topics.node_subscribes_to(GOAL) and self.topics.node_subscribes_to(CANCEL)

    # -- one scenario --

    def _scenario(self, scenario: Scenario) -> None:
        """Run a scenario's script to its end, or until it can't continue.

        The scenario is repeated with a new node if a goal ended otherwise than it should or did not end, and the node
        had served other scenarios. attempts.py decides which of the two records counts, when all records are there.
        """
        used = self._has_served and not self.node_has_ended()
        record = self._play(scenario, scenario.name)
        unended = bool(record.problem) and not record.node_ends
        if used and (unended or self._unexpected(record)):
            self._play(scenario, scenario.name + AGAIN)

    def _play(self, scenario: Scenario, name: str) -> Record:
        """Run a scenario with the present node; its record has this name."""
        self.begin(name, SITE, scenario.obstacles, scenario.odd_scan)
        problem = ""
        self.ended.clear()
        self._pushes = list(scenario.pushes)
        if self.node_has_ended():
            self.end_node()
            if not self._bring_up():
                problem = "the node did not come up again"
        self._has_served = True
        if not problem:
            self.settle(WARM_UP)
            for step in scenario.steps:
                problem = self._step(step)
                if problem:
                    break
        if problem:
            self.settle(AFTER)
        outlines = tuple(block.outline for block in scenario.obstacles)
        unpublished = tuple(self.topics.unpublished()) if problem else ()
        record = self.finish(name, obstacles=outlines, problem=problem, unpublished=unpublished)
        if problem or self._unclean(record):
            self.end_node()
        return record

    def _unclean(self, record: Record) -> bool:
        """Return whether the node has to be restarted, so that its state does not affect the next scenario."""
        text = "\n".join(line.text for line in record.lines)
        ended = all(len(record.results_of(goal)) == 1 for goal in record.goals)
        return (
            bool(record.node_ends) or not ended or self._unexpected(record) or "Traceback" in text or "[ERROR]" in text
        )

    def _unexpected(self, record: Record) -> bool:
        """Return whether a goal ended in another state than planned, was aborted with nothing in front of the robot, or
        succeeded away from its position.
        """
        for goal in record.goals:
            for result in record.results_of(goal)[:1]:
                at_end = record.samples_between(result.time - rec.AT_END, result.time)
                far = result.status == rec.ABORTED and all(
                    sample.ahead > self.limits.abort_farthest for sample in at_end
                )
                elsewhere = result.status == rec.SUCCEEDED and all(
                    goal.errors_at(sample)[0] > self.limits.reached for sample in at_end
                )
                state = rec.PREEMPTED if result.status == rec.RECALLED else result.status  # both are right
                if far or elsewhere or rec.status_name(state) != goal.ends:
                    return True
        return False

    def _step(self, step: Step) -> str:
        """Run one step of a script; returns the problem, or an empty text."""
        if step.place:
            self.stage.teleport(Pose2D(*step.place))
            self.settle(WARM_UP)
            return ""
        if step.goal:
            goal = self._send(step)
            self.stage.run_node()
        elif step.cancel:
            goal = self.entries["goals"][-1]
            self.add("cancels", rec.Cancel(self.stage.now, goal.id))
            self.topics.publish(CANCEL, GoalID(id=goal.id))
            self.stage.run_node()
        if not step.ends:
            return self._advance(goal, step.run)
        problem = self._until_end(goal)
        if not problem or step.ends == "PREEMPTED":
            self.settle(AFTER)
        return problem

    def _send(self, step: Step) -> rec.SentGoal:
        name = f"goal-{self.stage.now:.1f}"  # says nothing about the scenario to the node
        x, y = step.goal
        if step.of == "robot":
            there = compose(self.stage.odom_from_footprint(), Pose2D(x, y))
            x, y = there.x, there.y
        goal = rec.SentGoal(name, x, y, self.stage.now, step.ends or "PREEMPTED")
        self.add("goals", goal)
        message = GoToPositionActionGoal(goal=GoToPositionGoal())
        message.header.stamp = message.goal_id.stamp = self.stage.stamp
        message.goal_id.id = name
        message.goal.position.x, message.goal.position.y = x, y
        self.stage.bag.write(GOAL, message)
        self.stage.bag.write(MARKERS, MarkerArray(markers.goal(self.limits.reached, x, y, self.stage.robot.odom)))
        self.topics.publish(GOAL, message)
        return goal

    def _advance(self, goal: rec.SentGoal, seconds: float) -> str:
        for _ in range(round(seconds / TICK)):
            if goal.id in self.ended:
                return "the goal ended too early"
            problem = self._tick()
            if problem:
                return problem
        return ""

    def _until_end(self, goal: rec.SentGoal) -> str:
        """Tick until the goal has ended; returns the problem, or an empty text."""
        started, progress = self.stage.now, Progress(self.limits)
        while goal.id not in self.ended:
            problem = self._tick()
            if problem:
                return problem
            now = self.stage.now
            running = [it for it in self.entries["goals"] if it.id not in self.ended]
            if progress.missing_for(self.stage.odom_from_footprint(), running, now) > self.limits.stall:
                return f"the robot made no progress for {self.limits.stall:g} s, and the goal did not end"
            if now - started > self.limits.goal_time:
                return f"the goal did not end within {self.limits.goal_time:g} s"
        return ""

    def _tick(self) -> str:
        self._push()
        self.tick()
        return "the node died" if self.node_has_ended() else ""

    def _push(self) -> None:
        """Push the robot where the plan says so."""
        here = self.stage.odom_from_footprint()
        if self.stage.now >= self._pushed_until - 1e-6:
            self.stage.push(None)
        if self._pushes and math.hypot(here.x, here.y) > self._pushes[0].after:
            push = self._pushes.pop(0)
            self.stage.push(Twist2D(push.v, push.w))
            self._pushed_until = self.stage.now + push.seconds
