"""A fake engine without physics, and a fake wall clock that advances only while the loop waits."""

import queue
from typing import Callable, List, Sequence, Tuple

from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D
from aro_robocop_goto_as.robot.model import BodyState, Pair, RobotModel, RobotState
from aro_robocop_goto_as.simulation.wall_clock import Job, Jobs
from aro_robocop_goto_as.world.model import World


class FakeEngine:
    """Robots move along x only, by the mean of their wheel speeds, and never touch anything."""

    def __init__(self, rate: int) -> None:
        self.rate = rate
        self.calls: List[str] = []
        self.models: List[RobotModel] = []
        self.poses: List[Pose2D] = []
        self.speeds: List[Pair] = []

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D) -> int:
        self.models.append(model)
        self.poses.append(world_from_footprint)
        self.speeds.append((0.0, 0.0))
        return len(self.poses) - 1

    def set_wheel_speeds(self, robot: int, wheel_speeds: Pair) -> None:
        self.calls.append("set_wheel_speeds")
        self.speeds[robot] = wheel_speeds

    def step(self) -> None:
        self.calls.append("step")
        self.poses = [
            Pose2D(pose.x + sum(speeds) / 2.0 * model.wheel_radius / self.rate, pose.y, pose.yaw)
            for pose, speeds, model in zip(self.poses, self.speeds, self.models)
        ]

    def move_obstacles(self, time: float) -> None:
        self.calls.append(f"move_obstacles {time:.6f}")

    def state(self, robot: int) -> RobotState:
        return RobotState(self.poses[robot], Twist2D(), (0.0, 0.0), self.speeds[robot])

    def body(self, robot: int) -> BodyState:
        self.calls.append("body")
        return BodyState(Pose3D((self.poses[robot].x, 0.0, 0.0)), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def touching(self, robot: int) -> bool:
        return False

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        self.poses[robot] = world_from_footprint
        self.speeds[robot] = (0.0, 0.0)

    def reset(self, poses: Sequence[Pose2D]) -> None:
        self.calls.append("reset")
        self.poses = list(poses)
        self.speeds = [(0.0, 0.0) for _ in poses]

    def change_world(self, world: World, time: float) -> None:
        self.calls.append("change_world")

    def close(self) -> None:
        self.calls.append("close")


class FakeClock:
    """Waiting takes no real time; actions may be scheduled at a time [s] of this clock."""

    def __init__(self) -> None:
        self.time = 100.0
        self._scheduled: List[Tuple[float, Callable[[], object]]] = []

    def at(self, delay: float, action: Callable[[], object]) -> None:
        """Schedule an action, such as posting a job, after a delay [s]."""
        self._scheduled.append((self.time + delay, action))
        self._scheduled.sort(key=lambda entry: entry[0])

    def now(self) -> float:
        return self.time

    def get(self, jobs: "Jobs[Job]", timeout: float) -> Job:
        deadline = self.time + max(0.0, timeout)
        while jobs.empty():
            if not self._scheduled or self._scheduled[0][0] > deadline:
                self.time = deadline
                raise queue.Empty
            self.time, action = self._scheduled.pop(0)
            action()
        return jobs.get_nowait()
