"""All that this station knows of a boat's parameters, and what is under way to them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import msgspec

from companion.core.units import as_float32
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.outcome import Outcome, Refused
from mission_tools.station.parameters.download import Download, State
from mission_tools.station.parameters.fetching import INFORMATION, METADATA, Fetching, Packed, Read, TextState
from mission_tools.station.parameters.metadata import Description, Descriptions
from mission_tools.station.parameters.setting import Settings, refusal_of
from mission_tools.station.parameters.values import NAME, Value
from mission_tools.station.words import say

WANTED_S: Final = 3.0  # after each snapshot
WANTED: Final = frozenset(
    {dialect.MAVLINK_MSG_ID_PARAM_VALUE, dialect.MAVLINK_MSG_ID_PARAM_ERROR, METADATA, INFORMATION}
)
_LOADING: Final = ("waiting", "asking", "reading")
_NO_DESCRIPTIONS: Final = Descriptions({})

Replied = Callable[[Outcome, dict[str, Any] | None], None]


@dataclass(frozen=True, slots=True)
class TableSnapshot:
    """What is known now. got, count: of the list while it is loading; missing: what the boat does not give.

    packed: the texts as they came, while nobody has read them; texts: how far they are.
    """

    state: State
    got: int
    count: int | None
    missing: int
    version: int
    values: Mapping[str, Value]
    descriptions: Descriptions
    packed: Packed | None
    texts: TextState


class ParameterTable:
    """Of one boat. send: to this boat; read: a file of it by FTP."""

    def __init__(self, boat: Address, own: Address, send: Callable[[Message], None], read: Read) -> None:
        self._download = Download(boat, send)
        self._settings = Settings(boat, own, send)
        self._fetching = Fetching(boat, send, read)
        self._descriptions = _NO_DESCRIPTIONS
        self._described: Packed | None = None  # what the descriptions were read from
        self._described_version = 0
        self._is_looked_at = False
        self._was_heard = False
        self._wanted_s = float("-inf")

    def snapshot(self) -> TableSnapshot:
        """What is known; and it is wanted for the next seconds."""
        self._is_looked_at = True
        download, packed = self._download, self._fetching.packed
        return TableSnapshot(
            state=download.state,
            got=download.got,
            count=download.count,
            missing=download.missing,
            version=download.version + self._described_version,
            values=download.values,
            descriptions=self._descriptions,
            packed=None if packed is self._described else packed,
            texts=self._fetching.state,
        )

    def describe(self, packed: Packed, descriptions: Descriptions | None) -> None:
        """The texts read from `packed`; None if they cannot be read."""
        if packed is not self._fetching.packed:
            return
        if descriptions is None:
            self._fetching.refuse()
            return
        self._described, self._descriptions = packed, descriptions
        self._described_version += 1

    def restart(self) -> None:
        """The boat has started again, or was silent: its values may be others."""
        self._download.restart()
        self._fetching.restart()

    def on_autopilot(self, autopilot: int) -> None:
        """Take a heartbeat: another autopilot has other parameters."""
        self._download.is_bytewise = autopilot == dialect.MAV_AUTOPILOT_PX4

    def handle(self, message: Message, now_s: float) -> None:
        """Take a message of one of the kinds in WANTED."""
        number = message.get_msgId()
        if number == dialect.MAVLINK_MSG_ID_PARAM_VALUE:
            if (known := self._download.handle(message, now_s)) is not None:
                self._settings.on_value(*known, now_s)
        elif number == dialect.MAVLINK_MSG_ID_PARAM_ERROR:
            self._settings.on_error(message, now_s)
        else:
            self._fetching.handle(message, now_s)

    def on_text(self, text: str, now_s: float) -> None:
        """A STATUSTEXT of the boat."""
        self._settings.on_text(text, now_s)

    def poll(self, now_s: float, is_heard: bool) -> None:
        """Ask for what is missing, repeat, give up."""
        if self._is_looked_at:
            self._is_looked_at, self._wanted_s = False, now_s + WANTED_S
        if self._was_heard and not is_heard and self._download.state == "here":
            self.restart()  # what was set meanwhile was not heard
        self._was_heard = is_heard
        is_wanted = is_heard and now_s < self._wanted_s
        self._download.poll(now_s, is_wanted)
        self._fetching.poll(now_s, is_wanted and self._download.state == "here")
        self._settings.poll(now_s)

    def set(self, arguments: Mapping[str, Any], armed: bool | None, reply: Replied, now_s: float) -> None:
        """The request `set_parameter` with name and value. armed: None if not known. reply: how
        it ended, {name, value} on board.
        """
        name, value = arguments.get("name"), arguments.get("value")
        if armed is not False:
            reply(Refused(say("answer.param_armed") if armed else say("error.armed_unknown")), None)
            return
        if not isinstance(name, str) or not NAME.fullmatch(name):
            reply(Refused(say("answer.param_name")), None)
            return
        if isinstance(value, bool) or not isinstance(value, int | float):
            reply(Refused(say("answer.param_no_value", name=name)), None)
            return
        known = self._download.values.get(name)
        if known is None:
            reply(Refused(say("answer.param_unknown", name=name)), None)
            return
        is_bytewise = self._download.is_bytewise
        if flaw := refusal_of(name, value, known.kind, is_bytewise, self._descriptions.of(name)):
            reply(Refused(flaw), _result(name, known))
            return

        def answered(outcome: Outcome, kept: Value | None) -> None:
            reply(outcome, None if kept is None else _result(name, kept))

        self._settings.ask(name, float(value), known.kind, is_bytewise, answered, now_s)


def _result(name: str, value: Value) -> dict[str, Any]:
    return {"name": name, "value": value.number()}


def document(snapshot: TableSnapshot, values: list[tuple[str, Value]]) -> bytes:
    """The table as the page gets it, in JSON: {missing, texts, parameters: […]} by name.

    values: of the snapshot, copied. texts: loading, here or none. Takes milliseconds: use a thread.
    """
    texts = "loading" if snapshot.texts in _LOADING or snapshot.packed is not None else snapshot.texts
    rows = [_row(name, value, snapshot.descriptions.of(name)) for name, value in sorted(values)]
    return msgspec.json.encode({"missing": snapshot.missing, "texts": texts, "parameters": rows})


def _row(name: str, value: Value, known: Description) -> dict[str, Any]:
    is_changed = (
        known.default is not None
        and value.value is not None
        and as_float32(value.value) != as_float32(known.default)
    )
    return {
        "name": name,
        "value": value.number(),
        "type": value.type,
        "text": known.text,
        "long": known.long,
        "unit": known.unit,
        "min": known.low,
        "max": known.high,
        "step": known.step,
        "decimals": known.decimals,
        "values": [{"value": one.value, "text": one.text} for one in known.values],
        "bits": [{"bit": one.index, "text": one.text} for one in known.bits],
        "default": known.default,
        "changed": is_changed,
        "group": known.group or name.partition("_")[0].rstrip("0123456789") or name,
        "reboot_required": known.needs_restart,
        "read_only": known.read_only,
    }
