"""What the shore page costs: processor time and memory of boat-shore beside an emulated boat.

    python -m benchmarks.shore_page 60

Starts `boat-sitl serve open` and `boat-shore`, lets three viewers read the states of one boat for so many
seconds, and prints the program's share of a core, its memory and the states each viewer got a second.
"""

import asyncio
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from aiohttp import ClientSession

from benchmarks.measure import Row, alone
from benchmarks.served_boat import served_boat

VIEWERS = 3
_SECONDS = 20.0  # of `make bench`
_TICKS_PER_S = os.sysconf("SC_CLK_TCK")


class Cost(NamedTuple):
    """share: of a core; states_per_s: of one viewer."""

    share: float
    resident_mb: float
    peak_mb: float
    states_per_s: float
    bytes_per_s: float


def rows() -> list[Row]:
    """The cost with three viewers."""
    cost = measure(_SECONDS)
    with_viewers = f"with {VIEWERS} viewers"
    return [
        alone(f"share of a core, {with_viewers}", "%", "less", [100.0 * cost.share]),
        alone(f"resident memory, {with_viewers}", "MB", "less", [cost.resident_mb]),
        alone("states that a viewer gets", "1/s", "more", [cost.states_per_s]),
    ]


def measure(seconds: float) -> Cost:
    """Run both programs and the viewers."""
    with served_boat() as (_, port):
        return asyncio.run(_measure(port, seconds))


async def _measure(port: int, seconds: float) -> Cost:
    with tempfile.TemporaryDirectory() as folder:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "companion.shore", "--connect", f"tcp:127.0.0.1:{port}"),
            *("--listen", "127.0.0.1:0", "--pin-file", str(Path(folder) / "pin")),
            stdout=asyncio.subprocess.PIPE,
        )
        try:
            assert process.stdout is not None
            origin = (await process.stdout.readline()).decode().split()[-1].rstrip("/")
            async with ClientSession(headers={"Origin": origin}) as session:
                await _read(session, origin, 5.0)  # until the boat's lists and parameters are there
                before_s, start_s = processor_s(process.pid), time.monotonic()
                told = await asyncio.gather(*(_read(session, origin, seconds) for _ in range(VIEWERS)))
                took_s = time.monotonic() - start_s
                share = (processor_s(process.pid) - before_s) / took_s
                resident_mb, peak_mb = (status_mb(process.pid, name) for name in ("VmRSS", "VmHWM"))
        finally:
            process.terminate()
            await process.wait()
    states, size = (sum(one[n] for one in told) / VIEWERS / took_s for n in (0, 1))
    return Cost(share, resident_mb, peak_mb, states, size)


async def _read(session: ClientSession, origin: str, seconds: float) -> tuple[int, int]:
    """One viewer: how many states it got, and bytes."""
    states = size = 0
    async with session.ws_connect(f"{origin}/live") as ws:
        end_s = time.monotonic() + seconds
        while time.monotonic() < end_s:
            text = await ws.receive_str()
            states += '"type":"state"' in text
            size += len(text)
    return states, size


def processor_s(process: int) -> float:
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS_PER_S


def status_mb(process: int, name: str) -> float:
    lines = Path(f"/proc/{process}/status").read_text(encoding="ascii").splitlines()
    (line,) = [one for one in lines if one.startswith(f"{name}:")]
    return int(line.split()[1]) * 1024 / 1e6


def main(seconds: float) -> None:
    """Print the cost."""
    cost = measure(seconds)
    size = cost.bytes_per_s / max(cost.states_per_s, 0.1)
    sys.stdout.write(
        f"{VIEWERS} viewers, {seconds:g} s: {100.0 * cost.share:.1f} % of a core, "
        f"{cost.resident_mb:.0f} MB resident (at most {cost.peak_mb:.0f} MB), "
        f"{cost.states_per_s:.1f} states/s of {size:.0f} bytes a viewer\n"
    )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0)
