"""The checks of every request (the Host it names, the Origin it comes from) and the headers of responses."""

import ipaddress
import logging
import re
import socket
from collections.abc import Awaitable, Callable, Collection
from typing import Final

from aiohttp import web
from aiohttp.typedefs import Middleware

from mission_tools.station.words import LocalizedText, say

_log: Final = logging.getLogger(__name__)
_HOST: Final = re.compile(r"(\[[0-9A-Fa-f:.]{2,45}\]|[A-Za-z0-9._-]{1,253})(?::[0-9]{1,5})?")
_COOKIE: Final = "mavboat-shore"
_HEADERS: Final = {
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "Server": "boat-shore",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
_POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; manifest-src 'self'; "
    "connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)  # ws: Safari before 15.4 does not count a WebSocket to the same host as 'self'

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


def error(status: int, text: str, expected: str, headers: dict[str, str] | None = None) -> web.Response:
    """An error in words. What is `LocalizedText` the page can say in its own language, by its key."""
    body: dict[str, object] = {"error": text, "expected": expected}
    if isinstance(text, LocalizedText):
        body |= {"key": text.key, "values": text.values}
    if isinstance(expected, LocalizedText):
        body["expects"] = expected.to_page()
    return web.json_response(body, status=status, headers=headers)


def peer_of(request: web.Request) -> str:
    """The other end's address; what a proxy claims is not read."""
    return request.remote or ""


def cookie_name(request: web.Request) -> str:
    """By port: cookies of two pages on one computer are not told apart by it."""
    return f"{_COOKIE}-{request.url.port}"


def cookie_of(request: web.Request) -> str | None:
    """The session's token in a request's cookie; empty without one."""
    return request.cookies.get(cookie_name(request))


def is_own_host(host: str, names: Collection[str]) -> bool:
    """Whether a Host header names this server: a literal address, localhost or one of `names`.

    Any other name may belong to a page elsewhere, whose owner lets it point here (DNS rebinding).
    """
    match = _HOST.fullmatch(host)
    if match is None:
        return False
    name = match[1].lower()
    try:
        ipaddress.ip_address(name.strip("[]"))
    except ValueError:
        return name == "localhost" or name.endswith(".localhost") or name in names
    return True


def own_names(further: Collection[str]) -> frozenset[str]:
    """The names of this computer: by mDNS (NAME.local), and further ones."""
    here = f"{socket.gethostname().partition('.')[0]}.local"
    return frozenset(name.lower() for name in (here, *further))


def is_own_origin(request: web.Request) -> bool:
    """Whether a page of this server asks."""
    return (
        request.headers.getall("Origin", []) == [f"{request.scheme}://{request.host}"]
        and request.headers.get("Sec-Fetch-Site", "same-origin") == "same-origin"
    )


async def add_headers(request: web.Request, response: web.StreamResponse) -> None:
    """Add the security headers that every response has."""
    response.headers.update(_HEADERS)
    response.headers.setdefault("Cache-Control", "no-store")
    host = request.host if _HOST.fullmatch(request.host) else ""
    policy = _POLICY.format(host=host).replace(" ws://;", ";")
    response.headers.setdefault("Content-Security-Policy", policy)  # a document of its own has its own


def make_guard(names: Collection[str], is_allowed: Callable[[web.Request], bool]) -> Middleware:
    """The middleware. names: further ones of this server. is_allowed: False if its address asks too often."""
    own = own_names(names)

    @web.middleware
    async def guard(request: web.Request, handler: Handler) -> web.StreamResponse:
        if not is_allowed(request):
            refusal = error(429, say("error.too_fast"), say("error.too_fast.expected"), {"Retry-After": "1"})
            refusal.force_close()
            return refusal
        if len(request.headers.getall("Host", [])) != 1 or not is_own_host(request.host, own):
            return error(
                421,
                say("error.name"),
                say("error.name.expected"),
            )
        is_write = request.method not in ("GET", "HEAD")
        if (is_write or "Upgrade" in request.headers) and not is_own_origin(request):
            return error(403, say("error.origin"), say("error.origin.expected"))
        try:
            return await handler(request)
        except web.HTTPRequestEntityTooLarge as refused:
            return error(413, say("error.large"), refused.text or "")
        except web.HTTPException as refused:
            allow = {"Allow": refused.headers["Allow"]} if "Allow" in refused.headers else None
            text = say("error.http", n=refused.status, reason=refused.reason)
            return error(refused.status, text, "", allow)
        except ConnectionError:  # the page has left
            raise
        except Exception:
            _log.exception("%s %.100r has failed", request.method, request.path)
            return error(500, say("error.server"), "")

    return guard
