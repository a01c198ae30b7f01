"""StepTopics: the order of the messages of a step."""

from aro_robocop_goto_as.ros.sim import step_topics
from aro_robocop_goto_as.sim_params import SimParams
from aro_robocop_goto_as.simulation.rates import CLOCK, CONTROL


def test_each_sensor_has_its_place_among_the_messages_of_a_step() -> None:
    assert sorted(step_topics.ORDER) == sorted(set(SimParams().due_rates()) - {CLOCK, CONTROL})
