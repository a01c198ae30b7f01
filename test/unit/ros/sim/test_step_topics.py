"""StepTopics: at full speed, messages on the way to a control tick are kept until that is sent, or they matter."""

from types import SimpleNamespace
from typing import Any, List, Tuple

import numpy as np
import pytest

from aro_robocop_goto_as.ros.sim import step_topics
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics
from aro_robocop_goto_as.simulation.observations import Due
from aro_robocop_goto_as.simulation.rates import CLOCK, CONTROL, JOINTS, ODOM, SCAN, Rates, rates_of

ALWAYS = frozenset({CLOCK, ODOM, SCAN})  # due on each control tick
Calls = List[Tuple[Any, ...]]


@pytest.fixture(name="clock")
def _clock(monkeypatch: pytest.MonkeyPatch) -> List[float]:
    """The wall clock [s], which tests set."""
    times = [100.0]
    monkeypatch.setattr(step_topics.time, "monotonic", lambda: times[0])
    return times


@pytest.fixture(name="calls")
def _calls(monkeypatch: pytest.MonkeyPatch, clock: List[float]) -> Calls:
    made: Calls = []
    monkeypatch.setattr(step_topics, "push", lambda: made.append(("push",)))
    return made


def publish(topics: StepTopics, calls: Calls, sensor: str, control: bool = False, runs_on: bool = True) -> None:
    """A step with one sensor and the clock."""
    observed: Any = SimpleNamespace(due=Due(True, control, {sensor: [0]}), scans=np.zeros((1, 3)), stamp_ns=0)
    batch: Any = SimpleNamespace(send=lambda _stamp, more: calls.append((sensor, more)))
    topics._batches = {(observed.due, 3): ([], batch)}
    topics.publish(observed, runs_on)


def topics_of_no_robots() -> StepTopics:
    """Without publishers, which need a ROS master."""
    topics = object.__new__(StepTopics)
    topics._due_at_ticks, topics._kept_since = ALWAYS, 0.0
    return topics


def test_messages_on_the_way_are_kept_and_those_of_the_tick_are_not(calls: Calls) -> None:
    topics = topics_of_no_robots()
    publish(topics, calls, ODOM)
    publish(topics, calls, ODOM, control=True)
    topics.push()
    assert calls == [(ODOM, True), (ODOM, False)]


def test_what_is_kept_is_sent_before_a_step_with_a_sensor_that_is_not_due_on_each_tick(calls: Calls) -> None:
    topics = topics_of_no_robots()
    publish(topics, calls, ODOM)
    publish(topics, calls, JOINTS)
    assert calls == [(ODOM, True), ("push",), (JOINTS, False)]


def test_each_sensor_has_its_place_among_the_messages_of_a_step() -> None:
    assert sorted(step_topics.ORDER) == sorted(set(rates_of(Rates(), 10)) - {CLOCK, CONTROL})


def test_a_clock_that_is_not_due_on_each_tick_is_not_kept(calls: Calls) -> None:
    topics = topics_of_no_robots()
    topics._due_at_ticks = ALWAYS - {CLOCK}
    publish(topics, calls, ODOM)
    assert calls == [(ODOM, False)]


def test_what_is_kept_is_pushed_once(calls: Calls) -> None:
    topics = topics_of_no_robots()
    publish(topics, calls, SCAN)
    topics.push()
    topics.push()
    assert calls == [(SCAN, True), ("push",)]


def test_no_message_is_kept_for_more_than_a_millisecond(calls: Calls, clock: List[float]) -> None:
    topics = topics_of_no_robots()
    for step_time in (0.0, 0.0006, 0.0006, 0.0006):
        clock[0] += step_time
        publish(topics, calls, ODOM)
    assert calls == [(ODOM, True), (ODOM, True), ("push",), (ODOM, False), (ODOM, True)]
