"""What works a sensor along the tracks of a survey: mission items where tracks begin and end, as
QGroundControl puts them into its own surveys.
"""

from typing import NamedTuple

from mission_tools.errors import UsageError
from mission_tools.mission.mission import Command, Frame, MissionItem

_AT_ONCE = 1.0  # DO_SET_CAM_TRIGG_DIST: the first image where the track begins
_FARTHEST_M = 10_000.0
_MOST_RELAY = 15


class Trigger(NamedTuple):
    """The items at the beginning and at the end of what the sensor sees."""

    begin: MissionItem
    end: MissionItem


def parse_trigger(text: str) -> Trigger:
    """From camera:METRES, an image so often, or relay:NUMBER, on. Raises UsageError: anything else."""
    kind, _, number = text.partition(":")
    try:
        value = float(number)
    except ValueError:
        value = -1.0
    if kind == "camera" and 0.0 < value <= _FARTHEST_M:
        return Trigger(
            _item(Command.DO_SET_CAM_TRIGG_DIST, value, 0.0, _AT_ONCE), _item(Command.DO_SET_CAM_TRIGG_DIST)
        )
    if kind == "relay" and value in range(_MOST_RELAY + 1):
        return Trigger(_item(Command.DO_SET_RELAY, value, 1.0), _item(Command.DO_SET_RELAY, value, 0.0))
    raise UsageError(
        f"--trigger '{text}': expected camera:METRES between images, or relay:NUMBER from 0 to {_MOST_RELAY}"
    )


def _item(command: Command, p1: float = 0.0, p2: float = 0.0, p3: float = 0.0) -> MissionItem:
    return MissionItem(command, Frame.MISSION, (p1, p2, p3, 0.0))
