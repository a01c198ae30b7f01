"""StepTopics: the order of the messages of a step."""

from aro_robocop_goto_as.ros.sim import step_topics
from aro_robocop_goto_as.simulation.rates import CLOCK, CONTROL, Rates, rates_of


def test_each_sensor_has_its_place_among_the_messages_of_a_step() -> None:
    assert sorted(step_topics.ORDER) == sorted(set(rates_of(Rates(), 10)) - {CLOCK, CONTROL})
