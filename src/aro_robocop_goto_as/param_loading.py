"""Plain values -> a frozen parameter dataclass; whatever does not fit is an error that names source, key and value."""

import contextlib
import math
from dataclasses import MISSING, Field, field, fields
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar, cast, get_args, get_type_hints

from .errors import ParameterError
from .suggestions import did_you_mean

T = TypeVar("T")


MODELS_OWN, PROFILES_OWN = "the model's value", "the profile's value"  # what a default of None stands for
MIN_POSITIVE, MAX_POSITIVE = 1e-9, 1e6  # bounds of a number that only has to be greater than 0
BOOLEANS = {"true": True, "1": True, "false": False, "0": False}  # as roslaunch reads them
TYPES = {bool: "true or false", int: "an integer", float: "a number", str: "a text", dict: "a mapping", list: "a list"}
MAX_COORDINATE = 1e6  # [m] from the origin; beyond, single-precision messages no longer resolve centimetres


def parameter(
    default: Any = MISSING,
    low: Optional[float] = None,
    high: Optional[float] = None,
    about: str = "",
    choices: Sequence[str] = (),
    otherwise: str = "",
    key: str = "",
    live: bool = False,
) -> Any:
    """A dataclass field with its inclusive bounds or its choices; without a default the key is required.

    about: its unit in brackets, if it has one, then its meaning, for the docs
    otherwise: in words, what is used if the default is None and no value is given
    key: its name in files, where Python does not allow it as the field's name
    live: whether it can be changed while its node runs
    """
    metadata = {"low": low, "high": high, "choices": tuple(choices), "otherwise": otherwise, "key": key}
    return field(default=default, metadata={**metadata, "about": about, "live": live})


def several(count: int = 0, low: Optional[float] = None, high: Optional[float] = None, default: Any = ()) -> Any:
    """A field for a tuple of `count` values, or of at least one, with their bounds; its value is given as a list."""
    return field(default=default, metadata={"low": low, "high": high, "count": count})


def positive(default: Any = MISSING, about: str = "", high: float = MAX_POSITIVE, otherwise: str = "") -> Any:
    """A field for a number greater than 0."""
    return parameter(default, MIN_POSITIVE, high, about, otherwise=otherwise)


def group(cls: Type[T]) -> T:
    """A dataclass field that holds a group of parameters, another frozen dataclass; its keys have no prefix."""
    return field(default=cls(), metadata={"group": cls})


def declared(cls: Type[Any]) -> "Dict[str, Tuple[Field[Any], Type[Any]]]":
    """The parameters of a dataclass and of its groups, by their names, with the type of a value: X of Optional[X]."""
    hints, found = get_type_hints(cls), {}
    for spec in fields(cast(Any, cls)):
        inner, hint = spec.metadata.get("group"), hints[spec.name]
        kind = next((arg for arg in get_args(hint) if arg is not type(None)), hint)
        found.update(declared(inner) if inner else {_key(spec): (spec, kind)})
    return found


def from_dict(cls: Type[T], raw: Mapping[str, Any], source: str) -> T:
    """A parameter dataclass from plain values; absent keys keep their defaults.

    Raises ParameterError naming `source` (a file or a parameter namespace) and every key that is unknown, missing, of
    the wrong type or out of bounds, with its value and what was expected.
    """
    known = declared(cls)
    problems = [
        f"{name}: missing, expected {TYPES.get(kind, kind.__name__)}"
        for name, (spec, kind) in known.items()
        if spec.default is MISSING and name not in raw
    ]
    values: Dict[str, Any] = {}
    for key, value in raw.items():
        if key not in known:
            hint = did_you_mean(key, known, "'{}'") or "; known are: {}".format(", ".join(sorted(known)))
            problems.append(f"{key}: unknown parameter{hint}")
            continue
        values[key], problem = _checked(*known[key], value)
        if problem:
            problems.append(f"{key}: {problem}")
    if not problems:
        params = _made(cls, values)
        problems = list(getattr(params, "conflicts", lambda: [])())
    if problems:
        raise ParameterError("{}: {}".format(source, "; ".join(problems)))
    return params


def from_texts(cls: Type[T], texts: Mapping[str, str], source: str) -> T:
    """As from_dict, of values as they are typed, NAME:=VALUE; an empty one is not given."""
    known = declared(cls)
    given = {name: text for name, text in texts.items() if text}
    return from_dict(cls, {n: _typed(text, known[n][1]) if n in known else text for n, text in given.items()}, source)


def _typed(text: str, kind: Type[Any]) -> Any:
    """A text as a value of a kind, as roslaunch reads it; the text itself if it is no such value."""
    with contextlib.suppress(KeyError, ValueError):
        return BOOLEANS[text.strip().lower()] if kind is bool else kind(text)
    return text


def _made(cls: Type[T], values: Mapping[str, Any]) -> T:
    """The dataclass with these values; each group takes its own values."""
    given = {}
    for spec in fields(cast(Any, cls)):
        inner = spec.metadata.get("group")
        if inner:
            given[spec.name] = _made(inner, values)
        elif _key(spec) in values:
            given[spec.name] = values[_key(spec)]
    return cls(**given)


def _key(spec: "Field[Any]") -> str:
    return spec.metadata.get("key") or spec.name


def _converted(kind: Type[Any], value: Any) -> Any:
    """A whole number as a float where one is expected."""
    if kind is not float or type(value) is not int:
        return value
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _checked(spec: "Field[Any]", kind: Type[Any], value: Any) -> Tuple[Any, Optional[str]]:
    """A value, converted for its field, and what is wrong with the value, in words, or None."""
    count = spec.metadata.get("count")
    if count is None:
        value = _converted(kind, value)
        return value, _problem(spec, kind, value)
    if not isinstance(value, list) or len(value) not in ([count] if count else range(1, len(value) + 1)):
        words = f"{count or ''} {'numbers' if kind is float else 'names'}".strip()
        return value, f"expected a list of {words}, got {value!r}"
    values = tuple(_converted(kind, it) for it in value)
    return values, next(filter(None, (_problem(spec, kind, it) for it in values)), None)


def _problem(spec: "Field[Any]", kind: Type[Any], value: Any) -> Optional[str]:
    """What is wrong with a value for a field, in words, or None."""
    expected = _expectation(spec, kind, value)
    if expected is None:
        return None
    otherwise = spec.metadata.get("otherwise")
    return f"expected {expected}" + (f"; omit it to use {otherwise}" if otherwise else "")


def _expectation(spec: "Field[Any]", kind: Type[Any], value: Any) -> Optional[str]:
    """A text with the value and what was expected instead; None when the value is as expected."""
    if type(value) is not kind:
        return f"{TYPES.get(kind, kind.__name__)}, got {value!r}"
    if kind is float and not math.isfinite(value):
        return f"a finite number, got {value!r}"
    low, high, choices = (spec.metadata.get(name) for name in ("low", "high", "choices"))
    if low is not None and value < low:
        return f"at least {low:g}, got {value!r}"
    if high is not None and value > high:
        return f"at most {high:g}, got {value!r}"
    if choices and value not in choices:
        return "one of {}, got {!r}".format(", ".join(choices), value)
    return None


def frame_problems(name: str, frame: str) -> List[str]:
    """What tf2 would refuse about a frame's name, in words; empty when it is valid."""
    if frame and not frame.startswith("/") and not any(character.isspace() for character in frame):
        return []
    return [f"{name}: expected a frame name without blanks or a leading slash, got {frame!r}"]
