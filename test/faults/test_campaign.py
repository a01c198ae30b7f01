"""The fault campaign: goals, data, time, processes and neighbours go wrong, and every goal still ends exactly once.

./robocop test test/faults --all --faults 10000     so many goals in each configuration, with the costly faults
./robocop test test/faults --all --faults 10000 -k "lockstep-wheels-one or free-kinematic-one or pillars or maze"
./robocop test test/faults --all --faults 1000 --select "(?!goals_in_a_burst)"     without one of the faults
./robocop test test/faults --all --faults 1000 --busy 16     beside so many endless loops
./robocop test test/faults --all --soak 21600 -k hours     six hours of goals; the use of memory stays level
./robocop test test/faults --episode CONFIGURATION/SEED/NUMBER     one episode again, as a violation names it

The tables are kept in .robocop/log/campaign-CONFIGURATION.log.

Each campaign is a process, because it needs a ROS master of its own, which it may kill. Two run at a time.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from waiting import patience

CAMPAIGN = Path(__file__).with_name("campaign.py")
QUICK = ("messages", "lockstep-kinematic-one")
OTHERS = tuple(
    f"{mode}-{drive}-{place}"
    for mode in ("lockstep", "free")
    for drive in ("kinematic", "wheels")
    for place in ("one", "two", "pillars", "maze")
    if f"{mode}-{drive}-{place}" not in QUICK
)
SECONDS_PER_GOAL = 3.0  # [s, wall] a deadline for the slowest configuration on a busy machine
COSTLY = 900.0  # [s, wall] for the costly faults, each of which has one turn


def run(request, tmp_path, capsys, configuration, goals, *options):
    """One campaign: its table is printed, its violations fail the test; the report."""
    command = [sys.executable, CAMPAIGN, "--configuration", configuration, "--goals", goals, "--folder", tmp_path]
    done = subprocess.run(
        [str(word) for word in (*command, "--select", request.config.getoption("--select"), *options)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=(COSTLY + SECONDS_PER_GOAL * goals) * patience(),
    )
    with capsys.disabled():
        print(f"\n{configuration}\n{done.stdout}")
    # Of tests in several processes, pytest shows nothing but failures.
    Path(os.environ["ROBOCOP_STATE"], "log", f"campaign-{configuration}.log").write_text(done.stdout)
    assert done.returncode == 0, done.stdout
    return json.loads((tmp_path / "report.json").read_text())


def goals_each(request, default):
    """How many goals each configuration gets."""
    goals = request.config.getoption("--faults")
    return default if goals is None else goals


@pytest.fixture
def only_episode(request):
    return request.config.getoption("--episode")


@pytest.mark.timeout(0)  # run() has one, which depends on the number of goals
@pytest.mark.parametrize("configuration", [pytest.param(QUICK[0], marks=pytest.mark.slow), *QUICK[1:]])
def test_every_goal_ends_once_and_the_robot_stops_whatever_goes_wrong(
    request, tmp_path, capsys, only_episode, configuration
):
    full = ["--full"] if request.config.getoption("--all") else []
    if only_episode:
        name, seed, number = only_episode.split("/")
        if name == configuration or (configuration == QUICK[0] and name in OTHERS):
            run(request, tmp_path, capsys, name, 1, "--seed", seed, "--episode", number, "--full")
        return
    goals = goals_each(request, 150)
    report = run(request, tmp_path, capsys, configuration, goals, *full)
    assert report["goals"] >= goals


@pytest.mark.faults
@pytest.mark.timeout(0)
@pytest.mark.parametrize("configuration", OTHERS)
def test_every_goal_ends_once_with_other_drives_robots_and_in_free_time(
    request, tmp_path, capsys, only_episode, configuration
):
    if not only_episode:
        run(request, tmp_path, capsys, configuration, goals_each(request, 60), "--full")


@pytest.mark.slow
@pytest.mark.timeout(0)
def test_hours_of_goals_need_no_more_memory_threads_or_files(request, tmp_path, capsys):
    seconds = request.config.getoption("--soak")
    run(request, tmp_path, capsys, "lockstep-kinematic-one", int(seconds), "--soak", seconds)


@pytest.mark.slow
@pytest.mark.parametrize(
    "mistake, found",
    [
        ("second_result", "has 2 results"),
        ("no_stop", "when it should rest"),
        ("wrong_word", "success"),
        ("traceback", "a traceback in aro_robocop_goto_as_node.log"),
        ("leak", "file descriptors grew"),
    ],
)
def test_campaign_finds_a_server_with_a_mistake(tmp_path, mistake, found):
    command = [sys.executable, CAMPAIGN, "--goals", 40, "--folder", tmp_path, "--mistake", mistake]
    done = subprocess.run(
        [str(word) for word in command], stdout=subprocess.PIPE, text=True, timeout=240.0 * patience()
    )
    assert done.returncode == 1
    (violation,) = json.loads((tmp_path / "report.json").read_text())["violations"]
    assert found in violation
