"""A link between two boats of one process, restored at each restart of either program."""

from companion.config.boat_config import LinkConfig
from companion.links.interfaces import Port
from companion.links.memory import MemoryPort, memory_pair
from companion.router.policy import ConfiguredPort, Policy


class Bridge:
    """Two ends, 0 and 1. A boat that loses its power closes its port, and with it the other's link."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._ports: list[MemoryPort | None] = [None, None]

    def port(self, end: int) -> Port:
        """For the program that begins at this end; the port of the one before must be closed."""
        own, other = MemoryPort(name=self._name), self._ports[1 - end]
        self._ports[end] = own
        if other is not None:
            near, far = memory_pair(self._name)
            own.offer(near)
            other.offer(far)
        # A boat beyond the bridge streams only what was requested at the far end
        return ConfiguredPort(own, Policy(LinkConfig(url="memory")))
