"""The contracts of the handout, one check function each: a scenario's record -> passed, failed or not reached."""

import importlib
import pkgutil

from .verdict import CHECKS, PASSED, Failed, NotReached, Passed, Verdict

for _module in pkgutil.iter_modules(__path__):  # each registers its checks
    importlib.import_module(f"{__name__}.{_module.name}")

__all__ = ["CHECKS", "PASSED", "Failed", "NotReached", "Passed", "Verdict"]
