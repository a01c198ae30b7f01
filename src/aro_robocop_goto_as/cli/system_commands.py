"""The commands that start a ROS system, or use one that runs."""

import contextlib
import math
import os
import re
import sys
import time
from pathlib import Path
from typing import List, NoReturn, Sequence, Tuple

from ..launch_arguments import TRUE, LaunchArguments, with_absolute_path
from ..names import ACTION, ACTION_TYPE, PACKAGE, SIMULATOR, absolute, robocop
from ..own_path import expect_own
from ..probes import master, settings, x_display
from . import program
from .program import REPLAY, RUN, SIM, refuse, say

# What rosbag leaves out: what is large, as a camera's images that are not compressed, and rosout for the second time.
NOT_RECORDED = "/(.*/)?(image_raw|points|rosout_agg)"
MIN_RATE = 0.01  # times as fast as recorded
BAG_VERSION = b"#ROSBAG V2.0\n"
BAG_HEAD = 4096  # bytes, which hold the version and the header


def launch(given: LaunchArguments, *words: str) -> NoReturn:
    """Become roslaunch, but with exit status 1 if the simulator fails."""
    if given.is_true("gui") and not x_display.answers():
        refuse("gui:=true: it is a window, and there is no usable display")
    quiet = [] if given.verbose else ["--quiet"]
    program.start_launcher(*quiet, PACKAGE, given.file.name, *words, *given.words)


def require_settings(starts_simulator: bool = False) -> None:
    """End with an error if no ROS system can run with the settings of the environment."""
    problem = settings.problem(starts_simulator)
    if problem:
        refuse(problem)


def refuse_second_simulator() -> None:
    """End with an error if a simulator can't run: nodes of the same name on one master shut each other down.

    It also ends with an error if something other than a ROS master has the master's port.
    """
    require_settings(starts_simulator=True)
    uri = master.master_uri()
    simulator = None if program.is_dry_run() else master.running_simulator(uri)
    if simulator:
        how = f"with Ctrl-C in its terminal or with {robocop()} shell rosnode kill {absolute('', SIMULATOR)}"
        refuse(f"{simulator} on {uri}; stop it {how}, or use another ROS_MASTER_URI")


def run(arguments: List[str]) -> None:
    """Simulator, server, bridge and RViz, or the web page where there is no display."""
    if "--with" in arguments:
        refuse(f"run: --with is an option of sim: {robocop()} sim --with PATH")
    given = LaunchArguments.parse(RUN, arguments)
    if given.value("sim") in ("false", "False", "0"):  # it may be another's, or a real robot
        require_settings()
    else:
        refuse_second_simulator()
    if not program.set_up():  # also what finds out whether the display answers
        sys.exit(1)
    parts = [part for part in ("gui", "web", "rviz") if given.is_true(part)]
    words = []
    if not given.value("rviz"):
        shown = x_display.answers()
        words.append(f"rviz:={str(shown).lower()}")
        if shown:
            parts.append("rviz")
        elif given.value("web"):
            say("no usable display; RViz is not started")
        elif program.set_up("web"):
            say("no usable display: the web page takes the place of RViz (web:=false: neither)")
            words.append("web:=true")
        else:
            say("no usable display; RViz is not started, and the web page could not be installed")
    program.need(*parts)  # at the end: from now on, no set-up takes the workspace away
    launch(given, *words)


def sim(arguments: List[str]) -> None:
    """The simulator alone, or with somebody else's package."""
    before, option, after = _split_at(arguments, "--with")
    if not option:
        words = [word for word in arguments if word != "rviz:=false"]  # sim alone starts no RViz
        given = LaunchArguments.parse(SIM, words, "--with")
        refuse_second_simulator()
        program.need(*["gui"] * given.is_true("gui"))
        launch(given)
    if not after:
        refuse("--with: expected the folder of a catkin package")
    refuse_second_simulator()
    shown = "rviz:=false" not in arguments and x_display.answers()
    os.environ["ROBOCOP_RVIZ"] = str(shown).lower()
    web, others = web_arguments([with_absolute_path(word) for word in [*before, *after[1:]]])
    program.need("hosting", *["rviz"] * shown, *["web"] * bool(web))
    os.environ["ROBOCOP_WEB"] = " ".join(web)
    program.start_script("robocop_sim_with.py", os.path.realpath(after[0]), *others)


def _split_at(words: List[str], option: str) -> Tuple[List[str], bool, List[str]]:
    """The words before an option, whether it is there, and the words after it."""
    at = words.index(option) if option in words else len(words)
    return words[:at], option in words, words[at + 1 :]


def web_arguments(words: Sequence[str]) -> Tuple[List[str], List[str]]:
    """The arguments by which aro_sim starts the web page, none unless web:=true is given; and the other words."""
    own = [word for word in words if word.partition(":=")[0] in ("web", "web_host", "web_port")]
    others = [word for word in words if word not in own]
    shown = any(word in [f"web:={true}" for true in TRUE] for word in own)
    return (["robocop_web.py", *(word for word in own if not word.startswith("web:="))] if shown else []), others


def goto(arguments: List[str]) -> None:
    """Send one goal, to the running system or to one that is started for it."""
    if not {"-h", "--help"} & set(arguments):
        require_settings()
    program.need()
    program.start_script("robocop_goto.py", *arguments)


def axclient(arguments: List[str]) -> None:
    """actionlib's graphical client of the running system's server."""
    if arguments and (len(arguments) != 2 or arguments[0] != "--robot"):
        refuse(f"axclient: expected --robot NAME or nothing, got {' '.join(arguments)}")
    if not program.is_dry_run() and not x_display.answers():
        refuse(f"axclient: it needs a display, and there is none; {robocop()} goto X Y sends a goal without one")
    program.need("axclient")
    say("change the numbers under Goal and press SEND GOAL; close the window to end it")
    program.start("rosrun", "actionlib_tools", "axclient.py", absolute("".join(arguments[1:]), ACTION), ACTION_TYPE)


def record(arguments: List[str]) -> None:
    """Record the running system to a bag."""
    if len(arguments) > 1:
        refuse(f"record: expected one file, got {' '.join(arguments)}")
    bag = arguments[0] if arguments else time.strftime("robocop_%Y-%m-%d_%H-%M-%S.bag")
    bag += "" if bag.endswith(".bag") else ".bag"
    for path in (bag, f"{bag}.active"):  # the second is what rosbag leaves if it is killed
        expect_own(Path(path))
    folder = os.path.dirname(os.path.abspath(bag))
    if not (os.path.isdir(folder) and os.access(folder, os.W_OK)):
        refuse(f"record: {folder} is not a folder in which a file can be created")
    require_settings()
    program.need()
    if not program.is_dry_run():
        if not master.master_answers(master.master_uri()):
            refuse(f"record: no ROS system is running; start {robocop()} run in another terminal first")
        say(f"recording to {bag} until Ctrl-C; {robocop()} replay {bag} plays it")
    # Not `rosbag record`, which would be its parent, and if killed leave it running.
    program.start("rosrun", "rosbag", "record", "--quiet", f"--output-name={bag}", "--all", f"--exclude={NOT_RECORDED}")


def _require_number(text: str, lowest: float, expected: str) -> None:
    """End with an error for a word that rosbag would not take as a number."""
    with contextlib.suppress(ValueError):
        if lowest <= float(text) < math.inf:
            return
    refuse(f"replay: {expected}, got {text or 'nothing'}")


def _index_of(path: str) -> int:
    """Where a bag's index begins; ends with an error for a file that rosbag can't play.

    The format is that of wiki.ros.org/Bags/Format/2.0.
    """
    with open(path, "rb") as file:
        head = file.read(BAG_HEAD)
    index = head.partition(b"index_pos=")[2][:8]  # 0 while it is being recorded
    if not head.startswith(BAG_VERSION) or not index:
        refuse(f"replay: {path} is no bag of ROS 1; expected a bag of {robocop()} record or of a report")
    position = int.from_bytes(index, "little")
    if not 0 < position <= os.path.getsize(path):
        refuse(f"replay: {path} is not complete; this repairs what is there: {robocop()} shell rosbag reindex {path}")
    return position


def _duration(path: str, index_position: int) -> float:
    """How long a bag plays [s]: from the first to the last of its chunks, whose times are in its index."""
    with open(path, "rb") as file:
        file.seek(index_position)
        index = file.read()
    # A field of a record's header: its length, its name, seconds and nanoseconds.
    times = re.findall(rb"(?s)(?:\x13\0\0\0start|\x11\0\0\0end)_time=(.{4})(.{4})", index)
    seconds = [int.from_bytes(s, "little") + 1e-9 * int.from_bytes(ns, "little") for s, ns in times] or [0.0]
    return max(seconds) - min(seconds)


def replay(arguments: List[str]) -> None:
    """Play a bag in the web page, and in RViz if a display is available."""
    bag = arguments[0] if arguments else ""
    if not bag:
        refuse(f"replay: expected a bag of {robocop()} record or of a report")
    if not program.is_dry_run() and not os.path.isfile(bag):
        refuse(f"replay: there is no file {bag}")
    duration = math.inf if program.is_dry_run() else _duration(bag, _index_of(bag))
    rest, option, after = _split_at(arguments[1:], "--start")
    if option:
        rest += [f"start:={''.join(after[:1])}", *after[1:]]
    given = LaunchArguments.parse(REPLAY, rest, "--start")
    if option or given.value("start"):
        _require_number(given.value("start"), 0.0, "--start: expected seconds after the recording's beginning")
        if float(given.value("start")) > duration:
            refuse(f"replay: --start {given.value('start')}: {bag} ends {duration:.1f} s after its beginning")
    if given.value("rate"):
        _require_number(given.value("rate"), MIN_RATE, f"rate: expected a number from {MIN_RATE:g} on")
    shown = x_display.answers()
    program.need("web", *["rviz"] * shown)
    refuse_second_simulator()
    launch(given, f"bag:={os.path.realpath(bag)}", f"rviz:={str(shown).lower()}")
