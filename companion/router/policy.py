"""Policy of a link: which messages may leave, and how fast, from its configuration."""

from collections.abc import Iterable, Mapping
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network

from companion.config.boat_config import LinkConfig
from companion.core.errors import ConfigError
from companion.core.status_text import StatusText
from companion.links.interfaces import Link, Port
from companion.links.retried import RetriedPort
from companion.mavlink.dialect import dialect
from companion.mavlink.layout import LAYOUTS

_BITS_A_BYTE = 10  # start, eight, stop
_LINE_SHARE = 0.9  # of a radio's line: the rest is its overhead
_STALE_S = 1.0  # default

_IDS: dict[str, int] = {dialect.mavlink_map[number].msgname: number for number in LAYOUTS}
_SLACK_S = 1e-6


class Policy:
    """Rules of one link, for the boat's own and for forwarded messages.

    bytes_s: rate limit, 0 without; stale_s: how long a frame may wait.
    Raises ConfigError: names the key and the unknown message.
    """

    def __init__(
        self,
        setting: LinkConfig,
        key: str = "links",
        baud: int = 0,
        is_loopback: bool = False,
        accepts_any_source: bool = False,
    ) -> None:
        """baud: of a serial line, which is a radio unless configured otherwise.

        is_loopback: only reachable from this machine, so trusted with keys. accepts_any_source: receives
        datagrams from anywhere, with forgeable addresses.
        """
        self.setting = setting
        self.is_radio = setting.radio if setting.radio is not None else baud > 0
        self.is_trusted = setting.trusted if setting.trusted is not None else is_loopback
        self._accepts_any_source = accepts_any_source
        self._local_networks = [_network(text, f"{key}.local_networks") for text in setting.local_networks]
        self.denied = _ids(setting.deny, f"{key}.deny")
        self.allowed = _ids(setting.allow, f"{key}.allow")
        self.min_interval_s = {
            number: 1.0 / setting.max_hz[name]
            for name, number in _named(setting.max_hz, f"{key}.max_hz").items()
        }
        line_bytes_s = _LINE_SHARE * baud / _BITS_A_BYTE if self.is_radio else 0.0
        self.bytes_s = setting.max_bytes_s or line_bytes_s
        self.stale_s = setting.stale_s or _STALE_S

    def is_forgeable(self, host: str) -> bool:
        """Whether this source address may be forged.

        The system drops external datagrams with a loopback address.
        """
        if not self._accepts_any_source:
            return False
        address: IPv4Address | IPv6Address = ip_address(host)
        if isinstance(address, IPv6Address) and address.ipv4_mapped is not None:
            address = address.ipv4_mapped
        return not (address.is_loopback or any(address in network for network in self._local_networks))


class ConfiguredPort:
    """Satisfies `companion.links.interfaces.Port`."""

    def __init__(self, port: Port, policy: Policy) -> None:
        self.policy = policy
        self._port = port

    @property
    def name(self) -> str:
        return self._port.name

    def accept(self) -> list[Link]:
        return self._port.accept()

    def fileno(self) -> int:
        return self._port.fileno()

    def take_texts(self) -> list[StatusText]:
        return self._port.take_texts() if isinstance(self._port, RetriedPort) else []

    def close(self) -> None:
        self._port.close()


class Filter:
    """Applies allow, deny and rate caps to one channel. A rate cap applies per sender."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self._due_s: dict[tuple[int, int], float] = {}  # by message and system: bounded by the caps

    def passes(self, message_id: int, system: int, now_s: float) -> bool:
        """Whether a message may be sent now; a capped one then counts as sent."""
        policy = self._policy
        if message_id in policy.denied or (policy.allowed and message_id not in policy.allowed):
            return False
        interval_s = policy.min_interval_s.get(message_id)
        if interval_s is None:
            return True
        key = (message_id, system)
        due_s = self._due_s.get(key, now_s)
        if now_s + _SLACK_S < due_s:
            return False
        # keep the phase of a nearly punctual sender, so that 10 Hz capped at 5 gives 5
        self._due_s[key] = max(due_s, now_s - interval_s) + interval_s
        return True


def _network(text: str, key: str) -> IPv4Network | IPv6Network:
    try:
        return ip_network(text, strict=False)
    except ValueError:
        raise ConfigError(f"{key}: {text!r} is not a network; expected one such as 192.168.1.0/24") from None


def _ids(names: Iterable[str], key: str) -> frozenset[int]:
    return frozenset(_named(names, key).values())


def _named(names: Iterable[str] | Mapping[str, float], key: str) -> dict[str, int]:
    for name in names:
        if name not in _IDS:
            raise ConfigError(f"{key}: there is no message {name!r}; expected a name such as ATTITUDE")
    return {name: _IDS[name] for name in names}


PLAIN = Policy(LinkConfig(url=""))
"""The policy of an unconfigured link."""
