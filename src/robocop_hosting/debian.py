"""The name of a ROS or CMake package that is missing on this machine -> the Debian packages to install."""

import re
import subprocess
from typing import Sequence


def remedy(name: str, pattern: str) -> str:
    """What to do about the missing package `name`, by the Debian packages that are not installed and match.

    pattern: of their names, with {} in place of `name` as Debian writes it. Apt has to know its package lists.
    """
    debian = re.escape(name.lower().replace("_", "-"))
    described = dict(
        line.partition(" - ")[::2]
        for line in _lines("apt-cache", "search", "--names-only", f"^{pattern.format(debian)}$")
    )
    # Other things have the same name: `tf` is a game.
    found = [it for it, text in described.items() if re.search(r"\bROS\b|Robot OS", text) or it.endswith("-dev")]
    installed = _lines("dpkg-query", "-W", "-f", "${db:Status-Status} ${Package}\n", *found) if found else []
    missing = [it for it in found if f"installed {it}" not in installed]
    if missing:
        return f"install the Debian package: apt-get install {' '.join(missing)}"
    if found:
        return f"the Debian package {' and '.join(found)} is installed: is the name right?"
    return f"apt knows no package of {name}: build it from source, in a folder beside your package"


def _lines(*command: str) -> Sequence[str]:
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    except OSError:  # not Debian
        return []
    return done.stdout.splitlines()
