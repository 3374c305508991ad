"""Whom a frame is for, read from its bytes without unpacking it."""

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame
from companion.mavlink.layout import LAYOUTS

EVERYBODY = Address(ALL, ALL)
_NOWHERE = 255  # beyond every field: reads as 0, as what MAVLink 2 has cut off does


def _places() -> dict[int, tuple[int, int]]:
    """Where in its payload a message has its target's system and component, for all that have a target."""
    places: dict[int, tuple[int, int]] = {}
    for message_id, layout in LAYOUTS.items():
        # in a payload that counts its own bytes, a byte's value is its place
        counted = layout.unpack(bytes(range(layout.size)))
        system = getattr(counted, "target_system", None)
        if system is not None:
            places[message_id] = system, getattr(counted, "target_component", _NOWHERE)
    # MANUAL_CONTROL names the system that it steers in a field of another name
    steered = LAYOUTS[dialect.MAVLINK_MSG_ID_MANUAL_CONTROL]
    places[steered.message_id] = steered.unpack(bytes(range(steered.size))).target, _NOWHERE
    return places


_PLACES = _places()


def target_of(frame: Frame) -> Address:
    """The target's system and component, 0 for all; a message without a target is for everybody."""
    places = _PLACES.get(frame.message_id)
    if places is None:
        return EVERYBODY
    system_at, component_at = places
    payload = frame.payload
    length = len(payload)
    if system_at >= length:
        return EVERYBODY if component_at >= length else Address(ALL, payload[component_at])
    return Address(payload[system_at], payload[component_at] if component_at < length else ALL)
