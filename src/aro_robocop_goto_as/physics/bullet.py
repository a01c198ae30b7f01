"""The engine on Bullet: robots with wheels, motors, casters and contacts."""

import ctypes
import math
from dataclasses import dataclass
from typing import List, Sequence

import numpy as np

from ..geometry import STANDARD_GRAVITY, Pose2D, Pose3D, compose3, inverse3, lifted, yaw_of
from ..robot.fleet import Fleet, library
from ..robot.model import CASTER_PREFIX, WHEEL_JOINTS, BodyState, RobotModel
from ..world.model import World
from .bullet_obstacles import ROBOT_GROUP, WORLD_GROUP, BulletObstacles
from .bullet_shapes import load_urdf
from .quiet_pybullet import pybullet

REST_LINEAR, REST_ANGULAR = 2e-3, 2e-2  # [m/s], [rad/s]: slower motion with stopped wheels is solver creep
REST_STEPS = 24  # consecutive steps below these speeds until the robot is parked
WAKE_DISTANCE = 1.0  # [m] between the centres, within which a moving obstacle keeps a robot awake
CENTRED = Pose3D()  # of a base_link whose centre of mass is its origin
TIRE_FRICTION = 1.0  # rubber on a dry floor; Bullet multiplies it with the floor's 1.0


@dataclass
class _Body:
    """One robot: its ids in Bullet, and whether it is parked."""

    body: int
    wheels: List[int]
    base_from_inertial: Pose3D
    targets: List[float]  # of the wheel motors [rad/s]
    resting_steps: int = 0
    parked: bool = False

    @property
    def stands(self) -> bool:
        """Return whether the wheel motors' target speeds are zero."""
        return self.targets == [0.0, 0.0]


class BulletEngine:
    """One Bullet world; see physics.engine for the interface."""

    def __init__(
        self, world: World, fleet: Fleet, rate: int, solver_iterations: int, wheel_torque: float, gui: bool = False
    ) -> None:
        """`rate` [Hz] of the steps; `wheel_torque` [Nm]: each wheel motor's maximum; `gui` opens pybullet's window."""
        self.client = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)
        self.fleet = fleet
        self._obstacles = BulletObstacles(world, self.client)
        self._rate, self._solver_iterations = rate, solver_iterations
        self._forces = [wheel_torque, wheel_torque]
        self._control, self._fleet_struct = library().aro_control, ctypes.byref(fleet.struct)
        self._robots: List[_Body] = []
        self._is_read = True  # whether the fleet's rows are of the last step

    def change_world(self, world: World, time: float) -> None:
        """Replace the world; obstacles that are in both worlds are not touched."""
        self._obstacles.replace(world)
        self.move_obstacles(time)
        for robot in self._robots:
            self._unpark(robot)

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """Start again with all robots at these poses and wheels at angle zero, in an empty Bullet world.

        Bullet keeps state between steps (contact caches), so only an empty world makes what follows bit-identical.
        """
        pybullet.resetSimulation(physicsClientId=self.client)
        pybullet.setGravity(0.0, 0.0, -STANDARD_GRAVITY, physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / self._rate,
            numSubSteps=1,
            numSolverIterations=self._solver_iterations,
            deterministicOverlappingPairs=1,
            physicsClientId=self.client,
        )
        self._obstacles.fill()
        self._robots = [self._load(model) for model in self.fleet.models]
        for robot, pose in enumerate(poses):
            self.place(robot, pose)

    def _load(self, model: RobotModel) -> _Body:
        """Create a robot's body at the origin."""
        client = self.client
        body, base_from_inertial = load_urdf(model, client)
        joints = {}
        for index in range(pybullet.getNumJoints(body, physicsClientId=client)):
            info = pybullet.getJointInfo(body, index, physicsClientId=client)
            joints[info[1].decode()] = index
            friction = 0.0 if info[12].decode().startswith(CASTER_PREFIX) else TIRE_FRICTION
            pybullet.changeDynamics(body, index, lateralFriction=friction, restitution=0.0, physicsClientId=client)
        for link in range(-1, len(joints)):
            pybullet.setCollisionFilterGroupMask(
                body, link, ROBOT_GROUP, WORLD_GROUP | ROBOT_GROUP, physicsClientId=client
            )
        return _Body(body, [joints[name] for name in WHEEL_JOINTS], base_from_inertial, [0.0, 0.0])

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Place the robot elsewhere, at rest; its wheels keep their angles."""
        placed = self._robots[robot]
        base = compose3(lifted(world_from_footprint), self.fleet.models[robot].footprint_from_base)
        inertial = base if placed.base_from_inertial == CENTRED else compose3(base, placed.base_from_inertial)
        pybullet.resetBasePositionAndOrientation(
            placed.body, inertial.position, inertial.orientation, physicsClientId=self.client
        )
        pybullet.resetBaseVelocity(placed.body, [0.0] * 3, [0.0] * 3, physicsClientId=self.client)
        for wheel in placed.wheels:
            angle = pybullet.getJointState(placed.body, wheel, physicsClientId=self.client)[0]
            pybullet.resetJointState(placed.body, wheel, angle, 0.0, physicsClientId=self.client)
        self.fleet.place(robot, world_from_footprint)
        self._is_read = False
        self._set_motors(placed, [0.0, 0.0])

    def _set_motors(self, robot: _Body, targets: List[float]) -> None:
        robot.targets = targets
        pybullet.setJointMotorControlArray(
            robot.body,
            robot.wheels,
            pybullet.VELOCITY_CONTROL,
            targetVelocities=targets,
            forces=self._forces,
            physicsClientId=self.client,
        )
        self._unpark(robot)

    def advance(self, first: int, steps: int) -> None:
        """Advance the base controllers and all robots by a number of steps."""
        dt = 1.0 / self._rate
        for step in range(first, first + steps):
            if self._control(self._fleet_struct, step / self._rate, dt):
                for robot, targets in zip(self._robots, self.fleet.targets.tolist()):
                    if targets != robot.targets:
                        self._set_motors(robot, targets)
            pybullet.stepSimulation(physicsClientId=self.client)
            for robot in self._robots:
                if robot.stands and not robot.parked:
                    self._park_when_at_rest(robot)
        self._is_read = False

    def update_fleet(self) -> None:
        """Update the fleet's rows to the state after the last step."""
        if self._is_read:
            return
        self._is_read = True
        fleet = self.fleet
        for row, robot in enumerate(self._robots):
            body = self.body(row)
            (x, y, _), yaw = body.world_from_base.position, yaw_of(body.world_from_base.orientation)
            (vx, vy, _), (_, _, spin) = body.linear_velocity, body.angular_velocity
            left, right = pybullet.getJointStates(robot.body, robot.wheels, physicsClientId=self.client)
            fleet.poses[row] = x, y, yaw
            fleet.twists[row] = math.cos(yaw) * vx + math.sin(yaw) * vy, spin
            fleet.wheel_angles[row] = left[0], right[0]
            fleet.wheel_speeds[row] = left[1], right[1]

    def body(self, robot: int) -> BodyState:
        """The robot's base_link in space, after the last step."""
        found = self._robots[robot]
        position, orientation = pybullet.getBasePositionAndOrientation(found.body, physicsClientId=self.client)
        linear, angular = pybullet.getBaseVelocity(found.body, physicsClientId=self.client)
        if found.base_from_inertial == CENTRED:
            return BodyState(Pose3D(position, orientation), linear, angular)
        base = compose3(Pose3D(position, orientation), inverse3(found.base_from_inertial))
        lever = np.subtract(base.position, position)
        vx, vy, vz = (np.array(linear) + np.cross(angular, lever)).tolist()
        return BodyState(base, (vx, vy, vz), angular)

    def move_obstacles(self, time: float) -> None:
        """Put the moving obstacles where they are at `time` [s]; contacts push robots out of their way.

        This also keeps nearby robots awake: in Bullet, setting the pose of one body does not wake another body.
        """
        for x, y in self._obstacles.move(time):
            for robot in self._robots:
                (robot_x, robot_y, _), _ = pybullet.getBasePositionAndOrientation(
                    robot.body, physicsClientId=self.client
                )
                if math.hypot(robot_x - x, robot_y - y) < WAKE_DISTANCE:
                    self._unpark(robot)

    def _park_when_at_rest(self, robot: _Body) -> None:
        """Put a standing robot to sleep.

        Otherwise the solver's residual moves a standing Burger by 6.6 mm per minute (with 50 iterations).
        Bullet wakes the robot when another robot touches it; move_obstacles() wakes it for moving obstacles, which are
        teleported, and `_set_motors` for a command.
        """
        linear, angular = pybullet.getBaseVelocity(robot.body, physicsClientId=self.client)
        still = all(abs(v) < REST_LINEAR for v in linear) and all(abs(w) < REST_ANGULAR for w in angular)
        robot.resting_steps = robot.resting_steps + 1 if still else 0
        if robot.resting_steps >= REST_STEPS:
            robot.parked = True
            self._activate(robot, pybullet.ACTIVATION_STATE_ENABLE_SLEEPING, pybullet.ACTIVATION_STATE_SLEEP)

    def _unpark(self, robot: _Body) -> None:
        robot.resting_steps = 0
        if robot.parked:
            robot.parked = False
            self._activate(robot, pybullet.ACTIVATION_STATE_WAKE_UP, pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)

    def _activate(self, robot: _Body, *states: int) -> None:
        for state in states:
            pybullet.changeDynamics(robot.body, -1, activationState=state, physicsClientId=self.client)

    def touching(self, robot: int) -> bool:
        """Return whether the robot touches anything but the floor."""
        points = pybullet.getContactPoints(bodyA=self._robots[robot].body, physicsClientId=self.client)
        return any(point[2] not in self._obstacles.floors for point in points)

    def close(self) -> None:
        """Free Bullet's memory."""
        pybullet.disconnect(physicsClientId=self.client)
