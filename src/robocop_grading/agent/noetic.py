"""Names that later releases than the lab's Ubuntu 20.04 have dropped: a hand-in that uses them is right there."""

import builtins
import collections
import threading
from typing import Any

NUMPY = {"long": "int", "unicode": "str", **{name: name for name in "bool complex float int object str".split()}}
NUMPY_1 = {  # names that NumPy 2 knows by others
    **dict.fromkeys("Inf Infinity infty PINF".split(), "inf"),
    **{"NaN": "nan", "float_": "float64", "complex_": "complex128", "string_": "bytes_", "unicode_": "str_"},
    **{"alltrue": "all", "sometrue": "any", "product": "prod", "cumproduct": "cumprod"},
    **{"mat": "asmatrix", "round_": "round"},
}


def install() -> None:
    """Add names of Python 3.8, NumPy 1.17 and PyYAML 5.3."""
    import numpy
    import yaml

    for name, builtin in NUMPY.items():  # until NumPy 1.24
        _add(numpy, name, getattr(builtins, builtin))
    for name, other in NUMPY_1.items():
        _add(numpy, name, getattr(numpy, other))
    for name in collections.abc.__all__:  # until Python 3.10
        _add(collections, name, getattr(collections.abc, name))
    _add(threading.Thread, "isAlive", threading.Thread.is_alive)  # until Python 3.9
    if yaml.load.__defaults__ is None:  # since PyYAML 6 it needs a loader
        yaml.load.__defaults__ = (yaml.FullLoader,)


def _add(owner: Any, name: str, value: object) -> None:
    if name not in vars(owner):
        setattr(owner, name, value)
