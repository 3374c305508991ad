"""The components of the boat's system besides its own: the camera, and a routed autopilot."""

from collections.abc import Sequence
from typing import Protocol

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import Message
from companion.services.outbox import Origin


class Component(Protocol):
    """One of them."""

    component: int

    @property
    def handled(self) -> frozenset[int]:
        """Numbers of the messages that have an effect."""

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """A message that is addressed to it."""

    def open(self, channel: int) -> None:
        """A channel has opened: announce it there."""

    def tick(self, now_s: float) -> None:
        """Periodic work."""


class Components:
    """All of them."""

    def __init__(self, own: Address, fitted: Sequence[Component]) -> None:
        self._system = own.system
        self._fitted = {one.component: one for one in fitted}
        self.handled = frozenset[int]().union(*(one.handled for one in fitted))

    def addressed(self, message: Message) -> Component | None:
        """The one that a message is addressed to."""
        if getattr(message, "target_system", ALL) != self._system:
            return None
        return self._fitted.get(getattr(message, "target_component", ALL))

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """A message to all components of the system."""
        for one in self._fitted.values():
            one.handle(message, origin, now_s)

    def open(self, channel: int) -> None:
        for one in self._fitted.values():
            one.open(channel)

    def tick(self, now_s: float) -> None:
        for one in self._fitted.values():
            one.tick(now_s)
