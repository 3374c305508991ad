"""A port with the policy of its links."""

from companion.hal.interfaces import Link, Port
from companion.router.policy import Policy


class ConfiguredPort:
    """Satisfies `companion.hal.interfaces.Port`."""

    def __init__(self, port: Port, policy: Policy) -> None:
        self.policy = policy
        self._port = port

    @property
    def name(self) -> str:
        """The url."""
        return self._port.name

    def accept(self) -> list[Link]:
        """New links since the last call."""
        return self._port.accept()

    def fileno(self) -> int:
        """A descriptor to wait on for new links, −1 without one."""
        return self._port.fileno()

    def close(self) -> None:
        """Close, with all its links. May be called twice."""
        self._port.close()
