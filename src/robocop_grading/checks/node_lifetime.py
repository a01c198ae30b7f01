"""Checks that a node comes up and keeps running."""

import difflib
from typing import Sequence

from aro_robocop_goto_as.names import ACTION_TYPE

from ..handout import ACTION, Limits
from ..record import NodeEnd, Record
from .output import DELAY, TRACEBACK, TRACEBACK_LOGGED, UNCAUGHT, first_error, last_error
from .topic_use import other_action
from .verdict import EVERY_SCENARIO, PASSED, Failed, NotReached, Verdict, check

RAISED = 1  # exit status of a Python whose main thread has not caught an exception


def closest(name: str, others: Sequence[str]) -> str:
    """The name in `others` that is most similar to a name; empty if no name is similar."""
    return next(iter(difflib.get_close_matches(name, others, n=1, cutoff=0.5)), "")


@check("server", "start", plot="states")
def action_server(record: Record, limits: Limits) -> Verdict:
    """The node provides an action server robocop_goto_as of the handout's type."""
    if record.name != "start":
        return NotReached("this is checked when the node starts")
    if record.node_ends and not record.up:
        return _died("The node ended while starting", record.node_ends[0], record)
    name, servers = ACTION[1:], [server.lstrip("/") for server in record.servers]
    if servers and name not in servers:
        found = " and ".join(servers)
        return Failed(name, found, 0.0, f"The action server is called {found}; the handout says {name}")
    if record.up:
        return PASSED
    if servers:
        kind = record.types[record.servers.index(ACTION)]
        if kind != ACTION_TYPE:
            return Failed(ACTION_TYPE, kind, 0.0, other_action(kind))
        cause = (
            "The fields of GoToPosition.action differ from the handout's, or the server was not started "
            "(auto_start=False needs server.start())"
        )
        return Failed("a server that clients can connect to", "no connection", 0.0, cause)
    cause = "No action server was created, or it was not started (server.start())"
    if isinstance(no_exception(record, limits), Failed):
        cause = f"An exception while starting: {last_error(record)}"
    return Failed(name, "no action server", 0.0, cause)


def _died(cause: str, end: NodeEnd, record: Record) -> Failed:
    reason = end.reason or ("signal 9 (SIGKILL)" if end.is_unexplained else last_error(record))
    return Failed("a running node", f"exit status {end.status}", end.time, f"{cause}: {reason}")


@check("server", EVERY_SCENARIO, plot="states")
def no_exception(record: Record, limits: Limits) -> Verdict:
    """No callback or thread raises an uncaught exception."""
    fatal = [it.time for it in record.node_ends if it.status == RAISED and not it.reason]
    for number, line in enumerate(record.lines):
        is_fatal = any(abs(time - line.time) <= DELAY for time in fatal) and TRACEBACK_LOGGED.search(line.text)
        if is_fatal or UNCAUGHT.search(line.text):
            error = first_error([it.text for it in record.lines[number : number + TRACEBACK]])
            return Failed("no exception", error, line.time, last_error(record, line.time))
    return PASSED


@check("server", EVERY_SCENARIO, plot="states")
def stays_alive(record: Record, limits: Limits) -> Verdict:
    """The node keeps running to the end."""
    for end in record.node_ends:
        own = end.status == 0 and not end.reason
        return _died("The node ended by itself" if own else "The node died", end, record)
    if record.problem.startswith("the node did not come up"):
        return Failed("a running node", "it did not come up again", 0.0, record.problem)
    return PASSED
