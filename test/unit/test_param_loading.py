"""Plain values become a parameter dataclass, or are refused with source, key, value and expectation."""

import math
from dataclasses import dataclass
from typing import Optional, Tuple

import pytest

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.param_loading import declared, from_dict, group, parameter, positive, several


@dataclass(frozen=True)
class Speeds:
    slow: float = positive(0.1, high=1.0)
    fast: Optional[float] = positive(None, otherwise="the model's value")


@dataclass(frozen=True)
class Params:
    speeds: Speeds = group(Speeds)
    count: int = parameter(1, low=1, high=5)
    mode: str = parameter("free", choices=("free", "strict"))
    shown: bool = False

    def conflicts(self):
        return ["count: expected 2 in mode strict"] if self.mode == "strict" and self.count != 2 else []


@dataclass(frozen=True)
class Required:
    name: str = parameter()


def test_groups_take_their_own_keys_without_a_prefix():
    assert list(declared(Params)) == ["slow", "fast", "count", "mode", "shown"]
    assert from_dict(Params, {}, "x") == Params()
    assert from_dict(Params, {"fast": 2.5, "count": 3}, "x") == Params(Speeds(0.1, 2.5), 3)
    with pytest.raises(ParameterError, match="speeds: unknown parameter"):
        from_dict(Params, {"speeds": {"slow": 0.1}}, "x")


def test_integer_is_accepted_for_a_float():
    slow = from_dict(Params, {"slow": 1}, "x").speeds.slow
    assert slow == 1.0 and isinstance(slow, float)


@pytest.mark.parametrize(
    "raw, expected",
    [
        ({"cuont": 2}, "cuont: unknown parameter; did you mean 'count'?"),
        ({"zzz": 1}, "zzz: unknown parameter; known are: count, fast, mode, shown, slow"),
        ({"count": "2"}, "count: expected an integer, got '2'"),
        ({"count": 2.0}, "count: expected an integer, got 2.0"),
        ({"count": True}, "count: expected an integer, got True"),
        ({"shown": 1}, "shown: expected true or false, got 1"),
        ({"count": 0}, "count: expected at least 1, got 0"),
        ({"count": 10**22}, "count: expected at most 5, got 10000000000000000000000"),
        ({"slow": 0}, "slow: expected at least 1e-09, got 0.0"),
        ({"slow": math.nan}, "slow: expected a finite number, got nan"),
        ({"slow": 10**400}, "slow: expected a finite number, got inf"),
        ({"fast": None}, "fast: expected a number, got None; omit it to use the model's value"),
        ({"fast": -1}, "fast: expected at least 1e-09, got -1.0; omit it to use the model's value"),
        ({"mode": "gps"}, "mode: expected one of free, strict, got 'gps'"),
        ({"mode": "strict"}, "count: expected 2 in mode strict"),
        (
            {"count": 0, "slow": 2, "mode": "strict"},
            "count: expected at least 1, got 0; slow: expected at most 1, got 2.0",
        ),
    ],
)
def test_wrong_values_are_refused_all_at_once(raw, expected):
    with pytest.raises(ParameterError) as refusal:
        from_dict(Params, raw, "sim.yaml")
    assert str(refusal.value) == f"sim.yaml: {expected}"


@dataclass(frozen=True)
class Lists:
    place: Tuple[float, ...] = several(2, -1.0, 1.0)
    names: Tuple[str, ...] = several()
    wait: float = parameter(0.0, key="for")


def test_lists_become_tuples_and_a_key_may_be_a_word_of_python():
    assert from_dict(Lists, {"place": [1, 0.5], "names": ["a"], "for": 2}, "x") == Lists((1.0, 0.5), ("a",), 2.0)
    assert from_dict(Lists, {}, "x") == Lists() and list(declared(Lists)) == ["place", "names", "for"]


@pytest.mark.parametrize(
    "raw, expected",
    [
        ({"place": [1.0]}, "place: expected a list of 2 numbers, got [1.0]"),
        ({"place": [1.0, 3]}, "place: expected at most 1, got 3.0"),
        ({"place": ["a", 0.0]}, "place: expected a number, got 'a'"),
        ({"names": []}, "names: expected a list of names, got []"),
        ({"names": "a"}, "names: expected a list of names, got 'a'"),
        ({"wait": 1.0}, "wait: unknown parameter; known are: for, names, place"),
    ],
)
def test_wrong_lists_are_refused(raw, expected):
    with pytest.raises(ParameterError) as refusal:
        from_dict(Lists, raw, "plan.yaml")
    assert str(refusal.value) == f"plan.yaml: {expected}"


def test_key_without_a_default_is_required():
    with pytest.raises(ParameterError, match="^x: name: missing, expected a text$"):
        from_dict(Required, {}, "x")
