"""Whether a server is there, and stays."""

import difflib
import re

from ..plan import Limits
from ..record import Record
from .endings import last_error
from .verdict import Failed, NotReached, Passed, Verdict, check, named

NAME = "/robocop_goto_as"
TYPE = "aro_robocop_goto_as/GoToPositionAction"
THREAD_DIED = re.compile(r"^(Syntax|Indentation|Tab)Error|Exception in thread|bad callback|"
                         r"Traceback \(most recent call last\)|xception in your execute callback")


@check("states")
def action_server(record: Record, limits: Limits) -> Verdict:
    """There is an action server called robocop_goto_as, of the handout's type."""
    if record.name != "start":
        return NotReached("it is looked at when the node starts")
    if record.up:
        return Passed()
    seen = named(record.servers)
    if NAME in record.servers:
        kind = record.types[record.servers.index(NAME)]
        if kind != TYPE:
            return Failed(TYPE, kind, 0.0, f"the action's type is {kind}; the handout's is GoToPositionAction of "
                                           "aro_robocop_goto_as")
        return Failed("a server that clients can connect to", "no connection", 0.0,
                      "GoToPosition.action has other fields than the handout's, or the server was not started "
                      "(auto_start=False needs server.start())")
    if record.deaths:
        return Failed("a running node", f"it ended with status {record.deaths[0].status}", record.deaths[0].time,
                      "the node ends at its start: " + (record.deaths[0].reason or last_error(record)))
    close = difflib.get_close_matches(NAME, record.servers, n=1, cutoff=0.5) or list(record.servers[:1])
    if close:
        return Failed(NAME[1:], close[0].lstrip("/"), 0.0,
                      f"action server is called {close[0].lstrip('/')}; the handout says {NAME[1:]}")
    raised = isinstance(no_exception(record, limits), Failed)
    return Failed(NAME[1:], f"action servers: {seen}", 0.0, "an exception at its start: " + last_error(record) if raised
                  else "no action server was created, or it was not started (server.start())")


@check("states")
def no_exception(record: Record, limits: Limits) -> Verdict:
    """No exception is left uncaught, in no callback and no thread."""
    for line in record.lines:
        if THREAD_DIED.search(line.text):
            return Failed("no exception", line.text[:120].splitlines()[0], line.time, last_error(record))
    return Passed()


@check("states")
def stays_alive(record: Record, limits: Limits) -> Verdict:
    """The node is alive at the end, whatever came."""
    for death in record.deaths:
        return Failed("a running node", f"it ended with status {death.status}", death.time,
                      "the node died: " + (death.reason or last_error(record)))
    if record.problem.startswith("the node did not come up"):
        return Failed("a running node", "it did not come up again", 0.0, record.problem)
    return Passed()
