"""What the words of ./robocop start, shown by dry runs."""

import re
import shlex
import socket

import pytest
from command import ROOT, dry_run, robocop, x_server

from aro_robocop_goto_as.cli.commands import COMMANDS, web_arguments
from robocop_hosting.ports import free_port

LOCAL = "http://localhost:11399"
LAUNCH = "/launch/robocop_launch.py --quiet aro_robocop_goto_as"


def test_help_describes_every_command_whose_arguments_are_checked():
    assert set(COMMANDS) < set(re.findall(r"(?m)^  ([a-z][a-z-]*)", robocop("help").stdout))


def test_clean_with_an_argument_removes_nothing():
    done = robocop("clean", "web", ROBOCOP_DRY_RUN="1")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "robocop: clean: expected no arguments, got web\n"


@pytest.mark.parametrize("words", [("run", "--help"), ("sim", "world:=stage_1", "-h")])
def test_each_command_prints_its_part_of_the_help_and_starts_nothing(words):
    done = robocop(*words)
    assert done.returncode == 0 and done.stdout.startswith(f"  {words[0]} "), done.stderr
    text, _, arguments = done.stdout.partition("\n  Each ARG:=VALUE is one of these;")
    assert text.strip("\n") in robocop("help").stdout
    assert len(re.findall(r"(?m)^  [a-z]", text)) == (2 if words[0] == "sim" else 1)
    assert re.search(r"(?m)^    world:= +NAME of worlds/NAME.sdf, ", arguments)  # as in robocop_sim.launch


@pytest.mark.parametrize(
    "words, reason",
    [
        ((".",), "unknown command '.' (./robocop help lists them)"),
        (("stop",), "unknown command 'stop' (./robocop help lists them); Ctrl-C in its terminal ends what runs there"),
        (("run", "--with", "my_lab"), "run: --with is an option of sim: ./robocop sim --with PATH"),
        (("replay", "nowhere.bag"), "replay: there is no file nowhere.bag"),
        (("replay",), "replay: expected a bag of ./robocop record or of a report"),
    ],
)
def test_mistaken_command_is_refused_with_the_one_to_use(words, reason):
    done = robocop(*words)
    assert (done.stdout, done.stderr) == ("", f"robocop: {reason}\n") and done.returncode


def test_messages_name_the_command_as_a_container_has_it():
    assert "(docker exec x robocop help lists them)" in robocop("tset", ROBOCOP_COMMAND="docker exec x robocop").stderr


def test_unknown_command_is_refused_with_the_one_that_may_be_meant():
    done = robocop("tset")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "robocop: unknown command 'tset' (./robocop help lists them); did you mean test?\n"


@pytest.mark.parametrize(
    "given, shown",
    [
        ({}, ["ROS_HOSTNAME=localhost"]),
        ({"ROS_MASTER_URI": LOCAL}, ["ROS_HOSTNAME=localhost", f"ROS_MASTER_URI={LOCAL}"]),
        (
            {"ROS_MASTER_URI": "http://127.0.0.1:11399"},
            ["ROS_HOSTNAME=localhost", "ROS_MASTER_URI=http://127.0.0.1:11399"],
        ),
        ({"ROS_MASTER_URI": "http://robot:11311"}, ["ROS_MASTER_URI=http://robot:11311"]),
        ({"ROS_IP": "192.0.2.1"}, ["ROS_IP=192.0.2.1"]),
        ({"ROS_HOSTNAME": "robot"}, ["ROS_HOSTNAME=robot"]),
    ],
)
def test_ros_listens_on_loopback_unless_a_setting_names_another_network(given, shown):
    assert dry_run("shell", "true", **given)[1] == shown


@pytest.mark.parametrize(
    "word, started, message",
    [
        ("world:=empty", "rviz:=false web:=true world:=empty", "the web page takes the place of RViz"),
        ("web:=true", "rviz:=false web:=true", "RViz is not started\n"),
        ("web:=false", "rviz:=false web:=false", "RViz is not started\n"),
        ("rviz:=true", "rviz:=true", ""),
        ("rviz:=false", "rviz:=false", ""),
    ],
)
def test_without_a_display_the_web_page_replaces_rviz_unless_one_of_them_was_chosen(word, started, message):
    command, _, messages = dry_run("run", word)
    assert command.endswith(f"{LAUNCH} robocop_goto_as.launch {started}")
    assert message in messages and ("no usable display" in messages) is bool(message)


def test_without_a_display_pybullets_window_is_refused():
    done = robocop("sim", "gui:=true", ROBOCOP_DRY_RUN="1")
    assert done.returncode == 1 and "gui:=true: it is a window, and there is no usable display" in done.stderr


def test_sim_takes_that_rviz_is_not_wanted():
    assert dry_run("sim", "world:=empty", "rviz:=false")[0].endswith(f"{LAUNCH} robocop_sim.launch world:=empty")
    assert "there is no argument rviz" in robocop("sim", "rviz:=true").stderr


def test_set_up_of_an_unknown_part_is_refused_with_the_known_ones():
    done = robocop("setup", "wbe")
    assert done.returncode == 1
    assert "no part 'wbe'; there are: axclient class grade " in done.stderr and "did you mean web?" in done.stderr


def test_rviz_is_opened_on_a_working_display():
    with x_server() as display:
        assert "rviz:=true" in dry_run("run", DISPLAY=display)[0]


@pytest.mark.parametrize("command", ["run", "sim"])
def test_verbose_shows_the_messages_of_all_nodes(command):
    started = dry_run(command, "--verbose", "world:=empty", ROS_MASTER_URI=f"http://localhost:{free_port()}")[0]
    assert LAUNCH.replace("--quiet ", "") in started and started.endswith(" world:=empty")


@pytest.mark.parametrize("command", ["grade", "grade-class"])
def test_nothing_to_grade_is_refused_before_anything_is_installed(command, tmp_path):
    (tmp_path / "hand_ins").mkdir()
    for words in ([], [str(tmp_path / "none.py")], [str(tmp_path / "hand_ins"), "--unsafe"]):
        done = robocop(command, *words)
        assert (done.returncode, done.stdout) == (4, "")
        assert done.stderr.startswith(f"robocop: {command}: expected a file or folder with something to grade, got: ")
        assert "--unsafe" not in done.stderr
        assert done.stderr.count("\n") == 1, "no other messages"
        assert ("hand_ins (the folder is empty)" in done.stderr) is ("--unsafe" in words)


@pytest.mark.parametrize(
    "command, script, parts",
    [("grade", "robocop_grade.py", "hosting grade"), ("grade-class", "robocop_grade_class.py", "hosting grade class")],
)
def test_grader_gets_what_it_needs_and_its_arguments(command, script, parts):
    started, _, messages = dry_run(command, "hand_ins", "--unsafe")
    assert started.endswith(f"/{script} hand_ins --unsafe") and f"would set up: run {parts}\n" in messages


@pytest.mark.slow
@pytest.mark.parametrize("command", [("run", "rviz:=false"), ("goto", "1", "0")])
def test_port_that_never_answers_is_reported_within_seconds(command):
    with socket.create_server(("127.0.0.1", 0)) as silent:
        uri = f"http://127.0.0.1:{silent.getsockname()[1]}"
        done = robocop(*command, ROS_MASTER_URI=uri, timeout=60.0)
    assert (done.returncode, done.stdout) == (1, "")
    assert f"{uri} did not answer within 5 s: stop the process that uses this port" in done.stderr


def test_a_recording_gets_the_ending_of_a_bag_and_never_overwrites_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = shlex.split(dry_run("record", "lab")[0])
    assert words[:3] == ["rosrun", "rosbag", "record"] and "--output-name=lab.bag" in words
    left_out = words[-1].partition("--exclude=")[2]
    assert all(re.fullmatch(left_out, topic) for topic in ("/camera/rgb/image_raw", "/red/camera/depth/points"))
    recorded = ("/scan", "/bumper", "/map_metadata", "/camera/rgb/image_raw/compressed", "/rosout")
    assert "--all" in words and not any(re.fullmatch(left_out, topic) for topic in recorded)
    (tmp_path / "lab.bag").write_text("")
    for arguments, reason in (
        (["/nosuch/x.bag"], "record: /nosuch is not a folder in which a file can be created"),
        (["lab"], "lab.bag exists; give another name"),
        (["a", "b"], "record: expected one file, got a b"),
    ):
        done = robocop("record", *arguments)
        assert (done.returncode, done.stderr) == (1, f"robocop: {reason}\n")


def test_replay_plays_a_bag_in_the_page_and_refuses_what_is_none(tmp_path):
    command, _, messages = dry_run("replay", f"{tmp_path}/run.bag", "rate:=2")
    assert command.endswith(f"{LAUNCH} replay.launch bag:={tmp_path}/run.bag rviz:=false rate:=2")
    command, _, _ = dry_run("replay", f"{tmp_path}/run.bag", "--start", "12.5")
    assert command.endswith(f"{LAUNCH} replay.launch bag:={tmp_path}/run.bag rviz:=false start:=12.5")
    assert dry_run("replay", f"{tmp_path}/run.bag", "rate:=2", "--start", "12.5")[0].endswith(" rate:=2 start:=12.5")
    assert "would set up: run web\n" in messages
    for words in (("--start", "soon"), ("--start",), ("rate:=x",)):
        done = robocop("replay", "a", *words, ROBOCOP_DRY_RUN="1")
        assert done.returncode == 1 and ": expected a number, got " in done.stderr


def test_foreign_package_is_started_from_its_absolute_path(tmp_path):
    assert dry_run("sim", "--with", str(tmp_path), "gui:=true")[0].endswith(
        f"/robocop_sim_with.py {tmp_path} gui:=true"
    )
    assert dry_run("sim", "--with", str(tmp_path), "world:=worlds/empty.sdf")[0].endswith(
        f"{tmp_path} world:={ROOT}/worlds/empty.sdf"
    )
    assert dry_run("sim", "--verbose", "--with", str(tmp_path))[0].endswith(
        f"/robocop_sim_with.py {tmp_path} --verbose"
    )
    assert "--with: expected the folder of a catkin package" in robocop("sim", "--with").stderr


@pytest.mark.parametrize(
    "words, web, others",
    [
        (["world:=maze_1"], [], ["world:=maze_1"]),
        (["web:=true", "seed:=1", "web_port:=81"], ["robocop_web.py", "web_port:=81"], ["seed:=1"]),
        (["web:=false", "web_port:=81"], [], []),
    ],
)
def test_a_package_runs_with_the_web_page_if_that_is_asked_for(words, web, others):
    assert web_arguments(words) == (web, others)
