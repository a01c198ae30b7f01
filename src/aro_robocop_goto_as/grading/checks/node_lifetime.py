"""Checks that a node comes up and keeps running."""

import difflib
import re

from ..check_limits import Limits
from ..handout import ACTION, ACTION_TYPE
from ..record import Record
from .consequences import EXCEPTION
from .endings import last_error
from .verdict import Earlier, Failed, NotReached, Passed, Verdict, check

START = (Earlier("action_server"),)
UNCAUGHT = re.compile(
    r"^(Syntax|Indentation|Tab)Error|Exception in thread|bad callback|"
    r"Traceback \(most recent call last\)|xception in your execute callback"
)


@check("states")
def action_server(record: Record, limits: Limits) -> Verdict:
    """The node provides an action server robocop_goto_as of the handout's type."""
    if record.name != "start":
        return NotReached("this is checked when the node starts")
    if record.up:
        return Passed()
    name = ACTION[1:]
    if ACTION in record.servers:
        kind = record.types[record.servers.index(ACTION)]
        if kind != ACTION_TYPE:
            cause = f"The action's type is {kind}; the handout's is GoToPositionAction of aro_robocop_goto_as"
            return Failed(ACTION_TYPE, kind, 0.0, cause)
        cause = (
            "The fields of GoToPosition.action differ from the handout's, or the server was not started "
            "(auto_start=False needs server.start())"
        )
        return Failed("a server that clients can connect to", "no connection", 0.0, cause)
    if record.deaths:
        death = record.deaths[0]
        cause = "The node ended while starting: " + (death.reason or last_error(record))
        return Failed("a running node", f"exit status {death.status}", death.time, cause)
    servers = [server.lstrip("/") for server in record.servers]
    if servers:
        close = (difflib.get_close_matches(name, servers, n=1, cutoff=0.5) or servers)[0]
        return Failed(name, close, 0.0, f"The action server is called {close}; the handout says {name}")
    cause = "No action server was created, or it was not started (server.start())"
    if isinstance(no_exception(record, limits), Failed):
        cause = "An exception while starting: " + last_error(record)
    return Failed(name, "no action server", 0.0, cause)


@check("states")
def no_exception(record: Record, limits: Limits) -> Verdict:
    """No callback or thread raises an uncaught exception."""
    for line in record.lines:
        if UNCAUGHT.search(line.text):
            seen, follows = line.text[:120].splitlines()[0], START if record.name == "start" else ()
            return Failed("no exception", seen, line.time, last_error(record), follows)
    return Passed()


@check("states")
def stays_alive(record: Record, limits: Limits) -> Verdict:
    """The node keeps running to the end."""
    for death in record.deaths:
        cause = "The node died: " + (death.reason or last_error(record))
        follows = START if record.name == "start" else () if death.reason else EXCEPTION
        return Failed("a running node", f"exit status {death.status}", death.time, cause, follows)
    if record.problem.startswith("the node did not come up"):
        return Failed("a running node", "it did not come up again", 0.0, record.problem)
    return Passed()
