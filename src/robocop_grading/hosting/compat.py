"""compat/ -> a workspace with the lab's aro_sim and Gazebo's message types, on which hosted packages are built."""

from pathlib import Path

from .workspace import Environment, base_environment, build, build_once, checksums

PACKAGES = ("aro_sim", "gazebo_msgs")


def compat_environment(share: Path, state: Path) -> Environment:
    """The environment with that workspace in it, built in `state`/compat; `share` is this package's folder."""
    folder, sources = state / "compat", {name: share / "compat" / name for name in PACKAGES}
    underlay = base_environment()
    return build_once(folder, checksums(share / "compat"), underlay, lambda: build(sources, folder, underlay))
