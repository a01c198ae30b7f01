"""The page's HTTP and WebSocket server."""

import contextlib
import io
import socket
from pathlib import Path
from typing import Any, Iterator

from ...errors import WebError
from ...names import robocop
from ...web import access
from ...web.params import WebParams

LAB = Path(__file__).resolve().parents[4] / "docs" / "lab.md"
MAX_REQUEST = 1 << 20  # [byte] that a page may send at once
HEADERS = {
    "Content-Security-Policy": access.CONTENT_POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}


def start_server(p: WebParams) -> Any:
    """The page's HTTP and WebSocket server; WebError if its address can't be used."""
    try:
        import viser
    except ImportError as error:
        raise WebError(f"{error}; run {robocop()} web, which installs what the page needs") from error
    access.require_free(p.web_host, p.web_port)
    with _checked_requests(p), contextlib.redirect_stdout(io.StringIO()):  # its table of addresses
        server = viser.ViserServer(host=p.web_host, port=p.web_port, verbose=False)  # no label: "Connecting"
    if server.get_port() != p.web_port:  # viser goes on to the next port that is free
        server.stop()
        raise WebError(f"port {p.web_port} has just been taken by another program; choose another one with web_port:=N")
    return server


@contextlib.contextmanager
def _checked_requests(p: WebParams) -> Iterator[None]:
    """A viser server made in this block answers only requests that are not refused, with HEADERS.

    viser passes no such options on to websockets' serve(), which it calls before its constructor returns.
    """
    from websockets.asyncio import server as websockets_server  # not installed where the page has never been used

    serve = websockets_server.serve
    names, origins = [socket.gethostname(), p.web_host], p.web_origins.split()

    def checking_serve(handler: Any, host: str, port: int, process_request: Any, **options: Any) -> Any:
        def process(connection: Any, request: Any) -> Any:
            reason = access.refusal(request.headers.get_all("Host"), request.headers.get_all("Origin"), names, origins)
            if reason:
                response = connection.respond(403, reason + "\n")
            elif request.path == "/lab.md" and LAB.is_file():
                response = connection.respond(200, LAB.read_text(encoding="utf-8"))
            else:
                response = process_request(connection, request)
            if response is not None:
                response.headers.update(HEADERS)
            return response

        options = {**options, "process_request": process, "max_size": MAX_REQUEST}
        return serve(handler, host, port, **options)

    setattr(websockets_server, "serve", checking_serve)  # noqa: B010  mypy refuses to assign to a module's function
    try:
        yield
    finally:
        setattr(websockets_server, "serve", serve)  # noqa: B010
