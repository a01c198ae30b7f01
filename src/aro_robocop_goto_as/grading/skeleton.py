"""robocop new: create a package with the handout's TODOs, and for GitHub Classroom what grades each push."""

import argparse
import os
import re
import shlex
import shutil
import sys
from pathlib import Path
from typing import Optional

from ..errors import GradingSetupError, RobocopError

SUFFIX = ".in"  # hides the files from rosrun and roslaunch, which search this whole package
IMAGE = "@IMAGE@"  # in the files of the folders .NAME, which are for GitHub: stands for the container image
IMAGE_NAME = r"[a-z0-9][A-Za-z0-9._/:@-]*"


def make(share: Path, folder: Path, image: Optional[str] = None) -> None:
    """Copy the skeleton to `folder`, which must not exist yet, with GitHub's files if a container image is given.

    `share` is the folder of this package.
    """
    if folder.exists():
        raise GradingSetupError(f"{folder} exists already; choose a new name")
    if image is not None and not re.fullmatch(IMAGE_NAME, image):
        raise GradingSetupError(f"{image!r} is not the name of a container image: expected NAME or SERVER/NAME:TAG")
    source = share / "skeleton"
    for path in sorted(source.rglob(f"*{SUFFIX}")):
        relative = path.relative_to(source).with_suffix("")
        target = folder / relative
        if relative.parts[0].startswith(".") and image is None:
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        if image is None:
            shutil.copyfile(path, target)
        else:
            target.write_text(path.read_text(encoding="utf-8").replace(IMAGE, image), encoding="utf-8")
        if target.suffix == ".py":
            target.chmod(0o755)


def main() -> None:
    """Exit status 1 if the folder exists already."""
    parser = argparse.ArgumentParser(prog="robocop new", description=__doc__, allow_abbrev=False)
    parser.add_argument(
        "name", help="folder to create; the package itself is called aro_robocop_goto_as, as in the lab"
    )
    parser.add_argument(
        "--classroom", metavar="IMAGE", help="add a workflow for GitHub Classroom, with the container image to grade in"
    )
    args = parser.parse_args()
    folder = Path(args.name)
    try:
        make(Path(os.environ["ROBOCOP_SHARE"]), folder, args.classroom)
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
