"""What a node prints counts in each scenario, however much it has printed before."""

from unittest.mock import MagicMock

from robocop_grading.session.run import MAX_PRINTED, Run


def test_lines_of_a_node_that_has_printed_much_are_recorded_in_the_next_scenario():
    run = Run(MagicMock(), MagicMock())
    lines = []
    for name in ("click", "replace"):
        run.begin(name)
        for number in range(MAX_PRINTED // 900):
            run._on_line(f"{number:1000}")
        lines.append(run.entries["lines"])
    assert len(lines[0]) == len(lines[1]) == MAX_PRINTED // 1000
