"""Commands, and how long a control tick in lockstep is held for its answers."""

import pytest
from fakes import Owner
from support import ORIGIN

from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.simulation.awaited_answers import ControllerId
from aro_robocop_goto_as.simulation.lockstep import SECOND_LOOK, STILL

NODE, ANSWERING = ControllerId(0, "/controller"), ControllerId(0, "/answering")
AHEAD = Twist2D(0.1, 0.0)


def lockstep(end: float, *nodes: str, **params: object) -> Owner:
    """As fast as possible, with these nodes connected."""
    owner = Owner(end, real_time_factor=0.0, sync="lockstep", **params)
    owner.nodes = set(nodes)
    return owner


@pytest.mark.parametrize("sync", ["free", "lockstep"])
def test_refused_command_leaves_the_previous_one_in_force(sync: str) -> None:
    owner = Owner(1.0, sync=sync)
    owner.nodes = {NODE.node}
    owner.simulation.controllers.command(NODE, AHEAD)
    owner.simulation.controllers.command(NODE, None)
    owner.run()
    assert owner.simulator.velocity().v == pytest.approx(0.1)


def test_refused_command_is_an_answer_in_lockstep() -> None:
    owner = lockstep(0.55, NODE.node)
    owner.simulation.controllers.command(NODE, None)
    owner.on_tick = lambda _stamp: owner.post(0.3, lambda: owner.simulation.controllers.command(NODE, None))
    owner.run()
    assert owner.clock.time == pytest.approx(101.5)
    assert owner.events == [] and owner.simulator.world_from_footprint() == ORIGIN


def test_tick_waits_for_each_answer_without_a_miss() -> None:
    owner = lockstep(0.55, "/answering")
    stamps = []

    def answer(stamp: int) -> None:
        stamps.append(stamp)
        owner.post(0.3, lambda: owner.simulation.controllers.answer(ANSWERING, stamp, AHEAD))

    owner.on_tick = answer
    owner.run()
    assert stamps == [tick * 10**8 for tick in range(1, 6)]
    assert owner.clock.time == pytest.approx(101.5)
    assert owner.simulation.controllers.answers.misses == 0 and owner.events == []
    assert owner.simulation.controllers.answers.awaited() == [ANSWERING]
    assert owner.simulator.world_from_footprint().x > 0.03


def test_time_goes_on_without_a_silent_controller() -> None:
    owner = lockstep(0.3, "/answering", lockstep_timeout=3.0)
    owner.run()
    assert owner.events == [("late", [ANSWERING])]
    assert owner.simulation.controllers.answers.misses == 1
    assert owner.clock.time == pytest.approx(103.0 + STILL)


def test_controller_that_gets_no_processor_is_waited_for() -> None:
    owner = lockstep(0.15, "/answering", lockstep_timeout=3.0)
    asked = []
    owner.is_kept = lambda controller, patience: not asked.append((controller, patience))
    owner.on_tick = lambda stamp: owner.post(60.0, lambda: owner.simulation.controllers.answer(ANSWERING, stamp, AHEAD))
    owner.run()
    assert set(asked) == {(ANSWERING, 3.0)}
    assert owner.simulation.controllers.answers.misses == 0 and owner.events == []
    assert owner.clock.time == pytest.approx(160.0)


@pytest.mark.parametrize("later", [SECOND_LOOK / 2, 0.55])  # [s] it was on its way, or rospy.sleep() missed a clock
def test_answer_that_comes_between_the_looks_is_no_miss(later: float) -> None:
    owner = lockstep(0.15, "/answering", lockstep_timeout=3.0)
    owner.on_tick = lambda stamp: owner.post(
        3.0 + later, lambda: owner.simulation.controllers.answer(ANSWERING, stamp, AHEAD)
    )
    owner.run()
    assert owner.simulation.controllers.answers.misses == 0


def test_robot_of_a_controller_that_disconnects_is_stopped() -> None:
    owner = lockstep(1.0, "/answering")
    owner.post(0.1, lambda: owner.simulation.controllers.answer(ANSWERING, 10**8, AHEAD))
    owner.clock.at(0.2, owner.nodes.clear)
    owner.run()
    assert ("gone", ANSWERING) in owner.events
    assert owner.simulator.world_from_footprint().x < 0.03, "one tick at most, and braking"
    assert owner.clock.time == pytest.approx(100.25, abs=0.06)


def test_another_controllers_command_outlives_one_that_disconnects() -> None:
    owner = lockstep(0.15, "/answering")
    owner.post(0.01, lambda: owner.simulation.controllers.command(NODE, AHEAD))
    owner.clock.at(0.02, owner.nodes.clear)
    owner.run()
    assert ("gone", ANSWERING) in owner.events
    assert owner.simulator.world_from_footprint().x > 0.0


def test_answer_to_a_tick_that_time_has_not_reached_is_ignored() -> None:
    owner = lockstep(0.35, "/answering")
    controllers = owner.simulation.controllers
    controllers.answers.enroll(ANSWERING)
    controllers.answer(ANSWERING, 100 * 10**9, AHEAD)
    owner.on_tick = lambda stamp: owner.post(0.1, lambda: controllers.answer(ANSWERING, stamp, None))
    owner.run()
    assert owner.clock.time == pytest.approx(100.3), "every tick waits for its own answer"
    assert owner.simulator.world_from_footprint() == ORIGIN


def test_reset_while_controllers_are_waited_for_asks_nobody_twice() -> None:
    owner = lockstep(0.35, "/answering_a", "/answering_b")
    controllers = owner.simulation.controllers
    first, second = ControllerId(0, "/answering_a"), ControllerId(0, "/answering_b")

    def answer(stamp: int) -> None:
        owner.post(0.1, lambda: controllers.answer(first, stamp, None))
        if stamp == 10**8:
            owner.post(0.15, owner.simulation.reset)
        owner.post(0.2, lambda: controllers.answer(second, stamp, None))

    owner.on_tick = answer
    owner.run()
    assert controllers.answers.misses == 0
    assert owner.clock.time < 101.0


def test_controllers_that_connect_while_time_stands_still_are_waited_for_from_the_first_tick() -> None:
    owner = lockstep(0.15, start_paused=True)
    controllers = owner.simulation.controllers
    owner.clock.at(0.5, lambda: owner.nodes.add("/answering"))
    owner.post(1.0, lambda: owner.simulation.set_paused(False))
    owner.on_tick = lambda stamp: owner.post(0.3, lambda: controllers.answer(ANSWERING, stamp, None))
    owner.run()
    assert owner.clock.time == pytest.approx(101.3) and controllers.answers.misses == 0


@pytest.mark.parametrize("ticks", [1.0, 1.5])
def test_controller_that_connects_while_time_stands_is_awaited_at_the_next_tick(ticks: float) -> None:
    owner = lockstep(0.1 * ticks)
    controllers = owner.simulation.controllers
    owner.run()
    controllers.command(NODE, AHEAD)  # notes the tick towards which time runs
    controllers.enroll(lambda robot: {ANSWERING.node})
    controllers.begin_tick()
    controllers.answers.gone(NODE)
    controllers.answers.tick = 2
    assert controllers.answers.missing() == [ANSWERING]


def test_command_of_an_answer_counts_once_its_sender_is_enrolled() -> None:
    owner = lockstep(0.05)
    controllers = owner.simulation.controllers
    for enrolled in (False, True):
        if enrolled:
            controllers.enroll(lambda robot: {ANSWERING.node})
        controllers.answer(ANSWERING, 0, AHEAD)
        assert bool(controllers._pending) == enrolled
