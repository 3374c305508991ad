"""The telemetry that is asked of a boat: at which rates, how often again, and when it is given back."""

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.streams import INTERVALS_S, SENSORS_S, WANTED_S, Streams

BOAT = Address(1, 1)
SONAR, IMU = dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR, dialect.MAVLINK_MSG_ID_SCALED_IMU
SERVOS, STATUS = dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, dialect.MAVLINK_MSG_ID_SYS_STATUS
HOME = dialect.MAVLINK_MSG_ID_HOME_POSITION


class Asked:
    """Streams polled every 0.25 s, and when each message was asked for."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.sent: list[Message] = []
        self.times_s: dict[int, list[tuple[float, float]]] = {}  # by message: when, and the interval
        self.streams = Streams(BOAT, self._send)

    def _send(self, message: Message) -> None:
        self.sent.append(message)
        if getattr(message, "command", 0) == dialect.MAV_CMD_SET_MESSAGE_INTERVAL:
            asked = round(self.now_s), message.param2 / 1e6
            self.times_s.setdefault(int(message.param1), []).append(asked)

    def run(self, seconds: float, *, heard: dict[int, int] | None = None, has_all: bool = True) -> None:
        """heard: how many of each message come every second."""
        for _ in range(round(seconds)):
            for number, count in (heard or {}).items():
                for _ in range(count):
                    self.streams.on_message(number)
            for _ in range(4):
                self.streams.poll(self.now_s, has_modes=has_all, has_cruise=has_all)
                self.now_s += 0.25

    def requests(self, kind: str) -> list[Message]:
        return [one for one in self.sent if one.get_type() == kind]


def test_every_message_is_asked_for_at_its_interval_and_again_ever_more_rarely() -> None:
    asked = Asked()
    asked.run(260.0)
    assert asked.times_s.keys() == INTERVALS_S.keys()
    for number, interval_s in INTERVALS_S.items():
        assert asked.times_s[number] == [(at_s, interval_s) for at_s in (0, 5, 15, 35, 75, 155, 235)]


def test_what_comes_at_nearly_its_rate_is_not_asked_for_again() -> None:
    asked = Asked()
    asked.run(60.0, heard={SONAR: 2, STATUS: 1})  # of 5 and 1
    assert (len(asked.times_s[SONAR]), len(asked.times_s[STATUS])) == (1, 1)
    asked.run(60.0, heard={SONAR: 1, STATUS: 2})
    assert (len(asked.times_s[SONAR]), len(asked.times_s[STATUS])) == (4, 4)
    asked.streams.restart()
    asked.run(1.0)
    assert asked.times_s[SONAR][-1] == (120, 0.2)


def test_what_the_sensors_need_is_given_back_three_times_when_nobody_looks_any_more() -> None:
    asked = Asked()
    asked.streams.want_sensors(asked.now_s)
    asked.run(WANTED_S)
    assert asked.times_s[SERVOS] == [(0, 0.25)]
    asked.run(6.0)
    assert asked.times_s[STATUS] == [(0, 0.25), (3, 1.0), (8, 1.0)]
    assert asked.times_s[SERVOS] == [(0, 0.25), (3, 0.0), (4, 0.0), (5, 0.0)]
    assert [interval_s for _, interval_s in asked.times_s[IMU]] == [0.25, *[-1e-6] * 3]  # on request only
    assert asked.times_s.keys() == INTERVALS_S.keys() | SENSORS_S.keys()
    asked.streams.want_sensors(asked.now_s)
    asked.run(1.0)
    assert asked.times_s[SERVOS][-1] == (9, 0.25)


def test_a_look_at_the_sensors_ends_the_give_back() -> None:
    asked = Asked()
    asked.streams.want_sensors(asked.now_s)
    asked.run(WANTED_S + 1.0)
    asked.streams.want_sensors(asked.now_s)
    asked.run(2.0)
    assert [interval_s for _, interval_s in asked.times_s[SERVOS]] == [0.25, 0.0, 0.25]


def test_modes_and_cruise_speed_are_asked_for_until_they_are_known() -> None:
    asked = Asked()
    asked.run(81.0, has_all=False)
    modes = [one for one in asked.requests("COMMAND_LONG") if one.command == dialect.MAV_CMD_REQUEST_MESSAGE]
    assert {one.param1 for one in modes} == {dialect.MAVLINK_MSG_ID_AVAILABLE_MODES}
    assert len(modes) == 17
    cruise = asked.requests("PARAM_REQUEST_READ")
    assert [(one.param_id, one.param_index) for one in cruise] == [("CRUISE_SPEED", -1)] * 2
    asked.streams.restart()
    before = len(asked.sent)
    asked.run(1.0)
    assert len(asked.sent) == before + len(INTERVALS_S)
    asked.run(1.0, has_all=False)
    assert len(asked.requests("PARAM_REQUEST_READ")) == 3
