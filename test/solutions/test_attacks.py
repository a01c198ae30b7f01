"""Attacks of submissions on the grader have no effect; run by `./robocop test --all` where bubblewrap can run."""

import os
import shutil
import socket
import subprocess
import tempfile
from pathlib import Path

import attacks
import pytest
from graded import PLAN, SHARE, STATE, recorded, sandbox
from right_solutions import RIGHT

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading import new, runner
from robocop_grading.errors import GradingError, UngradableError
from robocop_grading.sandbox import build
from robocop_grading.submission import prepare_submission

BUDGET = 900.0  # [s, wall] for an attack's two scenarios, on however busy a machine


def attacked(code, folder):
    """Run the base solution with an attack through one scenario; the recorded run and the lines of its output."""
    text = RIGHT["base_server"]
    names = f"PLAN, FOLDER, PID = {str(PLAN)!r}, {str(folder)!r}, {os.getpid()}\n"
    text = text.replace("if __name__", f"{names}{code}\nif __name__")
    run = recorded(text, folder, only=("already_there",), budget=BUDGET)
    lines = [line.text for record in run.records.values() for line in record.lines]
    assert not [line for line in lines if "SUCCESS" in line]
    return run, lines


@pytest.mark.parametrize("name", ["FORK_BOMB", "FULL_DISK", "READ", "KILL_ALL", "ENDLESS"])
def test_attack_fails_and_the_submission_is_still_graded(name, tmp_path, monkeypatch):
    if name == "ENDLESS":  # which ends with its processor time
        monkeypatch.setattr(runner, "MAX_CPU_TIME", 20)
    neighbour = tmp_path / "neighbour"
    neighbour.mkdir()
    (neighbour / "solution.py").write_text("secret")
    run, lines = attacked(getattr(attacks, name), tmp_path / "mine")
    assert run.problem == ""
    refused = [line for line in lines if line.startswith("refused")]
    assert len(refused) == {"FULL_DISK": 5, "READ": 4}.get(name, 0), refused
    assert "already_there" in run.records or not run.records["start"].up, "neither judged nor recorded as not started"


@pytest.mark.parametrize("name", attacks.LIES)
def test_lie_about_time_reaches_the_grader_and_ends_the_node_with_a_reason_or_has_no_effect(name, tmp_path):
    code, reason = attacks.LIES[name]
    run, lines = attacked(f"{attacks.LIE}{code}\n", tmp_path / "mine")
    reasons = [run.problem, *(end.reason for record in run.records.values() for end in record.node_ends)]
    assert "LIED" in lines
    assert any(reason in it for it in reasons) if reason else not any(reasons), reasons


@pytest.mark.slow
def test_node_can_read_nothing_that_tells_scenarios_apart(tmp_path):
    begin = "        success = False\n        while"
    text = RIGHT["base_server"].replace("\ndef wrap", f"{attacks.SPY}\ndef wrap", 1)
    text = text.replace(begin, f"        spy(self.server.current_goal.get_goal_id().id)\n{begin}", 1)
    run = recorded(text, tmp_path, only=("reaches_goal", "already_there", "only_ahead_counts"), budget=BUDGET)
    seen = {
        name: [it.text for it in record.lines if it.text.startswith("SEEN")] for name, record in run.records.items()
    }
    assert set(seen) == {"start", "left", "right", "already_there", "beside"}
    assert len({it for lines in seen.values() for it in lines}) == 1, seen


def test_what_the_system_refuses_the_grader_costs_no_points(tmp_path):
    out = tmp_path / "mine" / "out"

    def remove_folder(_scenario):
        out.rename(tmp_path / "gone")

    with pytest.raises(UngradableError, match="No such file or directory: .*/out/"):
        recorded(RIGHT["base_server"], tmp_path / "mine", budget=BUDGET, on_progress=remove_folder)


def test_sandbox_started_by_an_unprivileged_user_has_no_other_writable_places():
    code = (
        "import subprocess, sys\nfrom pathlib import Path\nfrom robocop_grading.sandbox.bubblewrap import Sandbox\n"
        "sandbox = Sandbox(())\n"
        "command = ['sh', '-c', 'for place in / /etc /dev /usr; do touch $place/here && echo SUCCESS $place; done; "
        "touch /tmp/here && echo fine']\n"
        "sys.exit(subprocess.call(sandbox.command_inside(command, {}, (), Path('/tmp/home'))))"
    )
    nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
    with tempfile.TemporaryDirectory() as folder:  # the checkout may be in a home that nobody else reads
        Path(folder).chmod(0o755)
        shutil.copytree(SHARE / "src", Path(folder) / "src")
        done = subprocess.run(
            [*nobody, "/usr/bin/python3", "-c", code],
            env={**os.environ, "HOME": "/tmp", "PYTHONPATH": f"{folder}/src"},
            capture_output=True,
            text=True,
            timeout=BUDGET,
            cwd="/tmp",
        )
    assert done.stdout == "fine\n", done.stdout + done.stderr


@pytest.fixture
def package(tmp_path):
    """The package that `robocop new` creates."""
    new.make(tmp_path / "lab")
    return tmp_path / "lab"


def prepared(package, workshop):
    """Build and read a package as the grader does."""
    return prepare_submission(str(package), SHARE, STATE, workshop, sandbox())


def test_build_and_launch_file_cannot_reach_anything_outside_the_sandbox(package, tmp_path, monkeypatch):
    neighbour = tmp_path / "neighbour.py"
    neighbour.write_text("secret")
    monkeypatch.setenv("SECRET_OF_THE_TEACHER", "42")
    (package / "link").symlink_to(neighbour)
    with socket.socket() as outside:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        names = f"PLAN, NEIGHBOUR, PORT = {str(PLAN)!r}, {str(neighbour)!r}, {outside.getsockname()[1]}\n"
        (package / "attack.py").write_text(names + attacks.BUILD)
        with open(package / "CMakeLists.txt", "a") as text:
            text.write("execute_process(COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/attack.py)\n")
        launch = package / "launch" / "robocop_goto_as.launch"
        command = "sh -c &quot;python3 $(find aro_robocop_goto_as)/attack.py&quot;"
        launch.write_text(f'<launch><param name="loot" command="{command}"/></launch>')
        submission = prepared(package, tmp_path / "workshop")
    log = next((tmp_path / "workshop").glob("*/build.log")).read_text()
    assert set(submission.parameters) == {"/loot"}
    for words in (log, submission.parameters["/loot"]):
        assert sum(line.startswith("refused ") for line in words.splitlines()) == 9, words
        assert "SUCCESS" not in words, words


@pytest.mark.parametrize(
    "name, make",
    [
        ("scripts/robocop_goto_as.py", "ln -s SECRET"),
        ("launch/robocop_goto_as.launch", "ln -s SECRET"),
        ("launch/robocop_goto_as.launch", "mkfifo"),
    ],
)
def test_link_or_pipe_made_by_the_build_is_refused_without_following_or_waiting_for_it(name, make, package, tmp_path):
    secret, place = tmp_path / "secret.py", f"${{CMAKE_CURRENT_SOURCE_DIR}}/{name}"
    secret.write_text((package / "scripts" / "robocop_goto_as.py").read_text())
    with open(package / "CMakeLists.txt", "a") as text:
        for command in (f"rm {place}", f"{make.replace('SECRET', str(secret))} {place}"):
            text.write(f"execute_process(COMMAND {command})\n")
    with pytest.raises(RobocopError, match="expected an ordinary file"):
        prepared(package, tmp_path / "workshop")


@pytest.mark.parametrize("place", ["elsewhere.py", "lab/elsewhere.py"])
def test_script_that_is_a_link_out_of_the_package_or_with_an_absolute_path_is_named(place, package, tmp_path):
    script = package / "scripts" / "robocop_goto_as.py"
    script.rename(tmp_path / place)
    script.symlink_to(tmp_path / place)
    (package / "scripts" / "same.py").symlink_to("robocop_rviz_goto_ac.py")
    with pytest.raises(RobocopError, match=f"^scripts/robocop_goto_as.py -> .*/{place}: links .* are not followed"):
        prepared(package, tmp_path / "workshop")


def build_attack(package, code, then=""):
    """Have the package's build run some code."""
    (package / "attack.py").write_text(code)
    with open(package / "CMakeLists.txt", "a") as text:
        text.write(f"execute_process(COMMAND python3 ${{CMAKE_CURRENT_SOURCE_DIR}}/attack.py {then})\n")


def test_build_is_over_when_its_command_has_ended_whatever_it_leaves_running(package, tmp_path):
    build_attack(package, "import subprocess\nsubprocess.Popen(['setsid', 'sleep', '600'])  # has CMake's pipe, too")
    assert [script.part for script in prepared(package, tmp_path / "workshop").scripts] == ["server", "bridge"]


def test_build_that_nests_its_folder_is_killed_with_a_reason(package, tmp_path):
    build_attack(package, attacks.BUILD_NESTED)
    with pytest.raises(GradingError, match="catkin_make was ended: it made more than 100 nested folders"):
        prepared(package, tmp_path / "workshop")
    subprocess.run(["rm", "-rf", tmp_path / "workshop"], check=True)


def test_what_a_build_made_of_its_log_and_its_sources_does_not_stop_the_next_one(package, tmp_path):
    workshop = tmp_path / "workshop"
    prepared(package, workshop)
    (folder,) = (path for path in workshop.iterdir() if path.is_dir())
    (folder / "build.log").unlink()
    (folder / "build.log" / "file").mkdir(parents=True)
    (folder / "src").rename(folder / "elsewhere")
    (folder / "src").symlink_to(folder / "elsewhere")
    assert {script.part for script in prepared(package, workshop).scripts} == {"server", "bridge"}


def test_what_an_interrupted_build_has_left_is_removed_by_the_next_one(package, tmp_path, monkeypatch):
    def interrupted(folder, *_):
        (folder / "half").write_text("a message's class that is cut short")
        raise KeyboardInterrupt

    workshop = tmp_path / "workshop"
    with monkeypatch.context() as during, pytest.raises(KeyboardInterrupt):
        during.setattr(build, "make", interrupted)
        prepared(package, workshop)
    assert len(list(workshop.glob("*/half"))) == 1
    prepared(package, workshop)
    assert list(workshop.glob("*/half")) == [] and len(list(workshop.iterdir())) == 1


def test_endless_line_of_a_build_is_cut(package, tmp_path):
    build_attack(package, attacks.BUILD_LONG_LINE, "COMMAND_ERROR_IS_FATAL ANY")
    with pytest.raises(RobocopError) as caught:
        prepared(package, tmp_path / "workshop")
    assert "can't be built" in str(caught.value) and len(str(caught.value)) < 6_000


def test_package_in_a_folder_of_any_name_is_built(package, tmp_path):
    odd = package.rename(tmp_path / os.fsdecode(b'O\'Neil & b (1) #3, "$HOME" $(touch x) \xf8\xe9zen'))
    assert [script.part for script in prepared(odd, tmp_path / "workshop").scripts] == ["server", "bridge"]


def test_grade_says_which_scripts_are_started_and_what_the_launch_file_asks_for_in_vain(package, tmp_path):
    (package / "backup").mkdir()
    (package / "backup" / "robocop_goto_as.py").write_text("unfinished")
    launch = package / "launch" / "robocop_goto_as.launch"
    helper = '<node pkg="tf2_ros" type="static_transform_publisher" name="map" args="0 0 0 0 0 0 map odom"/>\n</launch>'
    launch.write_text(launch.read_text().replace("</launch>", helper).replace("output=", "respawn='true' output=", 1))
    submission = prepared(package, tmp_path / "workshop")
    file = "launch/robocop_goto_as.launch, line"
    assert submission.files == [
        f"server: scripts/robocop_goto_as.py, started by {file} 8",
        f"bridge: scripts/robocop_rviz_goto_ac.py, started by {file} 9",
    ]
    assert "server: scripts/robocop_goto_as.py is graded, but not backup/robocop_goto_as.py" in submission.notes
    assert [note for note in submission.notes if note.startswith(file)] == [
        f"{file} 8: respawn='true' has no effect in a grading",
        f"{file} 10: node map (tf2_ros static_transform_publisher) is not started: server and bridge are graded one "
        "at a time, each alone",
    ]


def test_own_roslaunch_of_a_package_is_not_used(package, tmp_path):
    (package / "roslaunch").write_text(attacks.OWN_ROSLAUNCH)
    (package / "roslaunch").chmod(0o755)
    hook = package / "path.sh"
    hook.write_text(f"export PATH={package}:$PATH\n")
    with open(package / "CMakeLists.txt", "a") as text:
        text.write("catkin_add_env_hooks(path SHELLS sh DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})\n")
    assert "/own" not in prepared(package, tmp_path / "workshop").parameters
