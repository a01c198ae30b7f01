"""Attacks of submissions on the grader have no effect; run by `./robocop test --all` where bubblewrap can run."""

import os
import shutil
import socket
import subprocess
import tempfile
import zipfile
from pathlib import Path

import attacks
import pytest
from graded import PLAN, SHARE, prepared, recorded
from processes import processes_mentioning
from right_solutions import RIGHT

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading import new, runner
from robocop_grading.errors import GradingError, UngradableError

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


REFUSED = {"FORK_BOMB": 1, "FULL_DISK": 5, "READ": 4, "KILL_ALL": 1, "ENDLESS": 0}  # lines that say so
ENDS = {"FORK_BOMB": "it started more than 64 processes", "ENDLESS": "processor time"}  # of nodes that are ended


@pytest.mark.parametrize("name", REFUSED)
def test_attack_fails_and_the_submission_is_still_graded(name, tmp_path, monkeypatch):
    if name == "ENDLESS":  # which ends with its processor time
        monkeypatch.setattr(runner, "MAX_CPU_TIME", 20)
    neighbour = tmp_path / "neighbour"
    neighbour.mkdir()
    (neighbour / "solution.py").write_text("secret")
    run, lines = attacked(getattr(attacks, name), tmp_path / "mine")
    assert run.problem == ""
    refused = [line for line in lines if line.startswith("refused")]
    assert len(refused) == REFUSED[name], lines
    assert ("already_there" in run.records) == run.records["start"].up == (name not in ENDS)
    ends = [end.reason for record in run.records.values() for end in record.node_ends]
    assert len(ends) == (name in ENDS) and all(ENDS[name] in reason for reason in ends), ends


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


def build_log(submission, folder):
    """What the build of a submission has printed."""
    command = ["bsdtar", "-x", "-f", submission.archive, "-C", folder, "workspace/build.log"]
    subprocess.run(command, check=True)
    return (folder / "workspace" / "build.log").read_text()


def build_attack(package, code, then=""):
    """Have the package's build run some code."""
    name = f"attack_{len(code)}.py"
    (package / name).write_text(code)
    with open(package / "CMakeLists.txt", "a") as text:
        text.write(f"execute_process(COMMAND python3 ${{CMAKE_CURRENT_SOURCE_DIR}}/{name} {then})\n")
    return name


@pytest.fixture(scope="module")
def attacking(tmp_path_factory):
    """What is prepared of a package whose build and launch file attack, and the build's log."""
    folder = tmp_path_factory.mktemp("attacking")
    package, neighbour = (
        folder / os.fsdecode(b'O\'Neil & b (1) #3, "$HOME" $(touch x) \xf8\xe9zen'),
        folder / "neighbour.py",
    )
    new.make(package)
    neighbour.write_text("secret")
    (package / "link").symlink_to(neighbour)
    (package / "backup").mkdir()
    (package / "backup" / "robocop_goto_as.py").write_text("unfinished")
    with socket.socket() as outside, pytest.MonkeyPatch.context() as patch:
        outside.bind(("127.0.0.1", 0))
        outside.listen()
        patch.setenv("SECRET_OF_THE_TEACHER", "42")
        names = f"PLAN, NEIGHBOUR, PORT = {str(PLAN)!r}, {str(neighbour)!r}, {outside.getsockname()[1]}\n"
        attack = build_attack(package, names + attacks.BUILD)
        build_attack(package, f"FOLDER = {str(folder)!r}{attacks.BUILD_LEAVES}")
        launch = package / "launch" / "robocop_goto_as.launch"
        more = (
            '<node pkg="tf2_ros" type="static_transform_publisher" name="map" args="0 0 0 0 0 0 map odom"/>\n'
            f'<param name="loot" command="sh -c &quot;python3 $(find aro_robocop_goto_as)/{attack}&quot;"/></launch>'
        )
        text = launch.read_text().replace("output=", "respawn='true' output=", 1)
        launch.write_text(text.replace("</launch>", more))
        submission = prepared(package, folder / "workshop")
    return submission, build_log(submission, folder), folder


together = pytest.mark.xdist_group("attacking")  # it is built once


@together
def test_build_and_launch_file_cannot_reach_anything_outside_the_sandbox(attacking):
    submission, log, _ = attacking
    assert set(submission.parameters) == {"/loot"}
    for words in (log, submission.parameters["/loot"]):
        assert sum(line.startswith("refused ") for line in words.splitlines()) == 9, words
        assert "SUCCESS" not in words, words


@together
def test_build_is_over_when_its_command_has_ended_and_what_it_leaves_running_ends_too(attacking):
    _, log, folder = attacking
    assert "left running" in log
    assert processes_mentioning(folder) == []


@together
def test_grade_says_which_scripts_are_started_and_what_the_launch_file_asks_for_in_vain(attacking):
    submission, _, _ = attacking
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


@pytest.mark.parametrize("name", ["scripts/robocop_goto_as.py", "launch/robocop_goto_as.launch"])
def test_link_made_by_the_build_leads_nowhere(name, package, tmp_path):
    secret, place = tmp_path / "secret.py", f"${{CMAKE_CURRENT_SOURCE_DIR}}/{name}"
    secret.write_text((package / "scripts" / "robocop_goto_as.py").read_text())
    with open(package / "CMakeLists.txt", "a") as text:
        text.write(f"execute_process(COMMAND ln -sf {secret} {place})\n")
    with pytest.raises(RobocopError, match=f"{name}.* No such file or directory"):
        prepared(package, tmp_path / "workshop")


def test_script_that_is_a_link_out_of_the_hand_in_is_named(package, tmp_path):
    script = package / "scripts" / "robocop_goto_as.py"
    script.rename(tmp_path / "elsewhere.py")
    script.symlink_to(tmp_path / "elsewhere.py")
    (package / "scripts" / "same.py").symlink_to("robocop_rviz_goto_ac.py")
    told = "non-existing file(.|\n)*lab/scripts/robocop_goto_as.py is a link to .*/elsewhere.py"
    with pytest.raises(RobocopError, match=told):
        prepared(package, tmp_path / "workshop")


def test_build_that_fills_its_disk_fails_with_a_reason(package, tmp_path):
    build_attack(package, "open('/hand_in/big', 'wb').write(bytes(300 * 2 ** 20))", "COMMAND_ERROR_IS_FATAL ANY")
    with pytest.raises(GradingError, match="No space left on device|File too large"):
        prepared(package, tmp_path / "workshop")


def test_build_that_nests_its_folder_leaves_little(package, tmp_path):
    build_attack(package, attacks.BUILD_NESTED)
    assert prepared(package, tmp_path / "workshop").archive.stat().st_size < 32 * 2**20


def test_build_that_ends_what_reads_it_gets_no_grade(package, tmp_path):
    build_attack(package, f"PID = 1\n{attacks.KILL_ALL}")
    with pytest.raises(RuntimeError, match="exit status 137"):
        prepared(package, tmp_path / "workshop")


@pytest.mark.parametrize("count, size", [(5, 100), (1, 300)])  # the last: more than a single file may have
def test_archive_that_unpacks_to_more_than_there_is_room_for_is_refused(count, size, tmp_path):
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as bomb:
        for number in range(count):
            bomb.writestr(f"{number}.py", bytes(size * 2**20))
    with pytest.raises(GradingError, match="^bomb.zip: too large; the largest file in it is [0-9].py with [12]"):
        prepared(tmp_path / "bomb.zip", tmp_path / "workshop")


def test_endless_line_of_a_build_is_cut(package, tmp_path):
    build_attack(package, attacks.BUILD_LONG_LINE, "COMMAND_ERROR_IS_FATAL ANY")
    with pytest.raises(RobocopError, match="can't be built") as caught:
        prepared(package, tmp_path / "workshop")
    assert len(str(caught.value)) < 6_000
