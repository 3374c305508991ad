"""A disk that takes no more: the programs end with a line that names the file, and the boat sails on.

The system's limit on a file's size stands for the disk: beyond it a real write is refused.
"""

import resource
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from pathlib import Path

import msgspec
import pytest

from sitl.cli.program import run_program
from sitl.experiments.campaign.campaign import load_campaign
from sitl.experiments.runner import TrialPool

pytestmark = pytest.mark.slow

CAMPAIGN = '[run]\nscenario = "open"\ncourse = "straight"\ntimeout_s = 8.0\n'


@contextmanager
def room_for(size_bytes: int) -> Iterator[None]:
    """No file grows larger. Of what is imported meanwhile no bytecode is written, which would be cut off."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        sys.dont_write_bytecode = before


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
    pool = TrialPool(ThreadPoolExecutor(1), 1)
    monkeypatch.setattr("sitl.cli.campaign.local_pool", lambda _: nullcontext(pool))
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    arguments = ["campaign", "c.toml", "--out", "out"]
    with room_for(60):  # less than the campaign's own description
        assert run_program(arguments) == 1
    assert "out/campaign.json: cannot be written: File too large" in capsys.readouterr().err
    with room_for(len(msgspec.json.encode(load_campaign(Path("c.toml"))))):  # that, but not the runs
        assert run_program(arguments) == 1
    assert "out/runs.jsonl: cannot be written: File too large" in capsys.readouterr().err
    assert not (tmp_path / "out" / "report.html").exists()
    assert run_program(arguments) == 0
    assert (tmp_path / "out" / "report.html").stat().st_size > 1500
