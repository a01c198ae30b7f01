"""Arguments of robocop_web are accepted unchanged or refused by name."""

import pytest

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.ros.web.node import consequence, load_params
from aro_robocop_goto_as.web.params import WebParams


def test_arguments_of_ros_and_empty_ones_are_left_out():
    assert load_params(["__name:=robocop_web", "__log:=/tmp/x", "web_host:=", "web_port:="]) == WebParams()


def test_the_environment_chooses_the_address_unless_it_is_given(monkeypatch):
    monkeypatch.setenv("ROBOCOP_WEB_HOST", "0.0.0.0")
    assert load_params(["web_host:="]).web_host == "0.0.0.0"
    assert load_params(["web_host:=127.0.0.1"]).web_host == "127.0.0.1"


def test_values_are_taken_as_they_are_written():
    given = load_params(["web_port:=8090", "web_frame:=odom", "view_only:=True", "replay:=1", "web_linear_velocity:=1"])
    assert given == WebParams(web_port=8090, web_frame="odom", view_only=True, replay="1", web_linear_velocity=1.0)


@pytest.mark.parametrize(
    "argument, reason",
    [
        ("web_prot:=1", "did you mean 'web_port'"),
        ("web_port:=80.5", "web_port: expected an integer, got '80.5'"),
        ("web_port:=70000", "web_port: expected at most 65535"),
        ("view_only:=maybe", "view_only: expected true or false, got 'maybe'"),
        ("web_frame:=/map", "web_frame: expected a frame name"),
        ("8090", "expected NAME:=VALUE, got '8090'"),
    ],
)
def test_wrong_arguments_are_refused_with_the_reason(argument, reason):
    with pytest.raises(ParameterError) as refused:
        load_params([argument])
    assert reason in str(refused.value)


@pytest.mark.parametrize(
    "arguments, runs_on",
    [
        (["robocop_web.py", "web_port:=1", "__name:=robocop_web", "__log:=/tmp/x"], True),
        (["robocop_web.py", "web_port:=1", "replay:=x.bag", "__name:=replay", "__log:=/tmp/x"], False),
        (["robocop_web.py", "web_port:=1"], False),
    ],
)
def test_a_page_of_roslaunch_that_can_not_start_says_that_the_lab_runs_on(arguments, runs_on):
    assert ("without the page" in consequence(arguments)) == runs_on
