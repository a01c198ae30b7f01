"""The arguments of robocop goto."""

import pytest

from aro_robocop_goto_as.ros.cli.goto_arguments import parse


@pytest.mark.parametrize("x", ["1e9", "-1e9", "nan", "inf", "one", ""])
def test_coordinates_that_are_no_place_end_the_program_with_2(x, capsys):
    with pytest.raises(SystemExit) as refused:
        parse([x, "0"])
    assert refused.value.code == 2
    assert "expected a number of metres within +-1e+06" in capsys.readouterr().err


def test_negative_numbers_are_coordinates():
    args = parse(["-5e-1", "-2"])
    assert (args.x, args.y, args.frame) == (-0.5, -2.0, "map")


def test_only_a_missing_coordinate_is_called_missing(capsys):
    with pytest.raises(SystemExit):
        parse(["0.3"])
    assert "the following arguments are required: y\n" in capsys.readouterr().err
