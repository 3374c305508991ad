"""Verifies that stations at forgeable addresses receive what is sent to them.

The question is a PING with a random number, which QGroundControl and MAVSDK return; it follows a heartbeat,
as QGroundControl only answers known vehicles. Without an answer `AmplificationLimit` applies, and the
operator gets one message how to change that.
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field

from companion.core.status_text import Severity
from companion.mavlink.dialect import Message, dialect
from companion.router.admission import Question
from companion.router.channel import Channel
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService
from companion.services.telemetry.heartbeat import HeartbeatService

logger = logging.getLogger(__name__)

_ASK_S = 1.0  # period of questions: that of the heartbeat
_PATIENCE = 5  # unanswered questions before the report
_MAX_WARNINGS = 16  # hosts: forged addresses must not flood the operator


@dataclass(eq=False)
class AddressCheck:
    """Questions and answers of all channels with an amplification limit."""

    _channels: Mapping[int, Channel]
    _outbox: Outbox
    _texts: StatusTextService
    _asked_s: dict[int, float] = field(default_factory=dict, init=False)
    _asked: dict[int, int] = field(default_factory=dict, init=False)  # number, by channel
    _warned: set[str] = field(default_factory=set, init=False)

    def on_heartbeat(self, origin: Origin, heartbeat: HeartbeatService, now_s: float) -> None:
        """Announce the boat to a new station, and ask. Other channels get the regular heartbeat."""
        channel = self._channels.get(origin.channel)
        if channel is None or not channel.needs_address_proof:
            return
        number = origin.channel
        if now_s - self._asked_s.get(number, -_ASK_S) < _ASK_S:
            return
        self._asked_s[number] = now_s
        self._asked[number] = self._asked.get(number, 0) + 1
        self._outbox.send(number, heartbeat.message())
        if (question := channel.question(int(now_s * 1e6))) is not None:
            self._outbox.send(number, dialect.MAVLink_ping_message(*question, 0, 0))
        if self._asked[number] > _PATIENCE:
            self._warn(channel)

    def on_ping(self, message: Message, origin: Origin) -> None:
        """A possible answer."""
        channel = self._channels.get(origin.channel)
        if channel is not None:
            channel.check_answer(Question(message.time_usec, message.seq))

    def forget(self, channel: int) -> None:
        self._asked_s.pop(channel, None)
        self._asked.pop(channel, None)

    def _warn(self, channel: Channel) -> None:
        host = channel.host
        if host in self._warned or len(self._warned) >= _MAX_WARNINGS:
            return
        self._warned.add(host)
        text = f"{host} does not answer PING: no telemetry unless local_networks has its network"
        logger.warning(text)
        self._texts.notify(Severity.WARNING, text)
