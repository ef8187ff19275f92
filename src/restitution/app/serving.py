"""Serve the page on this machine until Ctrl-C."""

from __future__ import annotations

import socket
from collections.abc import Callable
from typing import Any

import uvicorn

from restitution.app.server import OwnHostOnly, Server
from restitution.app.session import Session
from restitution.errors import CaseError


class _Uvicorn(uvicorn.Server):
    """A server that calls `ready` when it accepts requests, and `ending` before it shuts down."""

    def __init__(
        self, config: uvicorn.Config, ready: Callable[[], None], ending: Callable[[], None]
    ) -> None:
        super().__init__(config)
        self._ready, self._ending = ready, ending

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start, then call `ready`."""
        await super().startup(sockets)
        self._ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Call `ending`, then end."""
        self._ending()
        await super().shutdown(sockets)


def serve_page(session: Session, port: int, ready: Callable[[str], Any]) -> None:
    """Serve the page of `session` at `port` (0: any free port); call `ready` with its address."""
    listening = socket.socket()
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(("127.0.0.1", port))
    except OSError as error:
        listening.close()
        raise CaseError(f"--port: {port} cannot be used ({error.strerror}); give another") from None
    with listening:
        port = listening.getsockname()[1]
        server = Server(session)
        config = uvicorn.Config(
            OwnHostOnly(server.app, port),
            log_level="error",
            server_header=False,
            timeout_graceful_shutdown=1,
        )
        address = f"http://127.0.0.1:{port}/#{session.token}"
        _Uvicorn(config, lambda: ready(address), server.stop).run(sockets=[listening])
