"""robocop new: create a package with the handout's TODOs."""

import argparse
import os
import shlex
import shutil
import sys
from pathlib import Path

from ..errors import GradingSetupError, RobocopError

SUFFIX = ".in"  # hides the files from rosrun and roslaunch, which search this whole package


def make(share: Path, folder: Path) -> None:
    """Copy the skeleton to `folder`, which must not exist yet; `share` is the folder of this package."""
    if folder.exists():
        raise GradingSetupError(f"{folder} exists already; choose a new name")
    source = share / "skeleton"
    for path in sorted(source.rglob(f"*{SUFFIX}")):
        target = folder / path.relative_to(source).with_suffix("")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        if target.suffix == ".py":
            target.chmod(0o755)


def main() -> None:
    """Exit status 1 if the folder exists already."""
    parser = argparse.ArgumentParser(prog="robocop new", description=__doc__)
    parser.add_argument(
        "name", help="folder to create; the package itself is called aro_robocop_goto_as, as in the lab"
    )
    folder = Path(parser.parse_args().name)
    try:
        make(Path(os.environ["ROBOCOP_SHARE"]), folder)
    except RobocopError as error:
        sys.exit(f"robocop new: {error}")
    except OSError as error:
        sys.exit(f"robocop new: {folder} can't be created: {error.strerror}")
    path = shlex.quote(str(folder))
    print(
        f"Created {folder}. Complete the TODOs in its scripts/ folder.\n"
        f"Run it:   ./robocop sim --with {path}\n"
        f"Grade it: ./robocop grade {path}"
    )
