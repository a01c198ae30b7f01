"""The commands in environments that people have: each is right, or says in a sentence what is wrong."""

import itertools

import pytest
from command import ROOT, environment, make_program, robocop
from systems import Process
from waiting import wait_for

from robocop_hosting.ports import free_port

pytestmark = pytest.mark.timeout(300)  # it runs whole commands

# What a terminal may have; an environment lacks what is None. Each with what run, goto and doctor say about it.
ENVIRONMENTS = {
    "another locale": ({"LC_ALL": "de_DE.UTF-8"}, ""),
    "no HOME": ({"HOME": None}, ""),
    "a HOME that can't be written": ({"HOME": "/proc"}, ""),
    "pyenv": ({"PATH": "{pyenv}:/usr/bin:/bin", "PYTHONHOME": "/nowhere", "VIRTUAL_ENV": "/nowhere"}, ""),
    "a display that does not answer": ({"DISPLAY": ":4711"}, ""),
    "a namespace": ({"ROS_NAMESPACE": "red"}, "ROS_NAMESPACE=red is left out: "),
    "a master of the user's own": ({"ROS_MASTER_URI": "http://127.0.0.1:{port}"}, ""),
    "a real robot's master": ({"ROS_MASTER_URI": "http://192.0.2.7:9"}, "unset ROS_MASTER_URI"),
    "no master's address": ({"ROS_MASTER_URI": "foo"}, "unset ROS_MASTER_URI"),
    "an address in a robot's network": ({"ROS_IP": "192.0.2.20"}, "ROS_IP "),
}
HARMLESS = ("another locale", "no HOME", "pyenv", "a display that does not answer", "a namespace")
OTHERS = tuple(name for name in ENVIRONMENTS if name not in HARMLESS)


def fit(names):
    """Return whether one terminal can have all of these environments."""
    return not any(ENVIRONMENTS[one][0].keys() & ENVIRONMENTS[two][0] for one, two in itertools.combinations(names, 2))


PAIRS = [pair for pair in itertools.combinations(OTHERS, 2) if fit(pair)][::3]

# All that are harmless beside each of the others; and four pairs of the others, only with --all.
TERMINALS = [(other, *(name for name in HARMLESS if fit((other, name)))) for other in OTHERS]
TERMINALS += [pytest.param(pair, marks=pytest.mark.slow) for pair in PAIRS]


@pytest.fixture
def terminal(tmp_path, monkeypatch):
    """A function that puts this test into several environments at once; it returns the settings of the commands."""
    make_program(tmp_path / "python3", "#!/bin/sh\nexit 77\n")
    here = {"pyenv": str(tmp_path), "port": free_port()}
    for name in ("ROS_HOME", "ROS_LOG_DIR", "ROS_NAMESPACE"):
        monkeypatch.delenv(name, raising=False)

    def enter(names):
        settings = {}
        for name, value in itertools.chain.from_iterable(ENVIRONMENTS[chosen][0].items() for chosen in names):
            if value is None:
                monkeypatch.delenv(name, raising=False)
            else:
                settings[name] = value.format(**here)
        return settings

    return enter


@pytest.fixture
def calls(terminal):
    """A function that makes a call in several environments at once."""
    return lambda names, *words, **settings: robocop(*words, **settings, **terminal(names))


def explained(text, names):
    """Return whether a text says what is wrong with these environments; of two things that are wrong, one."""
    wanted = [sentence for _, sentence in map(ENVIRONMENTS.get, names) if sentence and "is left out" not in sentence]
    return not wanted or any(sentence in text for sentence in wanted)


@pytest.mark.parametrize("names", TERMINALS, ids=" and ".join)
def test_run_and_goto_start_the_lab_or_say_what_is_wrong_and_grade_always_starts(calls, names):
    faults = [name for name in names if ENVIRONMENTS[name][1] and name != "a namespace"]
    for words, started in (
        (("run", "rviz:=false"), "robocop_goto_as.launch rviz:=false"),
        (("goto", "0.3", "0"), "/robocop_goto.py 0.3 0"),
        (("grade", "hand_in"), "/robocop_grade.py hand_in"),
    ):
        is_refused = faults and words[0] != "grade"  # by the program itself
        done = calls(names, *words, ROBOCOP_DRY_RUN="" if is_refused else "1")
        if is_refused:
            assert done.returncode == 1 and done.stdout == "" and explained(done.stderr, names), done.stderr
        else:
            assert done.returncode == 0 and done.stdout.rstrip().endswith(started), done.stderr
        assert ("ROS_NAMESPACE=red is left out" in done.stderr) is ("a namespace" in names)
        assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("names", TERMINALS, ids=" and ".join)
def test_doctor_names_what_is_wrong(calls, names):
    faults = [name for name in names if ENVIRONMENTS[name][1] and name != "a namespace"]
    done = calls(names, "doctor")
    assert done.returncode == (1 if faults else 0), done.stdout
    assert explained(done.stdout.partition("missing or wrong:")[2], names) and "Traceback" not in done.stderr


@pytest.mark.slow
def test_a_goal_is_reached_in_all_harmless_environments_at_once(terminal):
    settings = {**terminal(HARMLESS), "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    with Process(ROOT / "robocop", "run", "rviz:=false", "world:=empty", env=environment(**settings)) as system:
        wait_for(lambda: "stop " in system.output or system.poll() is not None, "the overview")
        done = robocop("goto", "0.15", "0", **settings)
    assert done.returncode == 0 and "SUCCEEDED: REACHED: " in done.stdout, done.stdout + done.stderr + system.output
