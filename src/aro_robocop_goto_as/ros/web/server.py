"""The page's HTTP and WebSocket server."""

import contextlib
import io
import os
import socket
from typing import Any

from ...errors import WebError
from ...web import access
from ...web_params import WebParams
from .viser_internals import checked_requests


def start_server(p: WebParams) -> Any:
    """The page's HTTP and WebSocket server; WebError if its address can't be used."""
    try:
        import viser
    except ImportError as error:
        raise WebError(f"{error}; run ./robocop web, which installs what the page needs") from error
    listening = None
    if access.SOCKET_VARIABLE in os.environ:
        listening = socket.socket(fileno=int(os.environ[access.SOCKET_VARIABLE]))
    else:
        _require_free(p.web_host, p.web_port)
    names, origins = [socket.gethostname(), p.web_host], p.web_origins.split()

    def refusal(headers: Any) -> str:
        return access.refusal(headers.get_all("Host"), headers.get_all("Origin"), names, origins)

    answers = {
        "Content-Security-Policy": access.CONTENT_POLICY,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
    }
    with checked_requests(refusal, answers, listening):
        with contextlib.redirect_stdout(io.StringIO()):  # its table of addresses
            server = viser.ViserServer(host=p.web_host, port=p.web_port, verbose=False)  # unnamed: it says "Connecting"
    if server.get_port() != p.web_port:  # viser goes on to the next port that is free
        server.stop()
        raise WebError(f"port {p.web_port} has just been taken by another program; choose another one with web_port:=N")
    return server


def _require_free(host: str, port: int) -> None:
    try:
        for family, kind, protocol, _, address in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM):
            with socket.socket(family, kind, protocol) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind(address)
    except OSError as error:
        raise WebError(
            f"can't open {host}:{port}: {error.strerror or error}; choose another address with web_host:=ADDRESS, "
            "or another port with web_port:=N"
        ) from error
