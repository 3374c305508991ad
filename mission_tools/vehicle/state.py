"""What a vehicle has said about itself: its messages folded into one state. No link in here."""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.units import e7_to_deg

AUTOPILOT_COMPONENT = 1
MAV_AUTOPILOT_ARDUPILOTMEGA = 3
ARMED_BIT = 128
AUTO = 10
MISSION_ACTIVE, MISSION_COMPLETE = 3, 5  # MISSION_STATE
WARNING = 4  # MAV_SEVERITY; smaller is worse

# Those that this boat does not have, with Rover's numbers, and those that it has
ROVER_MODES = {8: "DOCK", 16: "INITIALISING"} | {mode.value: mode.name for mode in Mode}

MISSION_REFUSALS = {
    1: "error",
    2: "it does not know the frame",
    3: "it does not know the command",
    4: "it has no room for so many items",
    5: "a parameter is invalid",
    6: "parameter 1 is invalid",
    7: "parameter 2 is invalid",
    8: "parameter 3 is invalid",
    9: "parameter 4 is invalid",
    10: "x or latitude is invalid",
    11: "y or longitude is invalid",
    12: "z or altitude is invalid",
    13: "the items came out of order",
    14: "it takes no missions from us",
    15: "the transfer was cancelled",
}

CANCELLED = 15  # it gave up for want of answers

COMMAND_RESULTS = {
    1: "not now",
    2: "denied",
    3: "not supported",
    4: "failed",
    5: "still in progress",
    6: "cancelled",
}


@dataclass(slots=True)
class VehicleState:
    """The latest of everything. `heard_s` is the clock's time of the last heartbeat."""

    autopilot: int = 0
    type: int = 0
    custom_mode: int = -1
    armed: bool = False
    heard_s: float = -math.inf
    position: LatLon | None = None
    boat_time_s: float = 0.0  # of that position, by the boat's own clock since it started
    speed_m_s: float = 0.0
    current_item: int = 0
    mission_state: int = 0
    reached_item: int = -1  # the highest since the mission was started
    says_more: bool = False  # than heartbeats
    refused: int = 0  # MAV_MISSION_RESULT of the last MISSION_ACK
    answers: dict[int, int] = field(default_factory=dict)  # and of the last for each MAV_MISSION_TYPE
    requested_item: int = -1  # what it asked for last in an upload
    texts: deque[tuple[float, int, str]] = field(default_factory=lambda: deque(maxlen=50))
    _chunks: dict[int, str] = field(default_factory=dict)

    @property
    def is_ardupilot(self) -> bool:
        """Whether item 0 is home and modes are Rover's."""
        return self.autopilot == MAV_AUTOPILOT_ARDUPILOTMEGA

    @property
    def first_seq(self) -> int:
        """The sequence number of a mission's first item: 1 where 0 is home."""
        return 1 if self.is_ardupilot else 0

    @property
    def has_refused(self) -> bool:
        """Whether it does not take what was sent; one that gave up waiting may take it at another try."""
        return self.refused not in (0, CANCELLED)

    @property
    def mode(self) -> str:
        """The mode's name for people."""
        name = ROVER_MODES.get(self.custom_mode) if self.is_ardupilot else None
        return name or f"mode {self.custom_mode}"

    def last_warning(self, since_s: float) -> str:
        """The last text of warning or worse since then; empty when there was none."""
        return next(reversed(self._warnings(since_s)), "")

    def refusal(self, since_s: float) -> str:
        """The last such text but those of failsafes: one that fires meanwhile is no reason to refuse."""
        texts = [text for text in self._warnings(since_s) if not text.startswith("Failsafe: ")]
        return next(reversed(texts), "")

    def _warnings(self, since_s: float) -> list[str]:
        return [text for at_s, severity, text in self.texts if at_s >= since_s and severity <= WARNING]

    def handle(self, name: str, component: int, fields: Mapping[str, Any], now_s: float) -> None:
        """Take in one message of the vehicle's; those of other components of its system are left out."""
        if component != AUTOPILOT_COMPONENT:
            return
        self.says_more |= name != "HEARTBEAT"
        match name:
            case "HEARTBEAT":
                self.autopilot, self.type = fields["autopilot"], fields["type"]
                self.custom_mode = fields["custom_mode"]
                self.armed = bool(fields["base_mode"] & ARMED_BIT)
                self.heard_s = now_s
            case "GLOBAL_POSITION_INT":
                if (fields["lat"], fields["lon"]) != (0, 0):  # what autopilots say before the first fix
                    self.position = LatLon(e7_to_deg(fields["lat"]), e7_to_deg(fields["lon"]))
                    self.boat_time_s = fields["time_boot_ms"] / 1000.0
                self.speed_m_s = math.hypot(fields["vx"], fields["vy"]) / 100.0
            case "MISSION_CURRENT":
                self.current_item = fields["seq"]
                self.mission_state = fields.get("mission_state", 0)
            case "MISSION_ITEM_REACHED":
                self.reached_item = max(self.reached_item, fields["seq"])
            case "MISSION_REQUEST" | "MISSION_REQUEST_INT":
                self.requested_item = fields["seq"]
            case "MISSION_ACK":
                self.refused = fields["type"]
                self.answers[fields.get("mission_type", 0)] = fields["type"]
            case "STATUSTEXT":
                self._take_text(fields, now_s)

    def _take_text(self, fields: Mapping[str, Any], now_s: float) -> None:
        """Texts beyond 50 characters come in chunks under one id; a shorter chunk is the last."""
        text, identity = str(fields["text"]), int(fields.get("id", 0))
        if identity:
            text = self._chunks.pop(identity, "") + text
            if len(fields["text"]) >= 50:
                self._chunks[identity] = text
                return
        self.texts.append((now_s, int(fields["severity"]), text))
