"""`./robocop bench`: measures the simulator's speed and cost, alone or beside that of another checkout."""


class BenchError(Exception):
    """A case can't be measured."""
