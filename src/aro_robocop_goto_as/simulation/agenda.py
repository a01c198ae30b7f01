"""Which ticks and sensors are due on a step, and the calls that measure; steps on which the same is due share them."""

from dataclasses import dataclass, field
from typing import Dict, Mapping, Tuple

from ..sensors.catalog import Sensors
from ..sensors.sensor import MeasurementCalls, RobotIndices, SensorContext
from .params import Rates
from .schedule import CLOCK, CONTROL, due_next

Subscriptions = Mapping[str, RobotIndices]  # topic of a sensor -> the robots for which somebody subscribes to it


@dataclass(eq=False)
class StepEvents:
    """What is due on a step; the same object on all steps that are alike, while the subscriptions stay the same."""

    clock: bool = False  # a clock tick: /clock is due
    control: bool = False  # a control tick: the controllers' period is over
    sensors: Subscriptions = field(default_factory=dict)  # topic of each sensor that is due -> its subscribed robots
    prepared: MeasurementCalls = MeasurementCalls([])  # the calls that measure what is due

    def of(self, topic: str) -> RobotIndices:
        """The robots for which a sensor is due and subscribed to."""
        return self.sensors.get(topic, ())


class Agenda:
    """The ticks, and the sensors that somebody subscribes to."""

    def __init__(self, sensors: Sensors, context: SensorContext, rates: Rates) -> None:
        self._sensors, self._context, self._rates = sensors.by_topic, context, rates
        self._schedule_for({})

    def after(self, step: int, subscriptions: Subscriptions) -> Tuple[int, StepEvents]:
        """How many steps after this one something is due, and what it is."""
        if subscriptions is not self._subscriptions and subscriptions != self._subscriptions:
            self._schedule_for(subscriptions)
        return self._after[step % self._rates.physics_rate]

    def _schedule_for(self, subscriptions: Subscriptions) -> None:
        self._subscriptions = subscriptions
        rates = {CLOCK: self._rates.clock_rate, CONTROL: self._rates.control_rate}
        for topic, sensor in self._sensors.items():
            if sensor.always_on or subscriptions.get(topic):
                rates[topic] = sensor.rate
        after = due_next(rates, self._rates.physics_rate)
        self._events: Dict[Tuple[str, ...], StepEvents] = {}
        for names in {names for _, names in after}:
            sensors = {name: subscriptions[name] for name in names if subscriptions.get(name)}
            self._events[names] = StepEvents(CLOCK in names, CONTROL in names, sensors)
        self._after = [(steps, self._events[names]) for steps, names in after]  # by the step's number within its second
        self.prepare()

    def prepare(self) -> None:
        """Find the calls that measure what is due, anew after a change of the world."""
        for names, due in self._events.items():
            parts = [self._sensors[name].measurement_calls(due.of(name)) for name in names if name in self._sensors]
            measure = [call for part in parts for call in part.measure]
            before = [call for part in parts for call in part.before]
            due.prepared = MeasurementCalls([self._context.engine.update_fleet, *measure] if parts else [], before)
