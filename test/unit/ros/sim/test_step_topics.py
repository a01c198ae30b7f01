"""StepTopics: the order of the messages of a step."""

from typing import Callable

from aro_robocop_goto_as.ros.sim.sensor_topics import TOPICS
from aro_robocop_goto_as.simulation.simulator import Simulator


def test_each_sensor_has_its_place_among_the_messages_of_a_step(simulator: Callable[..., Simulator]) -> None:
    assert {*TOPICS, "camera", "tf"} == set(simulator().observed.by_name)
