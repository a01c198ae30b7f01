"""The loop of a running simulator: pacing, pausing, spans, and what has changed other than by a step."""

import pytest
from fakes import Owner
from support import ORIGIN, world_named

from aro_robocop_goto_as.geometry import Pose2D, Twist2D
from aro_robocop_goto_as.simulation.lockstep import ControllerId
from aro_robocop_goto_as.simulation.simulator import Change

NODE = ControllerId(0, "/controller")
AHEAD = Twist2D(0.1, 0.0)


@pytest.mark.parametrize("factor", [0.5, 1.0, 10.0])
def test_simulated_time_keeps_to_the_real_time_factor(factor):
    owner = Owner(2.0, real_time_factor=factor)
    owner.run()
    assert owner.clock.time - 100.0 == pytest.approx(2.0 / factor, rel=0.02)
    assert sum(due.clock for _, due in owner.seen) == 120
    stamps = [stamp_ns for stamp_ns, _ in owner.seen]
    assert stamps == sorted(stamps)


def test_factor_may_change_while_time_runs():
    owner = Owner(3.0)
    owner.post(1.0, lambda: owner.running.time_control.set_real_time_factor(4.0, owner.simulator.steps))
    owner.run()
    assert owner.clock.time == pytest.approx(101.5, abs=0.05)


def test_paused_simulation_repeats_the_clock_and_runs_jobs_until_it_is_resumed():
    owner = Owner(0.5, start_paused=True)
    times = []
    for delay in (0.31, 0.32, 0.33, 0.95):
        owner.post(delay, lambda: times.append(owner.simulator.time))
    owner.post(1.0, lambda: owner.running.set_paused(False))
    owner.run()
    assert times == [0.0] * 4
    assert owner.events.count("clock repeated") == pytest.approx(9, abs=1)
    assert owner.clock.time == pytest.approx(101.5, abs=0.05)
    assert [event for event in owner.events if event != "clock repeated"] == [{Change.PAUSED}]


@pytest.mark.parametrize("seconds, steps", [(0.26, 62), (0.0, 1)])
def test_span_runs_exactly_its_steps_one_at_least_and_then_stays_paused(seconds, steps):
    owner = Owner(start_paused=True, clock_rate=1)
    time, begun = owner.running.time_control, []
    owner.post(0.1, lambda: begun.extend(time.begin_span(asked, 0) for asked in (seconds, 1.0)))
    owner.is_stopped = lambda: owner.clock.time > 103.0
    owner.run()
    span, refused = begun
    assert refused is None, "while the first one runs"
    assert span is not None and span.result(0) == owner.simulator.steps == steps
    assert time.paused and time.standing


def test_whoever_resumes_during_a_span_lets_time_go_on_after_it():
    owner, spans = Owner(1.0, start_paused=True), []
    owner.post(0.1, lambda: spans.append(owner.running.time_control.begin_span(0.25, owner.simulator.steps)))
    owner.post(0.2, lambda: owner.running.set_paused(False))
    owner.run()
    assert spans[0] is not None and spans[0].result(0) == 60
    assert owner.clock.time < 102.0


@pytest.mark.parametrize(
    "change, announced",
    [
        (lambda sim: sim.place(Pose2D(1.0, 2.0)), {Change.FRAMES}),
        (lambda sim: sim.reset(), {Change.RESET, Change.FRAMES}),
        (lambda sim: sim.change_world(world_named("stage_2")), {Change.WORLD}),
    ],
)
def test_what_a_job_changes_is_published_once(change, announced):
    owner = Owner(0.5)
    owner.post(0.1, lambda: change(owner.simulator))
    owner.run()
    assert owner.events == [announced]


@pytest.mark.parametrize("change", [lambda sim: sim.place(ORIGIN), lambda sim: sim.reset()])
def test_command_that_waits_for_its_tick_is_dropped_when_its_robot_is_placed_or_all_are_reset(change):
    owner = Owner(0.25, real_time_factor=0.0, sync="lockstep")
    owner.running.controllers.command(NODE, AHEAD)
    change(owner.simulator)
    owner.run()
    assert owner.simulator.world_from_footprint() == ORIGIN


def test_command_that_comes_after_its_robot_was_placed_is_applied():
    owner = Owner(0.25, real_time_factor=0.0, sync="lockstep")
    owner.simulator.place(Pose2D(1.0, 2.0))
    owner.running.controllers.command(NODE, AHEAD)
    owner.run()
    assert owner.simulator.world_from_footprint().x > 1.0
