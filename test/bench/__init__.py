"""What `./robocop bench` measures, how, and what it shows of it."""


class BenchError(Exception):
    """A case can't be measured."""
