"""The folder of this package's files: worlds, models, launch files."""

from pathlib import Path

import rospkg

from ..names import PACKAGE

CHECKOUT = Path(__file__).parents[3]


def share() -> str:
    """The folder; a search among all packages only where this one is installed apart from its files."""
    return str(CHECKOUT) if (CHECKOUT / "package.xml").is_file() else str(rospkg.RosPack().get_path(PACKAGE))
