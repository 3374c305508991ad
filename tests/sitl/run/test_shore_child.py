"""The shore page as a child process: a stub stands for its program and writes down what it is told."""

import os
import queue
import signal
import sys
import tempfile
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from boat_rig import scenario
from patience import MOMENT_S

from sitl.run.shore import ShorePage

STUB = """
import os, signal, sys
from pathlib import Path
log, *told = sys.argv[1:]
if told[0] == "pin":
    Path(told[2]).write_text(sys.stdin.read())
    sys.exit({pin_code})
Path(log).write_text("\\n".join([str(os.getpid()), *told]))
print("ready", flush=True)
print("listening at https://127.0.0.1:8123/x now", flush=True)
{end}
"""
OPEN, LAKE = scenario("open").chart, scenario("lake").chart

Start = Callable[..., ShorePage]


@pytest.fixture
def lines() -> "queue.Queue[str]":
    return queue.Queue()


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lines: "queue.Queue[str]") -> Start:
    """Starts a page whose program ends like this."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(
        "sitl.run.shore._PROGRAM", (sys.executable, str(tmp_path / "stub.py"), str(tmp_path / "log"))
    )

    def begin(end: str = "signal.pause()", pin_code: int = 0, **options: object) -> ShorePage:
        (tmp_path / "stub.py").write_text(STUB.format(end=end, pin_code=pin_code))
        made: dict[str, object] = {"chart": OPEN, "listen": "127.0.0.1:0", "report": lines.put, **options}
        page = ShorePage(**made)  # type: ignore[arg-type]
        page.start(page.status)
        return page

    return begin


def told(tmp_path: Path) -> tuple[int, dict[str, str]]:
    """The child's number, and its options."""
    process, *words = (tmp_path / "log").read_text().splitlines()
    return int(process), dict(zip(words[::2], words[1::2], strict=True))


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True


def test_the_child_is_told_all_it_needs_and_ends_with_the_page(
    start: Start, tmp_path: Path, lines: "queue.Queue[str]"
) -> None:
    boat = tmp_path / "boat.toml"
    with closing(
        start(chart=LAKE, listen="127.0.0.1:8124", boat=boat, options=("--host", "pond.lan"))
    ) as page:
        said, folder = lines.get(timeout=MOMENT_S), page.status.parent
        pin = (folder / "pin").read_text().strip()
        assert said == f"the page is at https://127.0.0.1:8123/x with PIN {pin}"
        assert len(pin) == 8
        assert pin.isdecimal()
        process, options = told(tmp_path)
        assert options == {
            "--connect": page.boat_link.replace("udpout", "udpin"),
            "--listen": "127.0.0.1:8124",
            "--pin-file": str(folder / "pin"),
            "--status": str(folder / "status.json"),
            "--boat": str(boat),
            "--map": str(folder / "map.geojson"),
            "--host": "pond.lan",
        }
        assert "Mill Pond" in (folder / "map.geojson").read_text()
        assert is_alive(process)
    page.close()
    assert not is_alive(process)
    assert not folder.exists()
    assert lines.empty(), "it was asked to end"


@pytest.mark.parametrize(("code", "is_said"), [(3, True), (0, False), (130, False)])
def test_a_child_that_ends_by_itself_is_told_unless_it_was_asked_to(
    start: Start, lines: "queue.Queue[str]", code: int, is_said: bool
) -> None:
    page = start(f"sys.exit({code})")
    assert "the page is at" in lines.get(timeout=MOMENT_S)
    assert page._reader is not None
    page._reader.join(MOMENT_S)
    page.close()
    said = [lines.get_nowait() for _ in range(lines.qsize())]
    assert said == [f"the page's program ended with {code}; the boat does not need it"] * is_said


def test_a_program_that_cannot_store_its_pin_is_not_started(
    start: Start, tmp_path: Path, lines: "queue.Queue[str]"
) -> None:
    start(pin_code=1).close()
    assert lines.get_nowait() == "there is no page; the boat does not need it"
    assert not (tmp_path / "log").exists()


def test_a_page_stays_when_the_boat_begins_anew(
    start: Start, tmp_path: Path, lines: "queue.Queue[str]"
) -> None:
    with closing(start()) as page:
        pin = lines.get(timeout=MOMENT_S).rsplit(" ", 1)[1]
        process, options = told(tmp_path)
        assert set(options) == {"--connect", "--listen", "--pin-file", "--status"}, "open water has no map"
        page.start(page.status)
        assert lines.get(timeout=MOMENT_S) == f"the page is still at https://127.0.0.1:8123/x with PIN {pin}"
        assert told(tmp_path)[0] == process
        assert is_alive(process)


def test_a_page_that_has_ended_is_started_with_the_boat_that_begins_anew(
    start: Start, tmp_path: Path, lines: "queue.Queue[str]"
) -> None:
    with closing(start()) as page:
        lines.get(timeout=MOMENT_S)
        process, _ = told(tmp_path)
        os.kill(process, signal.SIGKILL)
        assert "ended with" in lines.get(timeout=MOMENT_S)
        page.start(page.status)
        assert "the page is at" in lines.get(timeout=MOMENT_S)
        assert told(tmp_path)[0] != process
