"""Commands that request messages: once, or at an interval."""

from collections.abc import Callable

from companion.mavlink.dialect import dialect
from companion.services.commands.command import Command, CommandTable, FollowUps, Result
from companion.services.telemetry.service import TelemetryService
from companion.services.telemetry.streams import MIN_INTERVAL_S

SHORTEST_US = MIN_INTERVAL_S * 1e6  # a granted interval is kept


class MessageCommands:
    """A requested message follows its ACK at once, as with ArduPilot: a client that waits for the ACK first
    would miss it otherwise, and QGroundControl expects both within 1 s.
    """

    def __init__(self, telemetry: TelemetryService, follow_ups: FollowUps) -> None:
        self._telemetry = telemetry
        self._follow_ups = follow_ups
        self.table: CommandTable = {
            dialect.MAV_CMD_GET_HOME_POSITION: self._asks_for(dialect.MAVLINK_MSG_ID_HOME_POSITION),
            dialect.MAV_CMD_GET_MESSAGE_INTERVAL: self._get_interval,
            dialect.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: self._asks_for(
                dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION
            ),
            dialect.MAV_CMD_REQUEST_MESSAGE: self._request,
            dialect.MAV_CMD_SET_MESSAGE_INTERVAL: self._set_interval,
        }

    def _asks_for(self, message_id: int) -> Callable[[Command], Result]:
        return lambda command: self._send_once(command.origin.channel, message_id, 0.0)

    def _request(self, command: Command) -> Result:
        message_id = command.whole(0)
        if message_id is None:
            return Result.UNSUPPORTED
        return self._send_once(command.origin.channel, message_id, command.p[1])

    def _send_once(self, channel: int, message_id: int, which: float) -> Result:
        if not self._telemetry.answers(message_id):
            return Result.UNSUPPORTED
        messages = self._telemetry.build_all(message_id, which)
        self._follow_ups += [(channel, message) for message in messages]
        return Result.ACCEPTED if messages else Result.FAILED

    def _set_interval(self, command: Command) -> Result:
        message_id = command.whole(0)
        channel, interval_us = command.origin.channel, command.p[1]
        if message_id is None or 0.0 < interval_us < SHORTEST_US:
            return Result.DENIED
        done = self._telemetry.set_interval_us(channel, message_id, interval_us, command.now_s)
        return Result.ACCEPTED if done else Result.UNSUPPORTED

    def _get_interval(self, command: Command) -> Result:
        message_id = command.whole(0)
        if message_id is None or not 0 <= message_id <= 0xFFFF:
            return Result.DENIED
        channel = command.origin.channel
        interval_us = self._telemetry.interval_us(channel, message_id)
        self._follow_ups.append((channel, dialect.MAVLink_message_interval_message(message_id, interval_us)))
        return Result.ACCEPTED
