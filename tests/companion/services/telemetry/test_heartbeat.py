from boat_rig import OK, Rig

from companion.mavlink.dialect import Message, dialect

ARMED = dialect.MAV_MODE_FLAG_SAFETY_ARMED


def beats(rig: Rig) -> list[Message]:
    return rig.peer.said("HEARTBEAT")


def test_a_station_hears_a_rover_boat_as_soon_as_its_link_is_up() -> None:
    rig = Rig()
    rig.receive()
    (beat,) = beats(rig)
    assert (beat.type, beat.autopilot) == (
        dialect.MAV_TYPE_SURFACE_BOAT,
        dialect.MAV_AUTOPILOT_ARDUPILOTMEGA,
    )
    assert beat.base_mode & dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    assert not beat.base_mode & ARMED
    assert beat.custom_mode == 4
    assert beat.system_status == dialect.MAV_STATE_STANDBY
    assert beat.mavlink_version == 3


def test_arming_and_disarming_are_told_before_the_next_tick_and_to_everyone() -> None:
    rig = Rig().ready()
    other = rig.connect()
    rig.receive()
    other.forget()
    rig.set_mode(15)
    assert rig.arm() == OK
    assert [bool(beat.base_mode & ARMED) for beat in beats(rig)] == [True]
    assert beats(rig)[0].system_status == dialect.MAV_STATE_ACTIVE
    assert bool(other.said("HEARTBEAT")[-1].base_mode & ARMED)
    rig.set_mode(4)
    assert beats(rig)[0].system_status == dialect.MAV_STATE_STANDBY  # so that stations offer Disarm
