"""The station of the shore page over memory links to boats in simulated water: no clock, no sleep."""

import random
from collections.abc import Callable
from typing import Any

from boat_rig import Rig

from companion.boat import TICK_S
from companion.links.interfaces import Link
from companion.links.memory import MemoryLink, memory_pair
from mission_tools.station.boat import ShoreBoat
from mission_tools.station.boats import Boats
from mission_tools.station.items import Kind
from mission_tools.station.messages import Answer, PageRequest, Snapshot

UNIX_S = 1_800_000_000.0


class LossyEnd:
    """The station's end of a link that drops a share of the frames, both ways."""

    name = "lossy"
    host = ""
    is_datagram = True

    def __init__(self, link: MemoryLink, loss: float, seed: int) -> None:
        self._link = link
        self._random = random.Random(seed)
        self.loss = loss
        self._is_deaf = False
        self.unheard: set[int] = set()  # messages, by number, that are lost on their way here

    def reseed(self, seed: int, loss: float) -> None:
        """From now on lose this share."""
        self._random, self.loss = random.Random(seed), loss

    def deafen(self) -> None:
        """From now on nothing arrives here; what is sent does."""
        self._is_deaf = True

    @property
    def is_closed(self) -> bool:
        """As the link's."""
        return self._link.is_closed

    def fileno(self) -> int:
        """−1: nothing to wait on."""
        return -1

    def close(self) -> None:
        """The connection ends."""
        self._link.close()

    def receive(self) -> list[bytes]:
        """What was not lost."""
        chunks = self._link.receive()
        heard = [one for one in chunks if not self._is_deaf and one[7] not in self.unheard]
        return [one for one in heard if self._random.random() >= self.loss]

    def send(self, data: bytes) -> bool:
        """True, like radio."""
        return self._link.send(data) if self._random.random() >= self.loss else True


class ShorePort:
    """A port whose links the test adds."""

    name = "shore"

    def __init__(self) -> None:
        self.fresh: list[Link] = []

    def accept(self) -> list[Link]:
        """Links since the last call."""
        fresh, self.fresh = self.fresh, []
        return fresh

    def fileno(self) -> int:
        """−1: nothing to wait on."""
        return -1

    def close(self) -> None:
        """Nothing to close."""


class Shore:
    """Boats (rigs) in one time, and the station that watches them."""

    def __init__(self, *rigs: Rig, loss: float = 0.0, seed: int = 1, system_id: int = 250) -> None:
        self.rigs = rigs
        self.port = ShorePort()
        self.ends = [self.link(rig, loss, seed) for rig in rigs]
        self.boats = Boats(self.port, system_id)
        self.now_s = 0.0
        self.answers: list[Answer] = []

    def link(self, rig: Rig, loss: float = 0.0, seed: int = 1) -> LossyEnd:
        """A link to a boat."""
        near, far = memory_pair("shore")
        rig.port.offer(near)
        end = LossyEnd(far, loss, seed)
        self.port.fresh.append(end)
        return end

    def poll(self) -> None:
        """One poll of the station."""
        self.boats.poll(self.now_s, UNIX_S + self.now_s)

    def run(self, seconds: float) -> None:
        """Time goes by; the station is polled every 40 ms, the boats act every tick."""
        for tick in range(round(seconds / TICK_S)):
            for rig in self.rigs:
                rig.step()
            self.now_s += TICK_S
            if tick % 2:
                self.poll()

    def until(self, is_so: Callable[[], bool], limit_s: float) -> None:
        """Run until something is so."""
        began_s = self.now_s
        while not is_so():
            assert self.now_s - began_s < limit_s, f"not within {limit_s} s"
            self.run(0.04)

    def ready(self) -> "Shore":
        """Until the boats may be armed and their lists are downloaded."""
        self.until(lambda: all(_is_ready(self.boats.snapshot(name.id)) for name in self.boats.names())
                   and len(self.boats.names()) == len(self.rigs), 60.0)  # fmt: skip
        return self

    def snapshot(self, boat: int = 1) -> Snapshot:
        """The boat as the page shows it."""
        snapshot = self.boats.snapshot(boat)
        assert snapshot is not None
        return snapshot

    def boat(self, number: int = 1) -> ShoreBoat:
        """A boat that was heard."""
        boat = self.boats.get(number)
        assert boat is not None
        return boat

    def features(self, kind: Kind) -> list[dict[str, Any]]:
        """The features of a list of the first boat, once it is downloaded."""
        found = self.boats.items(1, kind)
        assert found is not None
        features: list[dict[str, Any]] = found["features"]
        return features

    def send(self, what: str, arguments: dict[str, Any] | None = None, boat: int = 1) -> None:
        """A request of the page; its answer is added to `answers`."""
        number = f"{what}-{len(self.answers)}-{self.now_s}"
        request = PageRequest(id=number, boat=boat, what=what, arguments=arguments or {})
        self.boats.ask(request, self.answers.append)

    def ask(self, what: str, arguments: dict[str, Any] | None = None, boat: int = 1) -> Answer:
        """A request of the page, and its one answer, which must come within 10 s."""
        before = len(self.answers)
        self.send(what, arguments, boat)
        self.until(lambda: len(self.answers) > before, 10.0)
        assert len(self.answers) == before + 1
        return self.answers[-1]


def _is_ready(snapshot: Snapshot | None) -> bool:
    return (
        snapshot is not None
        and snapshot.place is not None
        and snapshot.rally is not None
        and snapshot.fix is not None
        and snapshot.compass is not None
        and snapshot.compass.ok
    )
