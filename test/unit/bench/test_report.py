"""bench.report: figures of repeats -> tables of one or of two checkouts, and JSON."""

from bench import report
from bench.cases import Case
from bench.measure import Run
from bench.report import Measured

WHERE = ["Some CPU, 2 cores", "5 s per measurement"]


def measured(name, repeats, checkout="", error=None):
    """A case with (factor, CPU time at factor 1 [s/s]) of each repeat, which loses five messages of each run."""
    one = Measured(Case(*name.split(":")), checkout, error=error)
    for factor, cpu in repeats:
        one.add(*(Run(at, cpu, 60_000_000, 0.5, 5000, 4995, 0.25) for at in (factor, 1.0)))
    return one


def rows_of(text):
    """The rows of a table, as mappings of titles to cells."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    assert len({len(line) for line in lines}) == 1  # aligned
    head, _, *body = ([cell.strip() for cell in line.strip("|").split("|")] for line in lines)
    return [dict(zip(head, cells)) for cells in body]


def test_table_shows_medians_and_spreads_and_sums_of_messages():
    repeats = [(500.0, 0.0041), (600.0, 0.0052), (540.0, 0.0045)]
    text = report.table([[measured("kinematic:1", repeats)]], WHERE)
    assert text.startswith("Some CPU, 2 cores\n5 s per measurement\n\n|")
    assert rows_of(text) == [
        {
            "drive": "kinematic 30 Hz",
            "robots": "1",
            "factor": "540 (500-600)",
            "CPU at 1 [ms/s]": "4.50 (4.10-5.20)",
            "memory [MB]": "60.0 (60.0-60.0)",
            "first scan [s]": "0.50 (0.50-0.50)",
            "client busy": "0.25 (0.25-0.25)",
            "messages": "29970",
            "lost": "30",
        }
    ]


def test_repeats_of_two_checkouts_are_compared_in_pairs():
    other = measured("kinematic:1", [(100.0, 0.02), (50.0, 0.02)], "other")
    this = measured("kinematic:1", [(300.0, 0.01), (100.0, 0.005)], "this")
    rows = rows_of(report.table([[other, this]], WHERE))
    assert [row[""] for row in rows] == ["other", "this", "ratio"]
    assert [row["factor"] for row in rows] == ["75.0 (50.0-100.0)", "200 (100-300)", "2.50 (2.00-3.00)"]
    assert rows[2]["CPU at 1 [ms/s]"] == "0.38 (0.25-0.50)"
    assert rows[2]["lost"] == "-"


def test_a_missed_factor_is_noted():
    result = Measured(Case("wheels", "50"))
    result.add(Run(1.2, 0.9, 1, 1.0, 10, 10, 0.51), Run(0.8, 1.1, 1, 1.0, 10, 10, 0.1))
    assert result.notes() == [
        "wheels:50: only 0.80 of the requested factor 1 reached",
    ]
    assert measured("wheels:1", [(9.0, 0.1)]).notes() == []
