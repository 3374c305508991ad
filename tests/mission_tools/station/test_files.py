"""Files of a real boat through the whole station, and frames compared with pymavlink's."""

import pytest
from boat_rig import Rig
from shore_rig import Shore

from mission_tools.station.ftp.jobs import Entry, FtpFailure


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_the_parameter_file_of_a_boat_comes_whole(loss: float) -> None:
    shore = Shore(Rig(), loss=loss, seed=4)
    shore.until(lambda: bool(shore.boats.names()), 10.0)
    found: list[bytes | FtpFailure] = []
    shore.boat().files.read_whole("@PARAM/param.pck", found.append)
    shore.until(lambda: bool(found), 60.0)
    (content,) = found
    assert isinstance(content, bytes)
    entries: list[list[Entry] | FtpFailure] = []
    shore.boat().files.list_folder("@PARAM", entries.append)
    shore.until(lambda: bool(entries), 60.0)
    assert entries == [[Entry("param.pck", len(content))]]


def test_a_boat_without_storage_has_no_logs() -> None:
    shore = Shore(Rig())
    shore.until(lambda: bool(shore.boats.names()), 10.0)
    logs = shore.boat().logs
    logs.request()
    shore.until(lambda: logs.failure is not None, 20.0)
    assert (logs.logs, getattr(logs.failure, "key", "")) == (None, "log.none")
