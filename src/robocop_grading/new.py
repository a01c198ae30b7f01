"""robocop new: create a package with the handout's TODOs, or the graders for GitHub Classroom or Gradescope."""

import argparse
import random
import shlex
import shutil
import sys
import zipfile
from pathlib import Path
from typing import Optional

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.names import robocop
from aro_robocop_goto_as.own_path import expect_own
from aro_robocop_goto_as.process.start import typed
from robocop_hosting.workspace import places

SKELETON = Path(__file__).resolve().parent / "skeleton"
SUFFIX = ".in"  # hides the files from rosrun and roslaunch, which search this whole package
IMAGE = "@IMAGE@"  # in the files of the folders .NAME, which are for GitHub: stands for the container image
SEED = "@SEED@"  # in run_autograder: what students can't see
GRADESCOPE_FOLDER = ".gradescope"  # the folder of what is for Gradescope
# What an installation of this package needs, besides README, docs and tests.
INSTALLED = "action cfg compat config install launch msg rviz scripts src srv urdf worlds".split()
INSTALLED += "CMakeLists.txt LICENSE package.xml pyproject.toml robocop setup.py test/ros".split()


def make(folder: Path, image: Optional[str] = None) -> None:
    """Copy the skeleton to `folder`, which is new or empty, with GitHub's files if a container image is given."""
    expect_own(folder)
    for path in sorted(SKELETON.rglob(f"*{SUFFIX}")):
        relative = path.relative_to(SKELETON).with_suffix("")
        target = folder / relative
        if relative.parts[0] == GRADESCOPE_FOLDER or (relative.parts[0].startswith(".") and image is None):
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        if image is None:
            shutil.copyfile(path, target)
        else:
            target.write_text(path.read_text(encoding="utf-8").replace(IMAGE, image), encoding="utf-8")
        if target.suffix == ".py":
            target.chmod(0o755)


def make_autograder(share: Path, path: Path) -> None:
    """Write Gradescope's zip: setup.sh, run_autograder with a random seed, and this package for machines without it."""
    seed = str(random.randint(1, 99_999))
    with zipfile.ZipFile(path, "x", zipfile.ZIP_DEFLATED) as archive:
        for script in sorted((SKELETON / GRADESCOPE_FOLDER).glob(f"*{SUFFIX}")):
            member = zipfile.ZipInfo.from_file(script, script.with_suffix("").name)
            archive.writestr(member, script.read_text(encoding="utf-8").replace(SEED, seed))
        for name in INSTALLED:
            for file in sorted([share / name, *(share / name).rglob("*")]):
                if file.is_file() and "__pycache__" not in file.parts:
                    archive.write(file, Path("robocop", file.relative_to(share)))


def main() -> None:
    """Exit status 1 if the folder exists already."""
    parser = argparse.ArgumentParser(prog=typed("new"), description=__doc__, allow_abbrev=False)
    parser.add_argument(
        "name", help="folder to create; the package itself is called aro_robocop_goto_as, as in the lab"
    )
    parser.add_argument(
        "--classroom", metavar="IMAGE", help="add a workflow for GitHub Classroom, with the container image to grade in"
    )
    parser.add_argument("--gradescope", action="store_true", help="write NAME.zip, an autograder for Gradescope")
    args = parser.parse_args()
    folder = Path(f"{args.name}.zip" if args.gradescope else args.name)
    try:
        if args.gradescope:
            make_autograder(places()[1], folder)
            print(f"Created {folder}. Upload it to Gradescope as the autograder; docs/grading.md says how.")
            return
        make(folder, args.classroom)
    except RobocopError as error:
        sys.exit(f"robocop new: {error}")
    except OSError as error:
        sys.exit(f"robocop new: {folder} can't be created: {error.strerror}")
    path = shlex.quote(str(folder if Path("robocop").is_file() else folder.resolve()))  # as typed beside ./robocop
    print(
        f"Created {folder}. Complete the TODOs in its scripts/ folder.\n"
        f"Run it:   {robocop()} sim --with {path}\n"
        f"Grade it: {robocop()} grade {path}"
    )
