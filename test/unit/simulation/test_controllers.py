"""Commands, and how long a control tick in lockstep is held for its answers."""

import pytest
from fakes import Owner
from support import ORIGIN

from aro_robocop_goto_as.geometry import Twist2D
from aro_robocop_goto_as.simulation.lockstep import SILENCE_TIMEOUT, ControllerId

NODE, OTHER, ANSWERING = (ControllerId(0, name) for name in ("/controller", "/other", "/answering"))
AHEAD, BACK = Twist2D(0.1, 0.0), Twist2D(-0.1, 0.0)
TICK = 10**8  # [ns]


def lockstep(end, *nodes, **params):
    """As fast as possible, with these nodes connected, and a timeout of 3 s."""
    owner = Owner(end, real_time_factor=0.0, sync="lockstep", lockstep_timeout=3.0, **params)
    owner.nodes = {node.node for node in nodes}
    return owner


def sends(owner, node, delay, twist=AHEAD):
    """Have a node send a command after a delay [s, wall] from now."""
    owner.post(delay, lambda: owner.running.controllers.command(node, twist))


def answers(owner, node, stamp, delay, twist=AHEAD):
    owner.post(delay, lambda: owner.running.controllers.answer(node, stamp, twist))


def waited(owner):
    """Wall time of a run [s]."""
    return owner.clock.time - 100.0


@pytest.mark.parametrize("sync", ["free", "lockstep"])
def test_refused_command_leaves_the_previous_one_in_force(sync):
    owner = Owner(1.0, sync=sync)
    owner.nodes = {NODE.node}
    owner.running.controllers.command(NODE, AHEAD)
    owner.running.controllers.command(NODE, None)
    owner.run()
    assert owner.simulator.velocity().v == pytest.approx(0.1)


def test_refused_command_is_an_answer_in_lockstep():
    owner = lockstep(0.35, NODE)
    owner.on_tick = lambda _stamp: sends(owner, NODE, 0.01, None)
    owner.run()
    assert waited(owner) == pytest.approx(0.03)
    assert owner.events == [] and owner.simulator.world_from_footprint() == ORIGIN


@pytest.mark.parametrize("nodes, held", [([NODE], 5 * SILENCE_TIMEOUT), ([], 0.0)])
def test_only_a_node_that_is_connected_costs_its_timeout_if_silent_and_is_no_miss(nodes, held):
    owner = lockstep(0.55, *nodes)
    owner.run()
    assert waited(owner) == pytest.approx(held)
    assert owner.events == [] and owner.running.controllers.lockstep.misses == 0


def test_loop_at_the_ticks_rate_is_followed_from_its_third_command_on_however_slow_it_is():
    owner = lockstep(1.05, NODE)
    owner.on_tick = lambda stamp: sends(owner, NODE, 0.01 if stamp <= 2 * TICK else 2.0)
    owner.run()
    assert waited(owner) == pytest.approx(2 * 0.01 + 8 * 2.0)
    assert owner.running.controllers.lockstep.misses == 0
    assert owner.running.controllers.lockstep.expected() == [NODE]


def test_loop_at_half_the_rate_costs_a_silence_at_each_tick_between():
    owner = lockstep(1.05, NODE)
    owner.on_tick = lambda stamp: None if stamp // TICK % 2 else sends(owner, NODE, 0.01)
    owner.run()
    assert waited(owner) == pytest.approx(5 * 0.01 + 5 * SILENCE_TIMEOUT)
    assert owner.events == [] and owner.running.controllers.lockstep.misses == 0


def test_loop_that_pauses_costs_one_timeout_and_one_warning_and_is_followed_again():
    owner = lockstep(4.05, NODE)
    owner.on_tick = lambda stamp: None if 5 <= stamp // TICK < 35 else sends(owner, NODE, 0.01)
    owner.run()
    assert owner.events == [("late", [NODE])] and owner.running.controllers.lockstep.misses == 1
    assert waited(owner) == pytest.approx(4 * 0.01 + 3.0 + 29 * SILENCE_TIMEOUT + 6 * 0.01)
    assert owner.running.controllers.lockstep.expected() == [NODE]


@pytest.mark.parametrize("first, second", [(NODE, OTHER), (OTHER, NODE)])
def test_of_several_nodes_the_last_by_name_commands_the_robot(first, second):
    owner = lockstep(0.55, NODE, OTHER)
    twists = {NODE: AHEAD, OTHER: BACK}

    def both(_stamp):
        sends(owner, first, 0.001, twists[first])
        sends(owner, second, 0.002, twists[second])

    owner.on_tick = both
    owner.run()
    assert owner.simulator.velocity().v < 0.0


def test_node_that_answers_ticks_is_waited_for_from_its_first_answer_on():
    owner = lockstep(0.55, ANSWERING)
    owner.on_tick = lambda stamp: answers(owner, ANSWERING, stamp, 0.01 if stamp == TICK else 2.0)
    owner.run()
    assert waited(owner) == pytest.approx(0.01 + 4 * 2.0)
    assert owner.running.controllers.lockstep.misses == 0 and owner.events == []
    assert owner.running.controllers.lockstep.expected() == [ANSWERING]
    assert owner.simulator.world_from_footprint().x > 0.03


def test_node_that_answers_while_time_stands_still_is_waited_for_at_the_first_tick():
    owner = lockstep(0.15, ANSWERING, start_paused=True)
    answers(owner, ANSWERING, 0, 0.5, None)
    owner.post(1.0, lambda: owner.running.set_paused(False))
    owner.on_tick = lambda stamp: answers(owner, ANSWERING, stamp, 2.0)
    owner.run()
    assert waited(owner) == pytest.approx(3.0) and owner.running.controllers.lockstep.misses == 0


def test_answering_node_that_hangs_costs_one_timeout_and_is_expected_after_two_answers():
    owner = lockstep(0.85, ANSWERING)

    def answer(stamp):
        if not 3 <= stamp // TICK < 5:
            answers(owner, ANSWERING, stamp, 0.01 if stamp // TICK < 7 else 2.0)

    owner.on_tick = answer
    owner.run()
    assert owner.events == [("late", [ANSWERING])] and owner.running.controllers.lockstep.misses == 1
    assert waited(owner) == pytest.approx(2 * 0.01 + 3.0 + SILENCE_TIMEOUT + 2 * 0.01 + 2 * 2.0)


def test_commands_of_an_answering_node_are_ignored():
    owner = lockstep(0.35, ANSWERING)

    def answer(stamp):
        sends(owner, ANSWERING, 0.001, BACK)
        answers(owner, ANSWERING, stamp, 0.002)

    answers(owner, ANSWERING, 0, 0.0)
    owner.on_tick = answer
    owner.run()
    assert owner.simulator.velocity().v > 0.0


def test_answer_to_a_tick_that_time_has_not_reached_is_ignored():
    owner = lockstep(0.35, ANSWERING)
    controllers = owner.running.controllers
    controllers.answer(ANSWERING, 0, None)
    controllers.answer(ANSWERING, 100 * 10**9, AHEAD)
    owner.on_tick = lambda stamp: answers(owner, ANSWERING, stamp, 0.1, None)
    owner.run()
    assert waited(owner) == pytest.approx(0.3), "every tick waits for its own answer"
    assert owner.simulator.world_from_footprint() == ORIGIN


def test_expected_node_that_disconnects_is_not_waited_for_and_its_robot_is_stopped():
    owner = lockstep(1.0, ANSWERING)
    owner.on_tick = lambda stamp: answers(owner, ANSWERING, stamp, 0.0) if stamp == TICK else None
    owner.clock.at(0.2, owner.nodes.clear)
    owner.run()
    assert owner.events == [("gone", ANSWERING)]
    assert owner.simulator.world_from_footprint().x < 0.03, "one tick at most, and braking"
    assert waited(owner) == pytest.approx(0.25, abs=0.06)


def test_another_nodes_command_outlives_one_that_disconnects():
    owner = lockstep(0.35, NODE, ANSWERING)
    answers(owner, ANSWERING, 0, 0.0)
    owner.on_tick = lambda _stamp: sends(owner, NODE, 0.01)
    owner.clock.at(0.02, lambda: owner.nodes.discard(ANSWERING.node))
    owner.run()
    assert ("gone", ANSWERING) in owner.events
    assert owner.simulator.velocity().v > 0.0


def test_reset_while_time_is_held_waits_for_nobody_at_this_tick():
    owner = lockstep(0.35, NODE, ANSWERING)
    answers(owner, ANSWERING, 0, 0.0, None)

    def answer(stamp):
        if stamp == TICK:
            owner.post(0.01, owner.simulator.reset)
        answers(owner, ANSWERING, stamp, 0.1, None)

    owner.on_tick = answer
    owner.run()
    assert owner.running.controllers.lockstep.misses == 0
    assert waited(owner) == pytest.approx(0.01 + 2 * 0.1)
