"""The simulation loop with a fake engine and a fake wall clock: pacing, pausing, spans, jobs and lockstep."""

import threading
from typing import AbstractSet, Callable, List, Optional, Sequence, Set

import pytest
from fakes import FakeClock, FakeEngine
from support import ORIGIN, model_named, world_named

from aro_robocop_goto_as.component_params import LockstepParams, TimeParams
from aro_robocop_goto_as.errors import CommandError, PlaceError, ShutdownError, WorldError
from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.robot.base_controller import limits_from
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.simulation.factory import simulator_config
from aro_robocop_goto_as.simulation.lockstep import Controller
from aro_robocop_goto_as.simulation.loop import SimulationLoop
from aro_robocop_goto_as.simulation.loop_interface import LoopInterface
from aro_robocop_goto_as.simulation.observations import Observations, Subscriptions
from aro_robocop_goto_as.simulation.simulator import Simulator

PARAMS = SimParams(cmd_vel_timeout=0.0)
NODE = Controller(0, "/controller")
AHEAD = Twist2D(0.1, 0.0)


class Recorder(LoopInterface):
    """Records what the loop does, and ends it at a simulated time [s]."""

    def __init__(self, end: float = 1.0) -> None:
        self.end = end
        self.loop: Optional[SimulationLoop] = None
        self.on_stopped: Callable[[], bool] = lambda: False
        self.observed: List[Observations] = []
        self.events: List[object] = []
        self.nodes: Set[str] = set()

    def stopped(self) -> bool:
        return self.on_stopped() or (self.loop is not None and self.loop.simulator.time >= self.end)

    def subscriptions(self) -> Subscriptions:
        return {"odom": [0]}

    def publish(self, observations: Observations) -> None:
        self.observed.append(observations)

    def publish_clock(self) -> None:
        self.events.append("clock repeated")

    def status_changed(self) -> None:
        self.events.append("status")

    def frames_changed(self) -> None:
        self.events.append("frames")

    def world_changed(self) -> None:
        self.events.append("world")

    def connected(self, robot: int) -> AbstractSet[str]:
        return self.nodes

    def answering(self, robot: int) -> AbstractSet[str]:
        return {node for node in self.nodes if node.startswith("/answering")}

    def command_refused(self, error: CommandError) -> None:
        self.events.append(str(error))

    def controllers_late(self, controllers: Sequence[Controller]) -> None:
        self.events.append(("late", list(controllers)))

    def controller_gone(self, controller: Controller) -> None:
        self.events.append(("gone", controller))


def make(
    recorder: Recorder,
    clock: FakeClock,
    factor: float = 1.0,
    paused: bool = False,
    lockstep: bool = False,
    reset_time: bool = False,
) -> SimulationLoop:
    world, model = world_named("empty"), model_named("burger")
    engine = FakeEngine(PARAMS.physics_rate)
    limits = [limits_from(PARAMS.limits(), model.figures)]
    simulator = Simulator(simulator_config(PARAMS, [model]), world, engine, [RobotSpec("", model, ORIGIN)], limits)
    params = LockstepParams(lockstep, PARAMS.control_rate, 2.0)
    recorder.loop = SimulationLoop(simulator, TimeParams(factor, paused, reset_time), params, recorder, clock)
    return recorder.loop


@pytest.mark.parametrize("factor", [0.5, 1.0, 10.0])
def test_simulated_time_keeps_to_the_real_time_factor(factor: float) -> None:
    clock, recorder = FakeClock(), Recorder(end=2.0)
    make(recorder, clock, factor).run()
    assert clock.time - 100.0 == pytest.approx(2.0 / factor, rel=0.02)
    assert sum(seen.clock for seen in recorder.observed) == 120
    assert [seen.stamp_ns for seen in recorder.observed] == sorted(seen.stamp_ns for seen in recorder.observed)


def test_with_factor_zero_the_loop_never_waits() -> None:
    clock, recorder = FakeClock(), Recorder(end=5.0)
    make(recorder, clock, factor=0.0).run()
    assert clock.time == 100.0


def test_a_paused_loop_repeats_the_clock_and_runs_jobs_until_it_is_resumed() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.5)
    loop = make(recorder, clock, paused=True)
    times: List[float] = []
    clock.at(0.95, lambda: loop.post(lambda: times.append(loop.simulator.time)))
    clock.at(1.0, lambda: loop.post(lambda: loop.set_paused(False)))
    loop.run()
    assert times == [0.0]
    assert recorder.events.count("clock repeated") == pytest.approx(9, abs=1)
    assert clock.time == pytest.approx(101.5, abs=0.05)


def test_span_runs_exactly_its_steps_and_then_stays_paused() -> None:
    clock, recorder = FakeClock(), Recorder(end=9.0)
    loop = make(recorder, clock, paused=True)
    ended: List[int] = []
    begun: List[bool] = []

    def begin() -> None:
        begun.append(loop.begin_span(0.25, lambda: ended.append(loop.simulator.steps)))
        begun.append(loop.begin_span(1.0, lambda: ended.append(-1)))  # refused while the first one runs

    clock.at(0.1, lambda: loop.post(begin))
    recorder.on_stopped = lambda: clock.time > 103.0
    loop.run()
    assert begun == [True, False]
    assert ended == [60]
    assert loop.paused and loop.simulator.steps == 60


def test_whoever_resumes_during_a_span_lets_time_go_on_after_it() -> None:
    clock, recorder = FakeClock(), Recorder(end=1.0)
    loop = make(recorder, clock, paused=True)
    ended: List[int] = []
    clock.at(0.1, lambda: loop.post(lambda: loop.begin_span(0.25, lambda: ended.append(loop.simulator.steps))))
    clock.at(0.2, lambda: loop.post(lambda: loop.set_paused(False)))
    clock.at(5.0, lambda: setattr(recorder, "on_stopped", lambda: True))
    loop.run()
    assert ended == [60]
    assert loop.simulator.time == pytest.approx(1.0, abs=0.01)


def test_command_moves_the_robot() -> None:
    clock, recorder = FakeClock(), Recorder(end=1.0)
    loop = make(recorder, clock)
    loop.post(lambda: loop.controllers.command(NODE, AHEAD))
    loop.run()
    assert loop.simulator.world_from_footprint().x > 0.05


def test_non_finite_command_is_reported_and_ignored() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.2)
    loop = make(recorder, clock)
    loop.post(lambda: loop.controllers.command(NODE, Twist2D(float("nan"), 0.0)))
    loop.run()
    assert "nan" in str(recorder.events)
    assert loop.simulator.world_from_footprint().x == 0.0


def test_lockstep_waits_for_each_answer_without_a_miss() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.55)
    recorder.nodes = {"/answering"}
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    node = Controller(0, "/answering")
    waits: List[float] = []

    def answer_when_observed(observations: Observations) -> None:
        recorder.observed.append(observations)
        if observations.control:
            waits.append(clock.time)
            clock.at(0.3, lambda: loop.post(lambda: loop.controllers.answer(node, observations.stamp_ns, AHEAD)))

    recorder.publish = answer_when_observed  # type: ignore[method-assign]
    loop.run()
    assert len(waits) == 5
    assert clock.time == pytest.approx(101.5)
    assert loop.controllers.lockstep.misses == 0
    assert not [event for event in recorder.events if isinstance(event, tuple)]


def test_lockstep_continues_without_a_silent_controller() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.3)
    recorder.nodes = {"/answering"}
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    loop.run()
    assert ("late", [Controller(0, "/answering")]) in recorder.events
    assert loop.controllers.lockstep.misses == 1


def test_lockstep_stops_the_robot_of_a_controller_that_disconnects() -> None:
    clock, recorder = FakeClock(), Recorder(end=1.0)
    recorder.nodes = {"/answering"}
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    node = Controller(0, "/answering")
    clock.at(0.1, lambda: loop.post(lambda: loop.controllers.answer(node, 100000000, AHEAD)))
    clock.at(0.2, recorder.nodes.clear)
    loop.run()
    assert ("gone", node) in recorder.events
    travelled = loop.simulator.world_from_footprint().x
    assert travelled < 0.03, "one tick at most, and braking"
    assert clock.time == pytest.approx(100.25, abs=0.06)


def test_call_from_another_thread_returns_the_jobs_result_or_raises_its_error() -> None:
    recorder, clock = Recorder(end=1e9), FakeClock()
    loop = make(recorder, clock, factor=0.0)
    done = threading.Event()
    recorder.on_stopped = done.is_set
    outcomes: List[object] = []

    def refuse() -> None:
        raise WorldError("no such model")

    def caller() -> None:
        outcomes.append(loop.call(lambda: loop.simulator.robots[0].model.name))
        with pytest.raises(WorldError, match="no such model"):
            loop.call(refuse)
        outcomes.append("raised")
        done.set()

    thread = threading.Thread(target=caller)
    thread.start()
    loop.run()
    thread.join(10.0)
    assert outcomes == ["turtlebot3_burger", "raised"]
    with pytest.raises(ShutdownError):
        loop.call(lambda: None)


def test_reset_and_place_announce_new_frames_and_drop_pending_commands() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.25)
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    loop.controllers.command(NODE, AHEAD)
    loop.place(Pose2D(1.0, 2.0))
    assert recorder.events == ["frames"]
    loop.controllers.command(NODE, AHEAD)
    loop.reset()
    assert recorder.events == ["frames", "frames", "status"]
    loop.run()
    assert loop.simulator.world_from_footprint() == ORIGIN


def test_a_robot_is_placed_only_where_it_has_room() -> None:
    recorder = Recorder()
    loop = make(recorder, FakeClock())
    loop.change_world(lambda world: world_named("stage_2"))
    with pytest.raises(PlaceError, match="expected at least the robot's radius"):
        loop.place_with_room(Pose2D(0.6, 0.6))
    assert loop.simulator.world_from_footprint() == ORIGIN
    loop.place_with_room(Pose2D(0.0, 1.0))
    assert loop.simulator.world_from_footprint() == Pose2D(0.0, 1.0)


def test_simulator_advances_before_it_measures_and_reads_bodies_only_for_subscribed_imus() -> None:
    clock, recorder = FakeClock(), Recorder(end=1.0)
    loop = make(recorder, clock)
    engine = loop.simulator.engine
    assert isinstance(engine, FakeEngine)
    loop.simulator.step({})
    assert engine.calls == ["step"]
    engine.calls.clear()
    loop.simulator.command(AHEAD)
    while loop.simulator.step({"imu": [0]}) is None:
        engine.calls.clear()
    assert engine.calls == ["body", "set_wheel_speeds", "step", "body"]


def test_an_answer_from_before_time_was_set_back_is_ignored() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.35)
    recorder.nodes = {"/answering"}
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    node = Controller(0, "/answering")
    loop.controllers.lockstep.enroll(node)
    loop.controllers.answer(node, 100 * 10**9, AHEAD)

    def answer_when_observed(observations: Observations) -> None:
        if observations.control:
            clock.at(0.1, lambda: loop.post(lambda: loop.controllers.answer(node, observations.stamp_ns, None)))

    recorder.publish = answer_when_observed  # type: ignore[method-assign]
    loop.run()
    assert clock.time == pytest.approx(100.3), "every tick waits for its own answer"
    assert loop.simulator.world_from_footprint() == ORIGIN


def test_a_reset_while_controllers_are_waited_for_asks_nobody_twice() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.35)
    recorder.nodes = {"/answering_a", "/answering_b"}
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    first, second = Controller(0, "/answering_a"), Controller(0, "/answering_b")

    def answer_when_observed(observations: Observations) -> None:
        if observations.control:
            stamp = observations.stamp_ns
            clock.at(0.1, lambda: loop.post(lambda: loop.controllers.answer(first, stamp, None)))
            if stamp == 10**8:
                clock.at(0.15, lambda: loop.post(loop.reset))
            clock.at(0.2, lambda: loop.post(lambda: loop.controllers.answer(second, stamp, None)))

    recorder.publish = answer_when_observed  # type: ignore[method-assign]
    loop.run()
    assert loop.controllers.lockstep.misses == 0
    assert clock.time < 101.0


def test_a_span_keeps_its_length_when_a_reset_sets_time_back() -> None:
    clock, recorder = FakeClock(), Recorder(end=1e9)
    loop = make(recorder, clock, factor=0.0, paused=True, reset_time=True)
    ended: List[int] = []
    loop.post(lambda: loop.begin_span(2.0, lambda: ended.append(1)))
    recorder.on_stopped = lambda: clock.time > 101.0
    loop.run()
    assert loop.simulator.steps == 480
    loop.begin_span(0.5, lambda: ended.append(2))
    loop.reset()
    clock.time, recorder.on_stopped = 100.0, lambda: clock.time > 101.0
    loop.run()
    assert ended == [1, 2]
    assert loop.simulator.steps == 120


def test_another_controllers_command_outlives_one_that_disconnects() -> None:
    clock, recorder = FakeClock(), Recorder(end=0.15)
    recorder.nodes = {"/answering"}
    loop = make(recorder, clock, factor=0.0, lockstep=True)
    clock.at(0.01, lambda: loop.post(lambda: loop.controllers.command(NODE, AHEAD)))
    clock.at(0.02, recorder.nodes.clear)
    loop.run()
    assert ("gone", Controller(0, "/answering")) in recorder.events
    assert loop.simulator.world_from_footprint().x > 0.0
