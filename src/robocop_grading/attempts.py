"""If a scenario has been repeated with a new node: which of the two attempts counts."""

from dataclasses import replace
from typing import Dict, List, Mapping, Tuple

from .checks import CHECKS, Failed, NotReached, Verdict
from .faults import Faults
from .plan import AGAIN, Plan
from .record import Record

LEFT_BEHIND = (
    "with a node that had served other scenarios, and passed with a new node, which counts (an earlier mistake may "
    "have left something behind)"
)
WENT_WRONG = (
    "although no mistake had come before, and passed when repeated with a new node (what goes wrong in a node that has "
    "served a goal, or has run for some time?)"
)


def counting(plan: Plan, records: Mapping[str, Record]) -> Tuple[Dict[str, Record], List[str], List[str]]:
    """The record that counts for each scenario, the names of scenarios whose repetition counts, and notes.

    A repetition counts if a check fails in it as well. It also counts if an earlier mistake may have left something
    behind in the first node: a check fails in a scenario before this one, or in any scenario with several goals.
    Otherwise the first attempt counts, because the first node went wrong by itself.
    """
    chosen = {name: record for name, record in records.items() if not name.endswith(AGAIN)}
    repeated = [name for name in chosen if name + AGAIN in records]
    best = {name: records.get(name + AGAIN, record) for name, record in chosen.items()}
    order, counted = plan.scenarios_of("server"), []
    about: Dict[str, List[str]] = {}  # names of scenarios, by what a note says of them
    failing = [it for it in best if _fails(plan, best[it])] if repeated else []
    for name in repeated:
        mistakes = [it for it in failing if it != name]
        is_left_behind = any(order.index(it) < order.index(name) or len(best[it].goals) > 1 for it in mistakes)
        if is_left_behind or name in failing:
            chosen[name] = replace(best[name], name=name)
            counted.append(name)
        if name not in failing:
            about.setdefault(LEFT_BEHIND if is_left_behind else WENT_WRONG, []).append(name)
    return chosen, counted, [f"failed {words}: {', '.join(names)}" for words, names in about.items()]


def _fails(plan: Plan, record: Record) -> bool:
    """Return whether a check of the plan fails in this record; the judge reports an exception in a check."""
    scenario = record.name[: -len(AGAIN)] if record.name.endswith(AGAIN) else record.name
    names = [it.name for it in plan.checks if scenario in it.scenarios]
    unjudged: Verdict = NotReached("")
    verdicts = (Faults().tried(name, unjudged, CHECKS[name], record, plan.limits) for name in names)
    return any(isinstance(verdict, Failed) for verdict in verdicts)
