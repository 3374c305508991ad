"""The web server of the shore page: its routes and limits, and one task that polls the boats."""

import asyncio
from collections.abc import AsyncIterator, Collection
from functools import partial
from pathlib import Path
from typing import Final

from aiohttp import web

from companion.links.readable import readable
from mission_tools.shore.chart import WaterChart
from mission_tools.shore.clock import Clock
from mission_tools.shore.plans.plan_service import Sources
from mission_tools.shore.web.api import add_routes
from mission_tools.shore.web.connections.rates import Rate, Rates
from mission_tools.shore.web.connections.throttle import network_of
from mission_tools.shore.web.guard import add_headers, make_guard, peer_of
from mission_tools.shore.web.hub import Hub
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.rows import MOST_BODY_BYTES
from mission_tools.shore.web.sockets import Sockets
from mission_tools.shore.web.static_files import StaticFile, read_files, respond
from mission_tools.station import words
from mission_tools.station.boats import Boats

POLL_S: Final = 0.05
_GATHER_S: Final = 0.001  # between two polls, however often the boats send
_NO_SOURCES: Final = Sources()
# Requests: a page's first view has some fifty files. All strangers together cost 3 % of a core of a laptop
_OFTEN: Final = Rate(burst=400, per_s=50.0)
_STRANGERS: Final = Rate(burst=600, per_s=100.0)
HUB: Final = web.AppKey("hub", Hub)
SOCKETS: Final = web.AppKey("sockets", Sockets)
POLLING: Final = web.AppKey("polling", asyncio.Task[None])


def make_app(
    boats: Boats,
    chart: WaterChart,
    sessions: Sessions,
    page_dir: Path,
    clock: Clock,
    *,
    sources: Sources = _NO_SOURCES,
    hosts: Collection[str] = (),
    is_polling: bool = True,
) -> web.Application:
    """The application.

    sources: of plans. hosts: further names of this server. is_polling: False where a test calls `Hub.tick`.
    """
    rates = Rates(_OFTEN, _STRANGERS)

    def is_allowed(request: web.Request) -> bool:
        address = peer_of(request)
        return rates.allows(network_of(address), clock.now_s(), is_known=sessions.is_known(address))

    app = web.Application(middlewares=[make_guard(hosts, is_allowed)], client_max_size=MOST_BODY_BYTES)
    hub = app[HUB] = Hub(boats, chart, sessions, clock, sources)
    sockets = app[SOCKETS] = Sockets(hub)
    add_routes(app, hub)
    app.router.add_get("/live", sockets.handle)
    for name, file in read_files(words.FOLDER, page_dir).items():
        app.router.add_get(f"/{name}", partial(_send, file=file))
    app.on_response_prepare.append(add_headers)

    async def on_shutdown(_app: web.Application) -> None:
        hub.plans.close()
        hub.charts.close()
        hub.logs.voyages.close()
        await sockets.close()

    app.on_shutdown.append(on_shutdown)
    if is_polling:
        app.cleanup_ctx.append(_polling)
    return app


async def _send(request: web.Request, *, file: StaticFile) -> web.StreamResponse:
    return respond(request, file)


async def _polling(app: web.Application) -> AsyncIterator[None]:
    task = app[POLLING] = asyncio.create_task(_poll(app[HUB], app[SOCKETS]))
    yield
    task.cancel()
    await asyncio.gather(task, return_exceptions=True)  # `serve` has raised what ended it


async def _poll(hub: Hub, sockets: Sockets) -> None:
    while True:
        hub.tick()
        sockets.drop_lost(hub.clock.now_s())
        if hub.boats.is_transferring:  # each item is asked for as soon as the one before has come
            await asyncio.sleep(_GATHER_S)
            await readable(hub.boats.filenos(), POLL_S)
        else:
            await asyncio.sleep(POLL_S)
