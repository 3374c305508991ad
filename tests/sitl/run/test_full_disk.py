"""A disk that takes no more: the programs end with a line that names the file, and the boat sails on.

The system's limit on a file's size stands for the disk: beyond it a real write is refused.
"""

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
import pytest
from boat_rig import Rig, waypoint

from companion.log.logbook import Logbook
from companion.log.sink import InlineWorker, SingleFile
from sitl.cli.program import run_program
from sitl.experiments.campaign.campaign import load_campaign

pytestmark = pytest.mark.slow

FULL = Path("/dev/full")
needs_full = pytest.mark.skipif(not FULL.exists(), reason="no /dev/full on this system")
CAMPAIGN = '[run]\nscenario = "open"\ncourse = "straight"\ntimeout_s = 8.0\n'


@contextmanager
def room_for(size_bytes: int) -> Iterator[None]:
    """No file grows larger."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("option", ["--csv a.csv", "--record a.npz"])
def test_what_a_run_cannot_write_is_one_line_and_no_torn_file(
    option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with room_for(100):
        code = run_program(["sail", "open", "--course", "straight", "--timeout", "8", *option.split()])
    said = capsys.readouterr().err.splitlines()
    name = option.split()[1]
    assert code == 1
    assert [line for line in said if "cannot be written" in line] == [
        f"boat-sitl: {name}: cannot be written: File too large: name another place"
    ]
    assert list(tmp_path.iterdir()) == []


def test_a_campaign_that_cannot_go_on_writing_says_where_and_goes_on_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    arguments = ["campaign", "c.toml", "--out", "out", "--workers", "1"]
    with room_for(60):  # less than the campaign's own description
        assert run_program(arguments) == 1
    assert "out/campaign.json: cannot be written: File too large" in capsys.readouterr().err
    with room_for(len(msgspec.json.encode(load_campaign(Path("c.toml"))))):  # that, but not the runs
        assert run_program(arguments) == 1
    assert "out/runs.jsonl: cannot be written: File too large" in capsys.readouterr().err
    assert not (tmp_path / "out" / "report.html").exists()
    assert run_program(arguments) == 0
    assert (tmp_path / "out" / "report.html").stat().st_size > 1500


@needs_full
def test_a_boat_whose_log_meets_a_full_disk_sails_on_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig()
    logbook = Logbook(SingleFile(FULL), None, InlineWorker())
    monkeypatch.setattr(rig, "_build", lambda: _with(rig, logbook))
    rig.reboot()
    rig.sail(waypoint(200.0, 0.0))
    rig.run(20.0)
    assert rig.boat.net.faults == 0
    assert rig.boat.vehicle.armed
    assert rig.mode == "AUTO"
    told = [text for text in rig.peer.texts if text.startswith("Log stopped")]
    assert told == [
        "Log stopped: /dev/full: cannot be written: No space left on device: make room, or name another place"
    ]
    rig.boat.close()
    rig.boat.close()


def _with(rig: Rig, logbook: Logbook) -> object:
    from companion.boat import Boat  # noqa: PLC0415

    return Boat(rig.config, rig.hardware, [rig.port], rig.storage, logbook=logbook)
