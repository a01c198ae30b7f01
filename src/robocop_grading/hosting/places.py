"""Where ./robocop has put what its programs need."""

import os
from pathlib import Path
from typing import Tuple

from aro_robocop_goto_as.errors import InstallationError


def places() -> Tuple[Path, Path]:
    """The folder of everything that is built, and this package's folder; InstallationError without ./robocop."""
    try:
        return Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    except KeyError as error:
        name = error.args[0]
        raise InstallationError(f"{name} is not set; use ./robocop COMMAND instead of rosrun") from error
