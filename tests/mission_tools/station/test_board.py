"""The boat's computer: links and load from its status file, temperature and disk from the system."""

import os
from pathlib import Path

import msgspec

from companion.app.status_file import BoatStatus
from companion.router.status import LinksStatus, LinkStatus
from mission_tools.station.board import Board
from mission_tools.station.messages import LinkLoss


def status(load: float = 0.25) -> bytes:
    """A status file as the boat writes it."""
    link = LinkStatus(
        number=1, name="radio", address="serial:/dev/ttyUSB0", bytes_in=1, bytes_out=1, frames_in=90,
        frames_out=1, forwarded=0, unknown=0, bad=0, lost=10, dropped=0, withheld=0, refused=0,
        waiting_bytes=0, in_bytes_s=0.0, out_bytes_s=0.0, heard=("255/190",),
    )  # fmt: skip
    links = LinksStatus(time_s=1.0, links=(link,), repeats=0, echoes=0, unreachable=0, reboots=0)
    return msgspec.json.encode(
        BoatStatus(
            process=1, load=load, ticks=1, late_ticks=0, skipped_ticks=0, worst_late_s=0.0, links=links
        )
    )


def test_links_load_temperature_and_disk(tmp_path: Path) -> None:
    file, thermal = tmp_path / "status.json", tmp_path / "temp"
    file.write_bytes(status())
    thermal.write_text("48312\n")
    board = Board(file, thermal, tmp_path)
    board.poll(0.0)
    fields = board.fields()
    assert fields["links"] == [LinkLoss(name="radio", heard=["255/190"], loss=0.1)]
    assert fields["load"] == 0.25
    assert fields["temperature_c"] == 48.3
    assert fields["disk_free_mb"] > 0


def test_a_file_that_is_no_longer_written_is_not_known(tmp_path: Path) -> None:
    file = tmp_path / "status.json"
    file.write_bytes(status())
    board = Board(file, tmp_path / "none", tmp_path)
    for second in range(6):
        board.poll(float(second))
    assert "load" in board.fields()
    board.poll(5.9)  # it is read once a second
    assert "load" in board.fields()
    board.poll(6.0)
    assert board.fields().keys() == {"disk_free_mb"}
    os.utime(file, ns=(1, 1))
    board.poll(7.0)
    assert "load" in board.fields()


def test_a_file_that_is_missing_or_broken_is_not_known(tmp_path: Path) -> None:
    file = tmp_path / "status.json"
    board = Board(file, tmp_path / "none", tmp_path)
    board.poll(0.0)
    assert board.fields().keys() == {"disk_free_mb"}
    file.write_bytes(b'{"load": "much"}')
    board.poll(2.0)
    assert board.fields().keys() == {"disk_free_mb"}
