"""The engine on Bullet: robots with wheels, motors, casters and contacts."""

import math
from typing import Dict, List, Sequence, Set, Tuple

from ..geometry import STANDARD_GRAVITY, Pose2D, Pose3D, Twist2D, compose3, lifted, yaw_of
from ..robot.model import CASTER_PREFIX, WHEEL_JOINTS, BodyState, Pair, RobotModel, RobotState
from ..world.model import Obstacle, Plane, World
from .bullet_shapes import FLOOR, load_urdf, shapes_of
from .quiet_pybullet import pybullet

WORLD_GROUP, ROBOT_GROUP = 1, 2  # Bullet's collision filter bits
REST_LINEAR, REST_ANGULAR = 2e-3, 2e-2  # [m/s], [rad/s]: slower motion with stopped wheels is solver creep
REST_STEPS = 24  # consecutive steps below these speeds until the robot is parked
WAKING = 1.0  # [m] between the centres, within which a moving obstacle keeps a robot awake
TIRE_FRICTION = 1.0  # rubber on a dry floor; Bullet multiplies it with the floor's 1.0


class _Body:
    """One robot: its ids in Bullet, its target wheel speeds, whether it is parked."""

    def __init__(self, body: int, wheels: List[int], model: RobotModel, torque: float) -> None:
        self.body = body
        self.wheels = wheels
        self.model = model
        self.forces = [torque, torque]
        self.targets: Pair = (0.0, 0.0)
        self.resting_steps = 0
        self.parked = False


class BulletEngine:
    """One Bullet world, stepped at `rate` [Hz]."""

    def __init__(self, world: World, rate: int, solver_iterations: int, wheel_torque: float, gui: bool = False) -> None:
        """`wheel_torque` [Nm] is the maximum of each wheel motor; `gui` opens pybullet's own window."""
        self.client = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)
        self._world, self._rate, self._solver_iterations = world, rate, solver_iterations
        self._wheel_torque = wheel_torque
        self._robots: List[_Body] = []
        self._floors: Set[int] = set()
        self._moving: List[Tuple[int, Obstacle]] = []  # body and obstacle
        self._bodies: Dict[str, List[int]] = {}  # by the name of the obstacle
        self._fill()

    def _fill(self) -> None:
        """Add the floor and the obstacles to an empty Bullet world."""
        self._floors, self._moving, self._bodies = set(), [], {}
        pybullet.setGravity(0.0, 0.0, -STANDARD_GRAVITY, physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=1.0 / self._rate,
            numSubSteps=1,
            numSolverIterations=self._solver_iterations,
            deterministicOverlappingPairs=1,
            physicsClientId=self.client,
        )
        self._add_obstacle(FLOOR)
        for obstacle in self._world.obstacles:
            self._add_unless_floor(obstacle)

    def change_world(self, world: World, time: float) -> None:
        """Replace the world; obstacles that are in both worlds are not touched."""
        before, now = set(map(id, self._world.obstacles)), set(map(id, world.obstacles))
        for obstacle in self._world.obstacles:
            if id(obstacle) not in now:
                self._remove_obstacle(obstacle)
        for obstacle in world.obstacles:
            if id(obstacle) not in before:
                self._add_unless_floor(obstacle)
        self._world = world
        self.move_obstacles(time)
        for it in self._robots:
            self._unpark(it)

    def _remove_obstacle(self, obstacle: Obstacle) -> None:
        bodies = self._bodies.pop(obstacle.name, [])
        for body in bodies:
            pybullet.removeBody(body, physicsClientId=self.client)
        self._floors.difference_update(bodies)
        self._moving = [(body, other) for body, other in self._moving if body not in bodies]

    def _add_unless_floor(self, obstacle: Obstacle) -> None:
        if (obstacle.pose, obstacle.geometry) != (
            FLOOR.pose,
            FLOOR.geometry,
        ):  # most world files have their own
            self._add_obstacle(obstacle)

    def _add_obstacle(self, obstacle: Obstacle) -> None:
        """One static body per shape; as rigid bodies, not multibodies, they cost 0.7 us less per step."""
        client = self.client
        for shape in shapes_of(obstacle.geometry, client):
            body = pybullet.createMultiBody(
                0.0,
                shape,
                basePosition=obstacle.pose.position,
                baseOrientation=obstacle.pose.orientation,
                useMaximalCoordinates=1,
                physicsClientId=client,
            )
            pybullet.changeDynamics(body, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
            pybullet.setCollisionFilterGroupMask(
                body, -1, WORLD_GROUP, WORLD_GROUP | ROBOT_GROUP, physicsClientId=client
            )
            self._bodies.setdefault(obstacle.name, []).append(body)
            if isinstance(obstacle.geometry, Plane):
                self._floors.add(body)
            if obstacle.motion is not None:
                self._moving.append((body, obstacle))

    def add_robot(self, model: RobotModel, world_from_footprint: Pose2D) -> int:
        """Place a robot at rest on the floor; returns its index."""
        client = self.client
        body = load_urdf(model, client)
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
        self._robots.append(_Body(body, [joints[name] for name in WHEEL_JOINTS], model, self._wheel_torque))
        self.place(len(self._robots) - 1, world_from_footprint)
        return len(self._robots) - 1

    def place(self, robot: int, world_from_footprint: Pose2D) -> None:
        """Place the robot elsewhere, at rest; its wheels keep their angles."""
        it = self._robots[robot]
        base = compose3(lifted(world_from_footprint), it.model.footprint_from_base)
        pybullet.resetBasePositionAndOrientation(it.body, base.position, base.orientation, physicsClientId=self.client)
        pybullet.resetBaseVelocity(it.body, [0.0] * 3, [0.0] * 3, physicsClientId=self.client)
        for wheel in it.wheels:
            angle = pybullet.getJointState(it.body, wheel, physicsClientId=self.client)[0]
            pybullet.resetJointState(it.body, wheel, angle, 0.0, physicsClientId=self.client)
        it.targets = (0.0, 0.0)
        self._set_motors(it)
        self._unpark(it)

    def set_wheel_speeds(self, robot: int, wheel_speeds: Pair) -> None:
        """Target speeds [rad/s] of the left and right wheel motor from the next step on."""
        it = self._robots[robot]
        if wheel_speeds != it.targets:
            it.targets = wheel_speeds
            self._set_motors(it)
            self._unpark(it)

    def reset(self, poses: Sequence[Pose2D]) -> None:
        """Start again with all robots at these poses and wheels at angle zero, in an empty Bullet world.

        Bullet keeps state between steps (contact caches), so only an empty world makes what follows bit-identical.
        """
        robots, self._robots = self._robots, []
        pybullet.resetSimulation(physicsClientId=self.client)
        self._fill()
        for robot, pose in zip(robots, poses):
            self.add_robot(robot.model, pose)

    def _set_motors(self, it: _Body) -> None:
        pybullet.setJointMotorControlArray(
            it.body,
            it.wheels,
            pybullet.VELOCITY_CONTROL,
            targetVelocities=it.targets,
            forces=it.forces,
            physicsClientId=self.client,
        )

    def step(self) -> None:
        """Advance every robot by one step."""
        pybullet.stepSimulation(physicsClientId=self.client)
        for it in self._robots:
            if it.targets == (0.0, 0.0) and not it.parked:
                self._park_when_at_rest(it)

    def move_obstacles(self, time: float) -> None:
        """Put the moving obstacles where they are at `time` [s]; contacts push robots out of their way.

        Nearby robots are kept awake: Bullet wakes no body for another one whose pose is set.
        """
        for body, obstacle in self._moving:
            pose = obstacle.at(time)
            pybullet.resetBasePositionAndOrientation(body, pose.position, pose.orientation, physicsClientId=self.client)
            for it in self._robots:
                (x, y, _), _ = pybullet.getBasePositionAndOrientation(it.body, physicsClientId=self.client)
                if math.hypot(x - pose.position[0], y - pose.position[1]) < WAKING:
                    self._unpark(it)

    def _park_when_at_rest(self, it: _Body) -> None:
        """Put a standing robot to sleep.

        Otherwise the solver's residual moves a standing Burger by 6.6 mm per minute (with 50 iterations).
        Bullet wakes it when a moving body touches it, `set_wheel_speeds` wakes it for a command.
        """
        linear, angular = pybullet.getBaseVelocity(it.body, physicsClientId=self.client)
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
            pybullet.changeDynamics(it.body, -1, activationState=state, physicsClientId=self.client)

    def state(self, robot: int) -> RobotState:
        """The robot seen from above, after the last step."""
        it = self._robots[robot]
        (x, y, _), orientation = pybullet.getBasePositionAndOrientation(it.body, physicsClientId=self.client)
        (vx, vy, _), (_, _, spin) = pybullet.getBaseVelocity(it.body, physicsClientId=self.client)
        left, right = pybullet.getJointStates(it.body, it.wheels, physicsClientId=self.client)
        yaw = yaw_of(orientation)
        return RobotState(
            Pose2D(x, y, yaw),
            Twist2D(math.cos(yaw) * vx + math.sin(yaw) * vy, spin),
            (left[0], right[0]),
            (left[1], right[1]),
        )

    def body(self, robot: int) -> BodyState:
        """The robot's base_link in space, after the last step."""
        it = self._robots[robot]
        position, orientation = pybullet.getBasePositionAndOrientation(it.body, physicsClientId=self.client)
        linear, angular = pybullet.getBaseVelocity(it.body, physicsClientId=self.client)
        return BodyState(Pose3D(position, orientation), linear, angular)

    def touching(self, robot: int) -> bool:
        """Whether the robot touches anything but the floor."""
        points = pybullet.getContactPoints(bodyA=self._robots[robot].body, physicsClientId=self.client)
        return any(point[2] not in self._floors for point in points)

    def close(self) -> None:
        """Free Bullet's memory."""
        pybullet.disconnect(physicsClientId=self.client)
