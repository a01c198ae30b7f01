"""World + wheel speeds -> robots on the move, by Bullet.

Besides this only bullet_shapes.py and renderer.py import pybullet.
"""

import math
from typing import Dict, List, Sequence, Set, Tuple

import numpy as np
import pybullet

from .bullet_shapes import load_urdf, shapes_of
from .geometry import STANDARD_GRAVITY, Pose2D, Pose3D, Twist2D, Vector3, compose3, lifted, yaw_of
from .robot import CASTER_PREFIX, WHEEL_JOINTS, BodyState, Pair, RobotModel, RobotState
from .shapes import Obstacle, Plane, World

WORLD_GROUP, ROBOT_GROUP = 1, 2  # Bullet's collision filter bits; rays see the world only, never the robot itself
REST_LINEAR, REST_ANGULAR = 2e-3, 2e-2  # [m/s], [rad/s]: slower than this with stopped wheels is creep of the solver
REST_STEPS = 24  # steps on end below those speeds before the robot is parked
WAKING = 1.0  # [m] from its centre to the robot's, within which an obstacle that moves keeps a robot awake
TIRE_FRICTION = 1.0  # rubber on a dry floor; Bullet multiplies it with the floor's 1.0
FLOOR = Obstacle("floor", Pose3D(), Plane((0.0, 0.0, 1.0)))


class _Body:
    """What physics keeps of one robot: Bullet's ids, its wheels' target speeds, whether it is parked."""

    def __init__(self, body: int, wheels: List[int], model: RobotModel, torque: float) -> None:
        self.body = body
        self.wheels = wheels
        self.model = model
        self.forces = [torque, torque]
        self.targets: Pair = (0.0, 0.0)
        self.resting_steps = 0
        self.parked = False


class Physics:
    """One Bullet world, stepped at `rate` [Hz] from one thread; robots are addressed in the order they were added."""

    def __init__(self, world: World, rate: int, solver_iterations: int = 50, gui: bool = False) -> None:
        self._client = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)
        self._world, self._rate, self._solver_iterations = world, rate, solver_iterations
        self._robots: List[_Body] = []
        self._floors: Set[int] = set()
        self._moving: List[Tuple[int, Obstacle]] = []  # with the bodies that they are
        self._bodies: Dict[str, List[int]] = {}  # of each obstacle, by its name
        self._fill()

    def _fill(self) -> None:
        """Floor and obstacles into an empty Bullet world."""
        self._floors, self._moving, self._bodies = set(), [], {}
        pybullet.setGravity(0.0, 0.0, -STANDARD_GRAVITY, physicsClientId=self._client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / self._rate, numSubSteps=1, numSolverIterations=self._solver_iterations,
            deterministicOverlappingPairs=1, physicsClientId=self._client)
        self._add_obstacle(FLOOR)
        for obstacle in self._world.obstacles:
            self._add_unless_floor(obstacle)

    def change_world(self, world: World, time: float) -> None:
        """Another world from now on, as it is at a time [s]; what is the same in both stays untouched."""
        before, now = set(map(id, self._world.obstacles)), set(map(id, world.obstacles))
        for obstacle in self._world.obstacles:
            if id(obstacle) not in now:
                self._remove_obstacle(obstacle)
        for obstacle in world.obstacles:
            if id(obstacle) not in before:
                self._add_unless_floor(obstacle)
        self._world = world
        self.move(time)
        for it in self._robots:
            self._unpark(it)

    def _remove_obstacle(self, obstacle: Obstacle) -> None:
        bodies = self._bodies.pop(obstacle.name, [])
        for body in bodies:
            pybullet.removeBody(body, physicsClientId=self._client)
        self._floors.difference_update(bodies)
        self._moving = [(body, other) for body, other in self._moving if body not in bodies]

    def _add_unless_floor(self, obstacle: Obstacle) -> None:
        if (obstacle.pose, obstacle.geometry) != (FLOOR.pose, FLOOR.geometry):  # most world files bring their own
            self._add_obstacle(obstacle)

    def _add_obstacle(self, obstacle: Obstacle) -> None:
        """Static bodies, of many triangles several: as rigid ones, not as multibodies, they cost 0.7 us a step less."""
        client = self._client
        for shape in shapes_of(obstacle.geometry, client):
            body = pybullet.createMultiBody(0.0, shape, basePosition=obstacle.pose.position,
                                            baseOrientation=obstacle.pose.orientation, useMaximalCoordinates=1,
                                            physicsClientId=client)
            pybullet.changeDynamics(body, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
            pybullet.setCollisionFilterGroupMask(body, -1, WORLD_GROUP, WORLD_GROUP | ROBOT_GROUP,
                                                 physicsClientId=client)
            self._bodies.setdefault(obstacle.name, []).append(body)
            if isinstance(obstacle.geometry, Plane):
                self._floors.add(body)
            if obstacle.motion is not None:
                self._moving.append((body, obstacle))

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D, wheel_torque: float) -> int:
        """Put a robot on the floor, wheels held by motors of `wheel_torque` [Nm]; returns its index."""
        client = self._client
        body = load_urdf(model, client)
        joints = {}
        for index in range(pybullet.getNumJoints(body, physicsClientId=client)):
            info = pybullet.getJointInfo(body, index, physicsClientId=client)
            joints[info[1].decode()] = index
            friction = 0.0 if info[12].decode().startswith(CASTER_PREFIX) else TIRE_FRICTION
            pybullet.changeDynamics(body, index, lateralFriction=friction, restitution=0.0, physicsClientId=client)
        for link in range(-1, len(joints)):
            pybullet.setCollisionFilterGroupMask(body, link, ROBOT_GROUP, WORLD_GROUP | ROBOT_GROUP,
                                                 physicsClientId=client)
        self._robots.append(_Body(body, [joints[name] for name in WHEEL_JOINTS], model, wheel_torque))
        self.place(len(self._robots) - 1, world_from_footprint)
        return len(self._robots) - 1

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Set a robot down at a pose, at rest; its wheels keep their angles."""
        it = self._robots[robot]
        base = compose3(lifted(world_from_footprint), it.model.footprint_from_base)
        pybullet.resetBasePositionAndOrientation(it.body, base.position, base.orientation, physicsClientId=self._client)
        pybullet.resetBaseVelocity(it.body, [0.0] * 3, [0.0] * 3, physicsClientId=self._client)
        for wheel in it.wheels:
            angle = pybullet.getJointState(it.body, wheel, physicsClientId=self._client)[0]
            pybullet.resetJointState(it.body, wheel, angle, 0.0, physicsClientId=self._client)
        it.targets = (0.0, 0.0)
        self._set_motors(it)
        self._unpark(it)

    def drive(self, robot: int, wheel_speeds: Pair) -> None:
        """Target speeds [rad/s] of the left and right wheel motor from the next step on."""
        it = self._robots[robot]
        if wheel_speeds != it.targets:
            it.targets = wheel_speeds
            self._set_motors(it)
            self._unpark(it)

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """All robots set down anew at their poses, wheels at angle zero, in a Bullet world made from nothing.

        What Bullet keeps from step to step (contact caches, rounding) is gone, so what follows repeats to the last bit.
        """
        robots, self._robots = self._robots, []
        pybullet.resetSimulation(physicsClientId=self._client)
        self._fill()
        for robot, pose in zip(robots, poses):
            self.add_robot(robot.model, pose, robot.forces[0])

    def _set_motors(self, it: _Body) -> None:
        pybullet.setJointMotorControlArray(it.body, it.wheels, pybullet.VELOCITY_CONTROL,
                                           targetVelocities=it.targets, forces=it.forces,
                                           physicsClientId=self._client)

    def step(self) -> None:
        """Advance every robot by one step."""
        pybullet.stepSimulation(physicsClientId=self._client)
        for it in self._robots:
            if it.targets == (0.0, 0.0) and not it.parked:
                self._park_when_at_rest(it)

    def move(self, time: float) -> None:
        """Have obstacles that move where they are at a time [s]; contacts push robots out of their way.

        Robots nearby are kept awake: what only moves by being set somewhere wakes nobody.
        """
        for body, obstacle in self._moving:
            pose = obstacle.at(time)
            pybullet.resetBasePositionAndOrientation(body, pose.position, pose.orientation,
                                                     physicsClientId=self._client)
            for it in self._robots:
                (x, y, _), _ = pybullet.getBasePositionAndOrientation(it.body, physicsClientId=self._client)
                if math.hypot(x - pose.position[0], y - pose.position[1]) < WAKING:
                    self._unpark(it)

    def _park_when_at_rest(self, it: _Body) -> None:
        """Let Bullet put a standing robot to sleep.

        The solver's residual would otherwise push a standing Burger 6.6 mm a minute (50 iterations, measured).
        Bullet wakes it when something that moves touches it; `drive_wheels` wakes it for a command.
        """
        linear, angular = pybullet.getBaseVelocity(it.body, physicsClientId=self._client)
        still = all(abs(v) < REST_LINEAR for v in linear) and all(abs(w) < REST_ANGULAR for w in angular)
        it.resting_steps = it.resting_steps + 1 if still else 0
        if it.resting_steps >= REST_STEPS:
            it.parked = True
            self._activate(it, pybullet.ACTIVATION_STATE_ENABLE_SLEEPING, pybullet.ACTIVATION_STATE_SLEEP)

    def _unpark(self, it: _Body) -> None:
        it.resting_steps = 0
        if it.parked:
            it.parked = False
            self._activate(it, pybullet.ACTIVATION_STATE_WAKE_UP, pybullet.ACTIVATION_STATE_DISABLE_SLEEPING)

    def _activate(self, it: _Body, *states: int) -> None:
        for state in states:
            pybullet.changeDynamics(it.body, -1, activationState=state, physicsClientId=self._client)

    def state(self, robot: int) -> RobotState:
        """One robot as of the last step."""
        it = self._robots[robot]
        (x, y, _), orientation = pybullet.getBasePositionAndOrientation(it.body, physicsClientId=self._client)
        (vx, vy, _), (_, _, spin) = pybullet.getBaseVelocity(it.body, physicsClientId=self._client)
        left, right = pybullet.getJointStates(it.body, it.wheels, physicsClientId=self._client)
        yaw = yaw_of(orientation)
        return RobotState(Pose2D(x, y, yaw), Twist2D(math.cos(yaw) * vx + math.sin(yaw) * vy, spin),
                          (left[0], right[0]), (left[1], right[1]))

    def body(self, robot: int) -> BodyState:
        """One robot's base in space as of the last step."""
        it = self._robots[robot]
        position, orientation = pybullet.getBasePositionAndOrientation(it.body, physicsClientId=self._client)
        linear, angular = pybullet.getBaseVelocity(it.body, physicsClientId=self._client)
        return BodyState(Pose3D(position, orientation), linear, angular)

    def cast_rays(self, start: Vector3, ends: np.ndarray) -> np.ndarray:
        """Where rays from `start` [m] to `ends` (n, 3) [m] first meet Bullet's bodies: fractions (n,), 1.0 = none met.

        Good to some millimetres only where a ray grazes a face or an edge, so scans come from `slice`; this is for
        checking that physics and scans see the same world.
        """
        hits = pybullet.rayTestBatch([start] * len(ends), ends.tolist(), numThreads=1,
                                     collisionFilterMask=WORLD_GROUP, physicsClientId=self._client)
        return np.array([hit[2] for hit in hits])

    def touching(self, robot: int) -> bool:
        """Whether the robot touches anything but the floor."""
        points = pybullet.getContactPoints(bodyA=self._robots[robot].body, physicsClientId=self._client)
        return any(point[2] not in self._floors for point in points)

    def close(self) -> None:
        """Give Bullet's memory back."""
        pybullet.disconnect(physicsClientId=self._client)
