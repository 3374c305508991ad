"""What the server asks of the rest of the shore page."""

from collections.abc import Callable, Sequence
from typing import Any, Literal, Protocol

from companion.mavlink.items import MissionItem
from mission_tools.station.messages import Answer, BoatName, LogFile, PageRequest, Place, Sensor, Snapshot
from mission_tools.station.outcome import Answered
from mission_tools.station.parameters.parameter_table import ParameterTable
from mission_tools.station.uploads import Upload

ItemKind = Literal["mission", "fence", "rally"]


class Clock(Protocol):
    """The one source of time; handed in."""

    def now_s(self) -> float:
        """Monotonic seconds."""

    def unix_s(self) -> float:
        """Seconds since 1970."""


class Service(Protocol):
    """Whoever does requests of a kind."""

    def ask(self, request: PageRequest, reply: Callable[[Answer], None], /) -> None:
        """Do a request; `reply` is called once, now or later."""


class FileSink(Protocol):
    """Where a file goes as it comes."""

    def begin(self, size: int) -> None:
        """A file begins, or begins anew. size: in bytes."""

    def write(self, data: bytes) -> None:
        """What follows on the bytes so far."""

    def room(self) -> int:
        """Bytes that it takes now."""


class Failure(Protocol):
    """Why a transfer has failed."""

    @property
    def text(self) -> str:
        """Why it failed, for people."""


class Files(Protocol):
    """Files of a boat. A callback is called once, never after `cancel`."""

    def read(
        self,
        path: str,
        sink: FileSink,
        done: Callable[[Failure | None], None],
        *,
        most_bytes: int,
        grows: bool = False,
    ) -> Any:  # noqa: ANN401 (only for cancel)
        """A file into a sink; returns the transfer."""

    def cancel(self, job: Any, /) -> None:  # noqa: ANN401
        """End a transfer that is under way."""


class LogListing(Protocol):
    """The logs of a boat, newest first; None with a failure, or while they are fetched."""

    @property
    def logs(self) -> list[LogFile] | None:
        """The boat's logs, newest first."""

    @property
    def failure(self) -> str | None:
        """Why there is none."""

    def request(self) -> None:
        """Read the list again if it is old."""

    def path(self, name: str) -> str | None:
        """Where a listed log is; None for another name."""


class BoatService(Service, Protocol):
    """The station: the boats that it hears. Never blocks.

    is_operator: whether somebody steers from a page; the boats then miss this station when it goes silent.
    """

    is_operator: bool

    @property
    def is_transferring(self) -> bool:
        """Whether a list is on its way, item by item."""

    @property
    def first(self) -> int | None:
        """The boat of a page that asks for none."""

    def filenos(self) -> list[int]:
        """Descriptors to wait on for what the boats send."""

    def poll(self, now_s: float, unix_s: float) -> None:
        """Read and send what is due."""

    def names(self) -> list[BoatName]:
        """Every boat heard so far."""

    def snapshot(self, boat: int) -> Snapshot | None:
        """A boat's values; None before its first heartbeat."""

    def items(self, boat: int, kind: ItemKind) -> dict[str, Any] | None:
        """A GeoJSON FeatureCollection; None while it is not downloaded."""

    def sensors(self, boat: int) -> list[Sensor] | None:
        """A boat's parts with verdicts, kept live for some seconds; None before its first heartbeat."""

    def track(self, boat: int) -> list[tuple[float, float]]:
        """Longitude and latitude, oldest first."""

    def mission(self, boat: int) -> Sequence[MissionItem] | None:
        """The mission on board, home first; None while it is not downloaded."""

    def upload(self, boat: int, upload: Upload, answered: Answered) -> None:
        """Give a boat a mission; `answered` is called once."""

    def parameters(self, boat: int) -> ParameterTable | None:
        """A boat's parameters; None before its first heartbeat."""

    def files(self, boat: int) -> Files | None:
        """A boat's files; None before its first heartbeat."""

    def logs(self, boat: int) -> LogListing | None:
        """A boat's logs; None before its first heartbeat."""

    def ask(self, request: PageRequest, answer: Callable[[Answer], None]) -> None:
        """Do a request; `answer` is called once, now or from a later poll."""


class Found(Protocol):
    """A named tuple: (points, length_m, …), or (reason, nearest) where there is no way."""

    def _asdict(self) -> dict[str, Any]:
        """The result's fields by name."""


class ChartService(Protocol):
    """The map on board."""

    def geojson(self) -> bytes:
        """A FeatureCollection of bounded size."""

    def way(self, start: Place, goal: Place, fence: dict[str, Any] | None) -> Found:
        """The shortest way inside a boat's fence. It may take seconds; called in a thread."""
