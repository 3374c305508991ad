"""What ArduPilot Rover's parameters must be for the boat to drive through it. They are read, never written.

Sources, of ArduPilot's master of July 2025 (4.7-dev): Rover/Parameters.cpp, RC_Channels_VarInfo.h,
AP_MotorsUGV.cpp, mode.cpp (get_pilot_input) and radio.cpp.
"""

import math
import re
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, build_message

_FUNCTIONS: Final = tuple(f"SERVO{number}_FUNCTION" for number in range(1, 17))
_STICK: Final = re.compile(r"RCMAP_|RC\d")
_RETRY_S: Final = 0.5
_TRIES: Final = 5  # a name that it does not know is not answered
_OVERRIDES_IGNORED: Final = 1 << 1  # of RC_OPTIONS

STEERING, THROTTLE = "RCMAP_ROLL", "RCMAP_THROTTLE"
CHANNEL_KEYS: Final = ("MIN", "TRIM", "MAX", "DZ")  # of RCn_
_PAIR: Final = (73, 74)  # SERVOn_FUNCTION: ThrottleLeft, ThrottleRight
_WITH_RUDDER: Final = (70, 26)  # Throttle, GroundSteering


class Demand(NamedTuple):
    """A parameter, by its name and the one before 4.7, and whether a value will do. is_needed: not advice."""

    names: tuple[str, ...]
    wanted: str
    fits: Callable[[float], bool]
    is_needed: bool = True


def demands(own_system_id: int, *, has_rudder: bool) -> tuple[Demand, ...]:
    """By the boat's system id on the line and its layout.

    Rover turns the steering round astern once in the sticks (PILOT_STEER_TYPE 0) and, with a rudder, once
    more in its output: a pair of motors needs type 3, a rudder type 0.
    """
    steer = 0 if has_rudder else 3
    return (
        Demand(("MAV_GCS_SYSID", "SYSID_MYGCS"), str(own_system_id), lambda value: value == own_system_id),
        # Then the sticks of a transmitter count, which rest
        Demand(("RC_OVERRIDE_TIME",), "0.4", lambda value: 0.2 <= value <= 0.45),
        Demand(("FS_THR_ENABLE",), "1", lambda value: value >= 1),
        Demand(("FS_ACTION",), "2", lambda value: value in (0, 2)),  # others drive by themselves
        Demand(("RC_OPTIONS",), "a value without bit 1", lambda value: not int(value) & _OVERRIDES_IGNORED),
        Demand(("PILOT_STEER_TYPE",), str(steer), lambda value: value == steer),
        Demand(("MOT_SLEWRATE",), "0", lambda value: value == 0 or value >= 300, is_needed=False),
        Demand(("MOT_THR_MIN",), "0", lambda value: value == 0, is_needed=False),
        Demand(("MOT_THR_MAX",), "100", lambda value: value == 100, is_needed=False),
        Demand(("MOT_THST_EXPO",), "0", lambda value: value == 0, is_needed=False),
        Demand(("MOT_THST_ASYM",), "1", lambda value: value == 1, is_needed=False),
        Demand(("MANUAL_STR_EXPO",), "0", lambda value: value == 0, is_needed=False),
    )


class RoverParameters:
    """Reads the parameters one after the other. Any PARAM_VALUE of a wanted one counts, also unasked."""

    def __init__(self, own_system_id: int, *, has_rudder: bool) -> None:
        self._demands = demands(own_system_id, has_rudder=has_rudder)
        self._functions = _WITH_RUDDER if has_rudder else _PAIR
        self.values: dict[str, float] = {}
        self.forget()

    def forget(self) -> None:
        """Read all again, as after a reboot."""
        self.values.clear()
        self.is_complete = False  # each is known, or not answered
        self._missing: set[str] = set()  # not answered
        self._asked, self._tries, self._due_s = "", 0, 0.0

    def ingest(self, message: Message, now_s: float) -> None:  # noqa: ARG002
        """Take a PARAM_VALUE."""
        name, value = str(message.param_id).rstrip("\0"), float(message.param_value)
        if math.isfinite(value) and (name in self.values or name in self._wanted()):
            self.values[name] = value
            self._missing.discard(name)

    def ask(self, peer: Address, now_s: float) -> Message | None:
        """The request that is due."""
        wanted = (name for name in self._wanted() if name not in self.values and name not in self._missing)
        name = next(wanted, "")
        self.is_complete = not name
        if not name or (name == self._asked and now_s < self._due_s):
            return None
        self._tries = self._tries + 1 if name == self._asked else 1
        self._asked, self._due_s = name, now_s + _RETRY_S
        if self._tries > _TRIES:
            self._missing.add(name)
            return None
        return build_message(
            "PARAM_REQUEST_READ",
            target_system=peer.system,
            target_component=peer.component,
            param_id=name.encode(),
            param_index=-1,
        )

    def faults(self, *, is_needed: bool = True) -> list[str]:
        """What is to be set, most important first. is_needed: False for the advice."""
        found = []
        for demand in self._demands:
            if demand.is_needed is not is_needed:
                continue
            name = next((name for name in demand.names if name in self.values), "")
            if not name and is_needed:
                found.append(f"{demand.names[0]} is not answered")
            elif name and not demand.fits(self.values[name]):
                found.append(f"{name} is {self.values[name]:g}, set it to {demand.wanted}")
        if is_needed:
            chosen = {self.values.get(name) for name in _FUNCTIONS}
            found += [f"no SERVOn_FUNCTION is {one}" for one in self._functions if one not in chosen]
            found += [f"{name} is not answered" for name in sorted(self._missing) if _STICK.match(name)]
        return found

    def _wanted(self) -> Iterator[str]:
        """All names; those of the mapped channels once the map is known."""
        for demand in self._demands:
            if not any(name in self.values for name in demand.names):
                yield from demand.names
            else:
                yield from (name for name in demand.names if name in self.values)
        yield from _FUNCTIONS
        for key in (STEERING, THROTTLE):
            yield key
            if key in self.values:
                yield from (f"RC{int(self.values[key])}_{part}" for part in (*CHANNEL_KEYS, "REVERSED"))
