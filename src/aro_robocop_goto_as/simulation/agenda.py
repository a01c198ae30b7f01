"""What is due on which step, and the calls that measure it, prepared once for all steps that are alike."""

from typing import Dict, Tuple

from ..sim_params import Rates
from .observations import Due, Observations, Subscriptions
from .schedule import CLOCK, CONTROL, due_next


class Agenda:
    """The ticks, and the sensors that somebody subscribes to."""

    def __init__(self, observed: Observations, rates: Rates) -> None:
        self._observed, self._rates = observed, rates
        self._schedule_for({})

    def after(self, step: int, subscriptions: Subscriptions) -> Tuple[int, Due]:
        """How many steps after this one something is due, and what it is."""
        if subscriptions is not self._subscriptions and subscriptions != self._subscriptions:
            self._schedule_for(subscriptions)
        return self._after[step % self._rates.physics_rate]

    def _schedule_for(self, subscriptions: Subscriptions) -> None:
        self._subscriptions = subscriptions
        rates = {CLOCK: self._rates.clock_rate, CONTROL: self._rates.control_rate}
        for name, sensor in self._observed.by_name.items():
            if sensor.unasked or subscriptions.get(name):
                rates[name] = sensor.rate
        after = due_next(rates, self._rates.physics_rate)
        self._dues: Dict[Tuple[str, ...], Due] = {}
        for names in {names for _, names in after}:
            sensors = {name: subscriptions[name] for name in names if subscriptions.get(name)}
            self._dues[names] = Due(CLOCK in names, CONTROL in names, sensors)
        self._after = [(steps, self._dues[names]) for steps, names in after]  # by the step's number within its second
        self.prepare()

    def prepare(self) -> None:
        """Find the calls that measure what is due, anew after a change of the world."""
        by_name, site = self._observed.by_name, self._observed.site
        for names, due in self._dues.items():
            sensors = [by_name[name] for name in names if name in by_name]
            sensors = [sensor for sensor in sensors if sensor.unasked or sensor.name in due.sensors]
            due.before = [call for it in sensors for call in it.before_step(due.sensors.get(it.name, ()))]
            due.measures = [call for it in sensors for call in it.measuring(due.sensors.get(it.name, ()))]
            if any(sensor.reads_fleet for sensor in sensors):
                due.measures = [site.engine.update_fleet, *due.measures]
