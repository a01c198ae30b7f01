"""What is refused before a simulator is started."""

import datetime
import socket

import pytest

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.ros.cli.preflight import check, require_parameters


@pytest.mark.parametrize(
    "given, words",
    [
        ({"world": "stag_1"}, "there is no world 'stag_1'"),
        ({"world": "stag_1"}, "; did you mean stage_1?"),
        ({"model": "burgr"}, "; did you mean burger?"),
        ({"profile": "gazbo"}, "known are: gazebo, real, turtlebot3_gazebo; did you mean gazebo?"),
        ({"robots": "0"}, "robots: expected a number from 1 to 1000, got 0"),
        ({"robots": "1001"}, "robots: expected a number from 1 to 1000, got 1001"),
        ({"robots": "9" * 5000}, "robots: expected a number from 1 to 1000, got 99999"),
        ({"robots": "\N{SUPERSCRIPT TWO}"}, "robots: expected a number, such as 3, or 'NAME X Y [YAW]; ...'"),
        ({"robots": "red:burgr 0 0"}, "there is no model 'burgr'"),
        ({"robots": "red"}, "robots: expected a number, such as 3, or 'NAME X Y [YAW]; ...'"),
        ({"spawn": "here"}, "spawn: expected 'x y'"),
        ({"spawn": "", "x_pos": "left"}, "spawn: expected 'x y'"),
        ({"seed": "x"}, "launch arguments: seed: expected an integer, got 'x'"),
        ({"config": "nosuch.yaml"}, "config: there is no file /"),
        ({"web": "true", "web_port": "abc"}, "launch arguments: web_port: expected an integer, got 'abc'"),
        ({"web": "1", "web_port": "99999"}, "launch arguments: web_port: expected at most 65535, got 99999"),
        ({"seed": "99999999999"}, "launch arguments: seed: expected at most 2.14748e+09, got 99999999999"),
        ({"real_time_factor": "-1", "moving": "maybe"}, "real_time_factor: expected at least 0, got -1.0; moving: ex"),
        ({"drive": "wheel"}, "launch arguments: drive: expected one of wheels, kinematic, got 'wheel'"),
    ],
)
def test_what_the_simulator_would_refuse_is_refused(given, words):
    with pytest.raises(RobocopError) as refused:
        check(given)
    assert words in str(refused.value)


def test_a_page_whose_port_another_program_has_is_no_reason_to_start_nothing():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        check({"web": "true", "web_host": "127.0.0.1", "web_port": str(taken.getsockname()[1])})


@pytest.mark.parametrize(
    "value, words",
    [
        ({"a": None}, "FILE: a has no value"),
        ({"a": {"b": [1, {"c": None}]}}, "FILE: a: b: c has no value"),
        ({1: 2}, "FILE: 1 is no name"),
        ({"a": datetime.date(2026, 1, 2)}, "FILE: a: 2026-01-02 is no number, text or list"),
        ({"a": 2**31}, "FILE: a: 2147483648 is too large"),
    ],
)
def test_what_the_parameter_server_cannot_have_is_refused(value, words):
    with pytest.raises(RobocopError) as refused:
        require_parameters(value, "FILE")
    assert str(refused.value).startswith(words)
