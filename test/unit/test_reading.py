"""Numbers are read strictly; what else goes wrong in a file is tested with its readers."""

import pytest

from aro_robocop_goto_as.reading import finite_numbers


def test_numbers_are_finite_and_as_many_as_expected():
    assert finite_numbers(" 1 -2e-1\t+.5 3. ", 4) == (1.0, -0.2, 0.5, 3.0)
    for text in ("1 2", "nan", "inf", "1e999", "1_000", "infinity", "", "1,5", "0x10"):
        with pytest.raises(ValueError, match="^expected one finite number$"):
            finite_numbers(text, 1)
    for text in ("0 1", "1 -1"):
        with pytest.raises(ValueError, match="^expected 2 finite numbers greater than 0$"):
            finite_numbers(text, 2, positive=True)
