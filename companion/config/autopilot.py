"""Configuration of an autopilot whose sensors and outputs the boat uses."""

from collections.abc import Mapping
from typing import Annotated, Any

from msgspec import Meta

from companion.config.section import NonNegative, Section, SystemId


class AutopilotPart(Section, frozen=True):
    """A Pixhawk or its like over MAVLink. In `parts` its port url is enough.

    system_id: the autopilot's; 0: the first that is heard. own_system_id: the boat's on this line. ArduPilot
    takes channels from MAV_GCS_SYSID only (SYSID_MYGCS before 4.7), 255 as delivered. latency_s: shortest
    time from a measurement to its arrival. resume_s: a voyage goes on if the outputs return within this time;
    later the boat disarms. component: its id under the boat's system id, by which stations reach it,
    such as 25 (MAV_COMP_ID_USER1); 0: they do not.
    """

    url: str = ""
    system_id: Annotated[int, Meta(ge=0, le=255)] = 0
    own_system_id: SystemId = 255
    component: Annotated[int, Meta(ge=0, le=99)] = 0
    latency_s: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.01  # half a period of ArduPilot's 50 Hz loop
    resume_s: NonNegative = 60.0  # ArduPilot's simulator drove again 43 s after a restart


def with_autopilot(tree: Mapping[str, Any]) -> dict[str, Any]:
    """The tree with the driver "autopilot" for the receiver, compass, battery monitor, motors and rudder that
    a tree with `parts.autopilot` does not mention.
    """
    parts, drive = tree.get("parts"), tree.get("drive")
    if not isinstance(parts, dict) or not parts.get("autopilot"):
        return dict(tree)
    layout = drive.get("layout") if isinstance(drive, dict) else None
    names = ["gnss", "compass", "battery", "motors", *(["rudder"] if layout == "rudder" else [])]

    def chosen(part: object) -> object:
        return {"driver": "autopilot", **part} if isinstance(part, dict) else part

    return {**tree, "parts": {**parts, **{name: chosen(parts.get(name, {})) for name in names}}}
