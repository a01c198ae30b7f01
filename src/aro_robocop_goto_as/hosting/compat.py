"""compat/ -> a workspace with the lab's aro_sim and Gazebo's message types, for other people's packages to build on."""

import zlib
from pathlib import Path

from .workspace import Environment, alone, base_environment, build, sourced

PACKAGES = ("aro_sim", "gazebo_msgs")


def compat_environment(share: Path, state: Path) -> Environment:
    """The environment with that workspace in it; it is built where `state`/compat is not up to date.

    `share` is this package's folder.
    """
    folder, sources = state / "compat", {name: share / "compat" / name for name in PACKAGES}
    stamp, wanted = folder / "built-from", _sum(share / "compat")
    with alone(folder):
        if not stamp.is_file() or stamp.read_text() != wanted:
            stamp.unlink(missing_ok=True)
            environment = build(sources, folder, base_environment())
            stamp.write_text(wanted)
            return environment
    return sourced(folder / "devel" / "setup.bash", base_environment())


def _sum(folder: Path) -> str:
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return " ".join(f"{path.relative_to(folder)}:{zlib.crc32(path.read_bytes()):x}" for path in files)
