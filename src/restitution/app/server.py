"""The server of the page: it sends static files, and answers requests that only this page can make.

These are POST requests with the token in the address of the page. An Origin header must name this
page. The Host header must name this machine, which prevents DNS rebinding: a web site lets its own
domain name refer to this machine, so that its pages reach the server.
"""

from __future__ import annotations

import asyncio
import hmac
import json
import secrets
import shutil
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable
from functools import cache, partial
from importlib.resources import files
from pathlib import PurePath
from typing import Any
from urllib.parse import unquote

from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.datastructures import MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, Response, StreamingResponse
from starlette.routing import Route
from starlette.types import ASGIApp, Receive, Scope, Send

from restitution.app.content import content_of, text_of
from restitution.app.form import form
from restitution.app.process import Process
from restitution.app.session import LARGEST_SCAN, Session
from restitution.errors import CaseError
from restitution.plots.library import script

_LARGEST_BODY = 2**22  # largest size of a JSON request (bytes)
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "DENY",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
# Names and types of the values in each kind of request that a worker process answers.
_VALUES: dict[str, dict[str, type]] = {
    "curve": {"tab": str, "content": dict},
    "smooth": {"tab": str, "shown": str},
    "maps": {"tab": str, "depth": int},
    "run": {"tab": str, "content": dict, "grids": int},
    "show": {"tab": str, "content": dict, "code": str, "velocity": str, "grids": int},
    "take": {"tab": str, "content": dict, "what": str, "code": str, "velocity": str, "grids": int},
}
_TYPES = {".js": "text/javascript", ".css": "text/css"}  # of the files in static/
_STREAMED = "curve", "smooth", "maps", "run", "show"
_PAGES = {"/": "page.html", "/help": "help.html"}
Handler = Callable[[Request], Awaitable[Response]]


class Server:
    """Passes the requests of the page to processes.

    They are for live curves, complete runs, finer runs and runs with many impacts.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._live, self._runs, self._finer, self._worn = (
            Process(session.scans, session.room) for _ in range(4)
        )
        self.app = Starlette(
            routes=[
                *(
                    Route(f"/api/{name}", self._guarded(handler), methods=["POST"])
                    for name, handler in self._handlers().items()
                ),
                *(Route(path, self._page) for path in _PAGES),
                Route("/{name}", self._static),
            ],
        )

    def stop(self) -> None:
        """End the processes, and with them all unfinished requests."""
        for process in (self._live, self._runs, self._finer, self._worn):
            process.stop()

    def _handlers(self) -> dict[str, Handler]:
        return {
            "start": self._start,
            "content": self._content,
            "text": self._text,
            **{name: partial(self._stream, name) for name in _STREAMED},
            "take": self._take,
            "upload": self._upload,
        }

    def _guarded(self, handler: Handler) -> Handler:

        async def answer(request: Request) -> Response:
            token = request.headers.get("x-token", "")
            if not hmac.compare_digest(token.encode(), self._session.token.encode()):
                raise HTTPException(403, "open the address that the terminal shows")
            kind = request.headers.get("content-type", "").split(";")[0].strip().lower()
            wanted = "application/octet-stream" if handler == self._upload else "application/json"
            if kind != wanted:
                raise HTTPException(415, f"the content type must be {wanted}")
            return await handler(request)

        return answer

    async def _page(self, request: Request) -> Response:
        """Return the page, or its help; their policy allows only scripts of this server."""
        nonce = secrets.token_urlsafe(16)
        policy = (
            "default-src 'none'; script-src 'self'; connect-src 'self'; "
            "img-src 'self' data: blob:; "
            # Allow style attributes, because the plotting library parses HTML that contains them.
            f"style-src 'self' 'nonce-{nonce}'; style-src-attr 'unsafe-inline'; "
            "form-action 'none'; base-uri 'none'; frame-ancestors 'none'"
        )
        return Response(
            _file(_PAGES[request.url.path]).replace("{{ nonce }}", nonce),
            media_type="text/html",
            headers={"Content-Security-Policy": policy},
        )

    async def _static(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name == "plotly.js":
            return Response(script(), media_type="text/javascript")
        if name not in _static_files():
            raise HTTPException(404, "there is no such page")
        return Response(_file(name), media_type=_TYPES[PurePath(name).suffix])

    async def _start(self, _: Request) -> Response:
        return JSONResponse({"form": form(), "content": self._session.content})

    async def _content(self, request: Request) -> Response:
        values = await _values(request, {"text": str})
        try:
            return JSONResponse({"content": content_of(values["text"])})
        except CaseError as error:
            return JSONResponse({"error": str(error)})

    async def _text(self, request: Request) -> Response:
        values = await _values(request, {"content": dict})
        return JSONResponse({"text": _text(values["content"])})

    async def _stream(self, name: str, request: Request) -> Response:
        return _streamed(request, await self._ask(name, request))

    async def _ask(self, name: str, request: Request) -> AsyncGenerator[str]:
        values = await _values(request, _VALUES[name])
        whole = self._runs
        if "content" in values:
            content = values.pop("content")
            values["text"] = _text(content)
            if "impacts" in content and values.get("what") != "case":
                whole = self._worn
        process = {None: self._live, 1: whole}.get(values.get("grids"), self._finer)
        return process.ask(kind=name, **values)

    async def _take(self, request: Request) -> Response:
        error = "no file was written"
        async for line in await self._ask("take", request):
            answer = json.loads(line)
            if "file" in answer:
                file = self._session.room / answer["file"]
                tidy = BackgroundTask(shutil.rmtree, file.parent, ignore_errors=True)
                return FileResponse(file, filename=file.name, background=tidy)
            problems = (f"{key}: {words}" for key, words in answer.get("problems", {}).items())
            error = answer.get("error") or next(problems, error)
        return JSONResponse({"error": error})

    async def _upload(self, request: Request) -> Response:
        """Store the scan that the user has given to the page, if it can be read."""
        given = unquote(request.headers.get("x-file-name", ""))
        name = self._session.free_name(given)
        file = self._session.scans / name
        try:
            await _store(request, file)
        except BaseException:
            file.unlink(missing_ok=True)
            raise
        if (same := self._session.stored(given, file)) is not None:
            file.unlink()
            name, file = same.name, same
        scan: dict[str, Any] = {}
        async for line in self._live.ask(request.headers.get("x-tab", ""), "read", file=name):
            scan.update(json.loads(line))
        if "nodes" not in scan and not {"needs_size", "needs_height_unit"} & scan.keys():
            file.unlink(missing_ok=True)
        return JSONResponse({"name": name, **scan})


class OwnHostOnly:
    """Refuse requests whose Host is not this machine, and requests from pages of other sites."""

    def __init__(self, app: ASGIApp, port: int) -> None:
        # The Host headers that a browser on this machine sends.
        self._app, self._hosts = app, (f"127.0.0.1:{port}", f"localhost:{port}")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on a request if `_refused` finds no objection, and add headers to the response."""
        app = self._app
        if scope["type"] == "http" and (why := self._refused(dict(scope["headers"]))):
            app = JSONResponse({"error": why}, 403)

        async def with_headers(message: Any) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(_HEADERS)
            await send(message)

        await app(scope, receive, with_headers)

    def _refused(self, headers: dict[bytes, bytes]) -> str:
        host, origin = (headers.get(name, b"").decode("latin-1") for name in (b"host", b"origin"))
        if host not in self._hosts:
            return "this server answers only requests from this machine"
        if origin and origin not in [f"http://{name}" for name in self._hosts]:
            return "this server answers only requests from its own page"
        return ""


def _streamed(request: Request, lines: AsyncGenerator[str]) -> Response:
    """Send each line of JSON as soon as it is available, until the page closes the connection."""

    async def body() -> AsyncIterator[str]:
        gone = asyncio.ensure_future(_gone(request))
        line: asyncio.Future[str | None] = asyncio.Future()
        try:
            while True:
                line = asyncio.ensure_future(anext(lines, None))
                await asyncio.wait({line, gone}, return_when=asyncio.FIRST_COMPLETED)
                if not line.done() or (text := line.result()) is None:
                    return
                yield text + "\n"
        finally:
            line.cancel()  # cancels the request, unless it is already answered
            gone.cancel()

    return StreamingResponse(body(), media_type="application/x-ndjson")


async def _gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def _values(request: Request, kinds: dict[str, type]) -> dict[str, Any]:
    body = b""
    async for part in request.stream():
        body += part
        if len(body) > _LARGEST_BODY:
            raise HTTPException(413, f"a request may have at most {_LARGEST_BODY} bytes")
    try:
        content = json.loads(body)
    except (ValueError, RecursionError):
        raise HTTPException(400, "the content is not JSON") from None
    if not isinstance(content, dict) or set(content) != set(kinds):
        raise HTTPException(400, f"the content must be an object with the keys {', '.join(kinds)}")
    for name, kind in kinds.items():
        if type(content[name]) is not kind:
            raise HTTPException(400, f"{name} must be a {kind.__name__}")
    return content


def _text(content: dict[str, Any]) -> str:
    try:
        return text_of(content)
    except (CaseError, RecursionError) as error:
        raise HTTPException(400, str(error)) from None


async def _store(request: Request, file: Any) -> None:
    size = 0
    try:
        with file.open("xb") as out:
            async for part in request.stream():
                size += len(part)
                if size > LARGEST_SCAN:
                    raise HTTPException(
                        413, f"a scan may have at most {LARGEST_SCAN >> 20} MiB here; crop it"
                    )
                await asyncio.to_thread(out.write, part)
    except ClientDisconnect:
        raise HTTPException(400, "the upload is incomplete; drop the file again") from None


@cache
def _static_files() -> frozenset[str]:
    names = (file.name for file in (files("restitution.app") / "static").iterdir())
    return frozenset(name for name in names if PurePath(name).suffix in _TYPES)


@cache
def _file(name: str) -> str:
    return (files("restitution.app") / "static" / name).read_text("utf-8")
