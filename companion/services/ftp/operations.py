"""Table of the file-transfer operations over the file tree."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from companion.mavlink.ftp_frames import DATA_BYTES, Code, Opcode, Refusal, Request, ack
from companion.services.ftp.sessions import MAX_UPLOADS_BYTES, FtpStation, Session, Stations, Upload
from companion.services.ftp.tree import FileTree, Place, Reading, checksum, page_of

Reply = bytes | None
"""A reply's payload; None where it comes later."""


Later = Callable[[FtpStation, Request, bool, Callable[[], Any], Callable[[Any], bytes]], Reply]
"""Runs work that may wait for a disk (the third argument) in the worker, other work at once, and makes the
reply of its result.
"""


@dataclass(eq=False)
class Operations:
    """Operations raise Refusal or OSError when refused. `begin_burst` sends its replies itself."""

    _tree: FileTree
    _stations: Stations
    _later: Later
    _release: Callable[[list[Session]], None]
    _begin_burst: Callable[[FtpStation, Request, Session], None]

    def __post_init__(self) -> None:
        change = self._change
        self._table: dict[int, Callable[[FtpStation, Request, float], Reply]] = {
            Opcode.NONE: lambda _, r, t: ack(r),
            Opcode.TERMINATE_SESSION: self._terminate,
            Opcode.RESET_SESSIONS: self._reset,
            Opcode.LIST_DIRECTORY: self._list,
            Opcode.OPEN_FILE_RO: self._open,
            Opcode.READ_FILE: self._read,
            Opcode.CREATE_FILE: lambda s, r, t: self._begin(s, r, t, keep=False),
            Opcode.WRITE_FILE: self._write,
            Opcode.REMOVE_FILE: lambda s, r, t: change(s, r, lambda at: at.mount.remove(at.names)),
            Opcode.CREATE_DIRECTORY: lambda s, r, t: change(s, r, lambda at: at.mount.make_folder(at.names)),
            Opcode.REMOVE_DIRECTORY: lambda s, r, t: change(
                s, r, lambda at: at.mount.remove_folder(at.names)
            ),
            Opcode.OPEN_FILE_WO: lambda s, r, t: self._begin(s, r, t, keep=True),
            Opcode.TRUNCATE_FILE: lambda s, r, t: change(
                s, r, lambda at: at.mount.truncate(at.names, r.offset)
            ),
            Opcode.RENAME: self._rename,
            Opcode.CALC_FILE_CRC32: self._checksum,
            Opcode.BURST_READ_FILE: self._burst,
        }

    def carry_out(self, station: FtpStation, request: Request, now_s: float) -> Reply:
        operation = self._table.get(request.opcode)
        if operation is None:
            raise Refusal(Code.UNKNOWN_COMMAND)
        if request.size > DATA_BYTES:
            raise Refusal(Code.INVALID_DATA_SIZE)
        return operation(station, request, now_s)

    def _place(self, path: bytes) -> Place:
        """Resolve a path below the root, which itself cannot be changed."""
        place = self._tree.find(path)
        if place is None:
            raise Refusal(Code.FILE_PROTECTED)
        return place

    def _list(self, station: FtpStation, request: Request, now_s: float) -> Reply:  # noqa: ARG002
        place = self._tree.find(request.data)
        if place is None:
            return ack(request, page_of(self._tree.root_entries(), request.offset))
        mount, names = place
        return self._later(
            station,
            request,
            mount.is_disk,
            lambda: page_of(mount.entries(names), request.offset),
            lambda page: ack(request, page),
        )

    def _open(self, station: FtpStation, request: Request, now_s: float) -> Reply:
        mount, names = self._place(request.data)

        def opened(reading: Reading) -> bytes:
            try:
                session = station.open(request.session, reading, mount.is_disk, now_s)
            except Refusal:
                reading.close()
                raise
            return ack(request, reading.size.to_bytes(4, "little"), session=session.number)

        return self._later(station, request, mount.is_disk, lambda: mount.open(names), opened)

    def _begin(self, station: FtpStation, request: Request, now_s: float, *, keep: bool) -> Reply:
        place = self._place(request.data)
        mount, names = place

        def begun(content: bytes) -> bytes:
            if self._stations.uploads_bytes() + len(content) > MAX_UPLOADS_BYTES:
                raise Refusal(Code.NO_SESSIONS_AVAILABLE)
            session = station.open(request.session, Upload(place, content), mount.is_disk, now_s)
            return ack(request, session=session.number)

        return self._later(station, request, mount.is_disk, lambda: mount.begin(names, keep), begun)

    def _read(self, station: FtpStation, request: Request, now_s: float) -> Reply:
        session = station.session(request.session, now_s)
        reading, offset, count = session.reading, request.offset, request.size or DATA_BYTES
        if reading.has(offset, count):
            return ack(request, _some(reading.read(offset, count)))

        def load() -> bytes:
            if session.burst is not None:
                return reading.fetch(offset, count)  # a gap after a burst, still cached
            reading.load(offset)
            return reading.read(offset, count)

        return self._later(station, request, session.on_disk, load, lambda data: ack(request, _some(data)))

    def _burst(self, station: FtpStation, request: Request, now_s: float) -> None:
        session = station.session(request.session, now_s)
        if session.upload is not None:
            raise Refusal(Code.FILE_PROTECTED)
        self._begin_burst(station, request, session)

    def _write(self, station: FtpStation, request: Request, now_s: float) -> bytes:
        upload = station.session(request.session, now_s).upload
        if upload is None:
            raise Refusal(Code.FILE_PROTECTED)
        growth = upload.growth(request.offset + len(request.data))
        if growth and self._stations.uploads_bytes() + growth > MAX_UPLOADS_BYTES:
            raise Refusal(Code.FAIL)
        upload.write(request.offset, request.data)
        return ack(request)

    def _terminate(self, station: FtpStation, request: Request, now_s: float) -> Reply:  # noqa: ARG002
        session = station.close(request.session)
        self._release([session])
        if (upload := session.upload) is None:
            return ack(request)
        return self._later(station, request, session.on_disk, upload.save, lambda _: ack(request))

    def _reset(self, station: FtpStation, request: Request, now_s: float) -> Reply:  # noqa: ARG002
        sessions = [station.close(number) for number in list(station.sessions)]
        self._release(sessions)
        uploads = [(s.on_disk, s.upload) for s in sessions if s.upload is not None]
        # An unwritten upload may be a repeated request: it replaces nothing
        for_disk = [upload for is_disk, upload in uploads if is_disk and upload.is_written]
        for is_disk, upload in uploads:
            if not is_disk and upload.is_written:
                upload.save()

        def save() -> None:
            for upload in for_disk:
                upload.save()

        return self._later(station, request, bool(for_disk), save, lambda _: ack(request))

    def _change(self, station: FtpStation, request: Request, change: Callable[[Place], None]) -> Reply:
        place = self._place(request.data)
        on_disk = place.mount.is_disk
        return self._later(station, request, on_disk, lambda: change(place), lambda _: ack(request))

    def _rename(self, station: FtpStation, request: Request, now_s: float) -> Reply:  # noqa: ARG002
        path, _, to_path = request.data.partition(b"\x00")
        place, to = self._place(path), self._place(to_path)
        if to.mount is not place.mount:
            raise Refusal(Code.FILE_PROTECTED)
        return self._change(
            station, request._replace(data=path), lambda at: at.mount.rename(at.names, to.names)
        )

    def _checksum(self, station: FtpStation, request: Request, now_s: float) -> Reply:  # noqa: ARG002
        mount, names = self._place(request.data)

        def work() -> int:
            reading = mount.open(names)
            try:
                return checksum(reading)
            finally:
                reading.close()

        return self._later(
            station, request, mount.is_disk, work, lambda crc: ack(request, crc.to_bytes(4, "little"))
        )


def _some(data: bytes) -> bytes:
    if not data:
        raise Refusal(Code.END_OF_FILE)
    return data
