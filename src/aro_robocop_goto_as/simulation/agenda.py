"""Which ticks and sensors are due on a step, and the calls that measure; steps on which the same is due share them."""

from dataclasses import dataclass, field
from typing import Dict, List, Mapping, Tuple

from ..geometry import NANOSECONDS
from ..sensors.catalog import Sensors
from ..sensors.sensor import MeasurementCalls, RobotIndices, SensorContext
from .params import Rates

CLOCK, CONTROL = "clock", "control"  # the ticks
Subscriptions = Mapping[str, RobotIndices]  # topic of a sensor -> the robots for which somebody subscribes to it


def stamp_ns(step: int, physics_rate: int) -> int:
    """Simulated time [ns] of a step at physics_rate [Hz], rounded down."""
    return step * NANOSECONDS // physics_rate


def due(step: int, rate: int, physics_rate: int) -> bool:
    """Return whether something at `rate` [Hz] is due on this step, the first one at or after a multiple of its period.

    If the rate divides physics_rate the period is exact. Otherwise the mean rate is exact, and each time is less than
    one step late.
    """
    return (step * rate) // physics_rate != ((step - 1) * rate) // physics_rate


def due_next(rates: Mapping[str, int], physics_rate: int) -> List[Tuple[int, Tuple[str, ...]]]:
    """How many steps after each step of a second something is due, and what it is, in the order of the rates.

    `rates` [Hz] by the names of what is due; 0: never. One of them at least must divide physics_rate. Every second is
    alike, as all rates are whole numbers.
    """
    names = [
        tuple(name for name, rate in rates.items() if rate and due(step, rate, physics_rate))
        for step in range(1, physics_rate + 1)
    ]
    steps, following = 0, names[-1]
    after: List[Tuple[int, Tuple[str, ...]]] = []
    for due_now in reversed(names):
        steps, following = (1, due_now) if due_now else (steps + 1, following)
        after.append((steps, following))
    return after[::-1]


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
