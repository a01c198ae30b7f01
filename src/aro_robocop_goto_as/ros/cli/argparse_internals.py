"""Uses private parts of argparse, for one purpose: negative numbers in scientific notation."""

import argparse
import re


def accept_scientific_notation(parser: argparse.ArgumentParser) -> None:
    """Let a parser accept -5e-1 as a number; argparse treats it as an unknown option."""
    parser._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
