"""The status file of the running boat: what the operator is told when it cannot be written."""

from pathlib import Path

import pytest
from boat_rig import Rig

from companion.app.status_file import StatusFile, read_status
from companion.core.status_text import Severity, StatusText
from companion.core.tick_count import TickCount


class Written:
    """A status file whose writes are waited for."""

    def __init__(self, path: Path) -> None:
        self._boat = Rig().boat
        self.file = StatusFile(path, self._boat)
        self.texts: list[StatusText] = []
        self.now_s = 0.0

    def tick(self) -> None:
        """The next write, once it has ended."""
        self.file.tick(self.now_s, TickCount(), 0.1)
        assert self.file._writing is not None
        self.file._writing.exception(timeout=60.0)
        self.now_s += 1.0
        self.texts += self._boat.vehicle.take_status_texts()


def test_a_write_that_fails_is_told_once_and_again_after_one_that_did_not(tmp_path: Path) -> None:
    path = tmp_path / "run" / "status.json"
    written = Written(path)
    for _ in range(3):
        written.tick()
    assert written.texts == [
        (Severity.WARNING, f"Status file {path} cannot be written: No such file or directory")
    ]
    path.parent.mkdir()
    written.tick()
    written.tick()
    assert read_status(path).load == pytest.approx(0.1)
    path.unlink()
    path.parent.rmdir()
    written.tick()
    written.tick()
    assert len(written.texts) == 2
    written.file.close()
