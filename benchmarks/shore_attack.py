"""Does the boat keep its time while its page is attacked?

    python -m benchmarks.shore_attack 60 1

Each round serves an emulated boat three times for so many seconds in real time, as `boat-sitl serve lake
--shore` does: without the page, with three viewers, and with these and `benchmarks.shore_attackers`. One
viewer is a skipper who asks something every half a second. Attackers and viewers share this machine with the
boat; the attackers have the page's low priority. Printed are the boat's late (5 ms) and skipped ticks, the
worst lateness since its start, its load, and the page's processor time, memory and times to answer.
"""

import asyncio
import contextlib
import json
import os
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, NamedTuple

from aiohttp import ClientError, ClientSession, ClientWebSocketResponse

from benchmarks.measure import Row, alone
from benchmarks.shore_page import VIEWERS, processor_s, status_mb
from companion.app.status_file import BoatStatus, read_status

Case = Literal["no page", "viewers", "attack"]
CASES: tuple[Case, ...] = ("no page", "viewers", "attack")
_SETTLE_S = 8.0  # the boat's start is no part of it
_SECONDS = 20.0  # of `make bench`
_ASK_S = 0.5


class Result(NamedTuple):
    """Of one case. Shares of the ticks and of a core; answers_s: of the skipper, None: not within 20 s."""

    case: Case
    late: float
    skipped: int
    worst_s: float
    load: float
    machine: float  # load average of the last minute
    share: float = 0.0
    resident_mb: float = 0.0
    peak_mb: float = 0.0
    answers_s: tuple[float, ...] = ()
    unanswered: int = 0
    states_per_s: float = 0.0
    struck: str = ""

    @property
    def p95_s(self) -> float:
        """Of the skipper's questions."""
        return statistics.quantiles(self.answers_s, n=20)[-1] if len(self.answers_s) > 1 else float("nan")


def rows() -> list[Row]:
    """Late ticks of the three cases, and what the page does when attacked."""
    results = {case: run_case(case, _SECONDS) for case in CASES}
    attacked = results["attack"]
    note = f"{attacked.skipped} skipped, worst {1e3 * attacked.worst_s:.1f} ms"
    late = [
        alone(f"late ticks of the boat, {case}", "%", "less", [100.0 * one.late])
        for case, one in results.items()
    ]
    return [
        *late,
        alone("share of a core, attacked", "%", "less", [100.0 * attacked.share], note),
        alone("memory at most, attacked", "MB", "less", [attacked.peak_mb]),
        alone("a skipper's answers, 95 %, attacked", "s", "less", [attacked.p95_s]),
    ]


def run_case(case: Case, seconds: float) -> Result:
    """A boat, and the page, its viewers and its attackers where the case has them."""
    with tempfile.TemporaryDirectory() as folder, _served(Path(folder), has_page=case != "no page") as served:
        time.sleep(_SETTLE_S)
        before = _settled(served.status)
        page = asyncio.run(_use(served, seconds, case)) if served.origin else None
        if page is None:
            time.sleep(seconds)
        after = _settled(served.status)
    ticks = after.ticks - before.ticks
    result = Result(
        case,
        (after.late_ticks - before.late_ticks) / ticks,
        after.skipped_ticks - before.skipped_ticks,
        after.worst_late_s,
        after.load,
        os.getloadavg()[0],
    )
    return result if page is None else result._replace(**page)


class _Served(NamedTuple):
    process: int
    status: Path
    origin: str = ""
    pin: str = ""


@contextlib.contextmanager
def _served(folder: Path, *, has_page: bool) -> Iterator[_Served]:
    status = folder / "status.json"
    program = [str(Path(sys.executable).with_name("boat-sitl")), "serve", "lake", "--tcp", "0", "--no-udp"]
    page = ["--shore", "--shore-at", "127.0.0.1:0"] if has_page else []
    process = subprocess.Popen(
        [*program, "--status", str(status), *page], stdout=subprocess.PIPE, text=True, cwd=folder
    )
    try:
        assert process.stdout is not None
        awaited = re.compile(r"the page is at (\S+) with PIN (\d+)" if has_page else "ready")
        found = next(match for line in process.stdout if (match := awaited.search(line)))
        yield _Served(process.pid, status, *found.groups())
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)


def _settled(path: Path) -> BoatStatus:
    """The next status: the file is written once a second."""
    end_s, first = time.monotonic() + 10.0, None
    while time.monotonic() < end_s:
        if path.exists():
            status = read_status(path)
            first = first or status
            if status.ticks > first.ticks:
                return status
        time.sleep(0.05)
    raise AssertionError(f"{path}: the boat writes no status")


async def _use(served: _Served, seconds: float, case: Case) -> dict[str, Any]:
    """The viewers, the skipper and the attackers; what the page took."""
    child = int(_children(served.process)[0])
    origin = served.origin.rstrip("/")
    async with ClientSession(headers={"Origin": origin}, timeout=None) as session:
        async with session.post(f"{origin}/api/session", json={"pin": served.pin}) as told:
            assert told.status == 200, await told.text()
        before_s, start_s = processor_s(child), time.monotonic()
        attackers = None if case != "attack" else await _attackers(served, seconds)
        viewing = [asyncio.create_task(_view(session, origin, seconds)) for _ in range(VIEWERS - 1)]
        answers = await _ask(session, origin, seconds)
        states = [await one for one in viewing]
        share = (processor_s(child) - before_s) / (time.monotonic() - start_s)
        struck = "" if attackers is None else (await attackers.communicate())[0].decode().strip()
    heard = [one for one in answers if one is not None]
    return {
        "share": share,
        "resident_mb": status_mb(child, "VmRSS"),
        "peak_mb": status_mb(child, "VmHWM"),
        "answers_s": tuple(heard),
        "unanswered": len(answers) - len(heard),
        "states_per_s": sum(states) / len(states) / seconds,
        "struck": struck,
    }


def _children(process: int) -> list[str]:
    tasks = Path(f"/proc/{process}/task").iterdir()
    return [child for task in tasks for child in (task / "children").read_text("ascii").split()]


async def _attackers(served: _Served, seconds: float) -> asyncio.subprocess.Process:
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "benchmarks.shore_attackers", served.origin, served.pin, str(seconds)),
        stdout=asyncio.subprocess.PIPE,
    )


async def _view(session: ClientSession, origin: str, seconds: float) -> int:
    """A viewer that comes back when it loses its socket: how many states it got."""
    states, end_s = 0, time.monotonic() + seconds
    while time.monotonic() < end_s:
        with contextlib.suppress(ClientError, TimeoutError, TypeError):  # TypeError: it was closed
            async with session.ws_connect(f"{origin}/live?boat=1") as ws:
                while time.monotonic() < end_s:
                    states += '"type":"state"' in await ws.receive_str(timeout=5.0)
    return states


async def _ask(session: ClientSession, origin: str, seconds: float) -> list[float | None]:
    """A skipper's questions to the boat: how long each took to be answered."""
    took: list[float | None] = []
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        with contextlib.suppress(ClientError, TimeoutError, TypeError):
            async with session.ws_connect(f"{origin}/live?boat=1") as ws:
                while time.monotonic() < end_s:
                    took.append(await _answer(ws, f"skipper-{len(took)}"))
                    await asyncio.sleep(_ASK_S)
    return took


async def _answer(ws: ClientWebSocketResponse, ident: str) -> float | None:
    began_s = time.monotonic()
    await ws.send_json({"type": "do", "id": ident, "boat": 1, "what": "check", "with": {}})
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(20.0):
            while True:
                told = json.loads(await ws.receive_str())
                if told["type"] == "answer" and told["id"] == ident:
                    return time.monotonic() - began_s
    return None


def show(one: Result) -> str:
    """A line."""
    boat = (
        f"{one.case:8}: {100 * one.late:.2f} % of the ticks late, {one.skipped} skipped, worst "
        f"{1e3 * one.worst_s:.1f} ms, load {one.load:.0%}, machine {one.machine:.1f}"
    )
    if one.case == "no page":
        return boat
    median_s = statistics.median(one.answers_s or [float("nan")])
    return (
        f"{boat}; page {100 * one.share:.1f} % of a core, "
        f"{one.resident_mb:.0f} MB (at most {one.peak_mb:.0f}), "
        f"{len(one.answers_s)} answers in {1e3 * median_s:.0f} ms, 95 % in {1e3 * one.p95_s:.0f} ms, "
        f"{one.unanswered} without; {one.states_per_s:.1f} states/s {one.struck}"
    )


def main(seconds: float, rounds: int) -> None:
    """Print a line for each case of each round."""
    for _ in range(rounds):
        for case in CASES:
            sys.stdout.write(show(run_case(case, seconds)) + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    arguments = sys.argv[1:]
    main(float(arguments[0]) if arguments else 60.0, int(arguments[1]) if len(arguments) > 1 else 1)
