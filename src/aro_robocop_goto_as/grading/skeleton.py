"""robocop new NAME: the handout's package with its TODOs, in a folder of that name."""

import argparse
import os
import shlex
import shutil
import sys
from pathlib import Path

from ..errors import GradingError, RobocopError

SUFFIX = ".in"  # hides the skeleton's files from rosrun and roslaunch, which search whole packages


def make(share: Path, folder: Path) -> None:
    """The skeleton in `folder`, which must not exist yet; `share` is this package's own folder."""
    if folder.exists():
        raise GradingError(f"{folder} is there already; expected a new name")
    source = share / "skeleton"
    for path in sorted(source.rglob(f"*{SUFFIX}")):
        target = folder / path.relative_to(source).with_suffix("")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        if target.suffix == ".py":
            target.chmod(0o755)


def main() -> None:
    """Exit status 1 when the folder is there already."""
    parser = argparse.ArgumentParser(prog="robocop new", description=__doc__)
    parser.add_argument("name", help="folder to make; the package in it has the lab's name, aro_robocop_goto_as")
    folder = Path(parser.parse_args().name)
    try:
        make(Path(os.environ["ROBOCOP_SHARE"]), folder)
    except (RobocopError, OSError) as error:
        print(f"robocop new: {error}", file=sys.stderr)
        sys.exit(1)
    path = shlex.quote(str(folder))
    print(f"{folder}: follow the TODOs in its scripts/. It runs with: ./robocop sim --with {path}\n"
          f"and is graded with: ./robocop grade {path}")
