"""SETUP_SIGNING, and reports to the operator about signing.

A key sent over the air could be intercepted, so it is accepted only on a link that the configuration trusts
(loopback, USB), addressed to us, and while disarmed. It is never forwarded, logged or reported.
"""

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field

from companion.core.status_text import Severity
from companion.mavlink.address import Address, is_named
from companion.mavlink.dialect import Message
from companion.mavlink.signing import SigningGuard
from companion.mavlink.signing_key import SigningKey
from companion.persistence.signing_store import SigningStore
from companion.router.channel import Channel
from companion.services.outbox import Origin
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

_LOOK_S = 1.0
_KEY_PAUSE_S = 10.0  # between two reports of refused keys
_PAUSE_S = 3.0  # between two reports about links
_MAX_WARNINGS = 64


@dataclass(eq=False)
class SigningService:
    """Receives keys; reports links without a key and unsigned frames."""

    _own: Address
    _vehicle: Vehicle
    _store: SigningStore
    _channels: Mapping[int, Channel]
    _texts: StatusTextService
    refused: int = field(default=0, init=False)  # keys not accepted
    _warned: set[str] = field(default_factory=set, init=False)
    _complained: set[int] = field(default_factory=set, init=False)
    _look_s: float = field(default=0.0, init=False)
    _complain_s: float = field(default=0.0, init=False)
    _refuse_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        for name, what in self._store.losses.items():
            self._vehicle.data_losses.add(name, what, "Set or remove the signing key")

    def open(self, channel: int) -> None:
        """A channel has opened: guard it; problems are told once. ConfigError: its key file is invalid."""
        opened = self._channels[channel]
        policy, setting = opened.policy, opened.policy.setting
        name = opened.link.name
        if setting.signing != "off":
            signatory = self._store.signatory(setting.key_file)
            opened.set_guard(SigningGuard(signatory, setting.signing, channel, is_radio=policy.is_radio))
            if setting.signing == "required" and signatory.key is None:
                self._warn_once(f"{name} requires signatures, but has no key")
        if policy.is_radio and setting.signing != "required":
            how = "is not signed" if setting.signing == "off" else "accepts unsigned messages"
            self._warn_once(f"Radio {name} {how}: anyone in range may steer")

    def forget(self, channel: int) -> None:
        self._complained.discard(channel)

    def on_setup(self, message: Message, origin: Origin, now_s: float) -> None:
        """Accept or refuse a key. A key of zeros removes the present one."""
        if not is_named(self._own, message.target_system, message.target_component):
            return
        channel = self._channels.get(origin.channel)
        if channel is None or not channel.policy.is_trusted:
            self._refuse("this link is not trusted with keys", now_s)
        elif self._vehicle.armed:
            self._refuse("disarm first", now_s)
        else:
            secret = bytes(message.secret_key)
            key = SigningKey(secret) if any(secret) else None
            self._store.change_key(key, message.initial_timestamp)
            what = "set" if key else "removed"
            logger.info("signing key %s by %d/%d on %s", what, *origin.address, channel.link.name)

    def tick(self, now_s: float, unix_s: float) -> None:
        """Advance the timestamps; report news."""
        self._store.tick(unix_s)
        if now_s >= self._look_s:
            self._look_s = now_s + _LOOK_S
            self._report_saved()
            self._warn_of_refused(now_s)

    def _report_saved(self) -> None:
        error = self._store.key_saved()
        if error is None:
            return
        what = "Signing key stored" if self._store.boat.key else "Signing key removed"
        if error:
            self._texts.notify(Severity.ERROR, f"Signing key not stored: {error}")
        else:
            for name in self._store.losses:
                self._vehicle.data_losses.end(name)
            self._texts.notify(Severity.NOTICE, what)

    def _refuse(self, reason: str, now_s: float) -> None:
        self.refused += 1
        if now_s >= self._refuse_s:
            self._refuse_s = now_s + _KEY_PAUSE_S
            self._texts.notify(Severity.WARNING, f"Signing key refused: {reason}")

    def _warn_of_refused(self, now_s: float) -> None:
        """Report refused messages once per link."""
        if now_s < self._complain_s:
            return
        for number, channel in self._channels.items():
            if channel.guard is None or number in self._complained:
                continue
            counters = channel.guard.counters
            if counters.refused:
                self._complained.add(number)
                self._complain_s = now_s + _PAUSE_S
                why = "not signed" if counters.unsigned else "not signed with our key, or out of date"
                text = f"{channel.link.name}: messages refused, {why}"
                logger.info(text)
                self._texts.notify(Severity.WARNING, text)
                return

    def _warn_once(self, text: str) -> None:
        if text not in self._warned and len(self._warned) < _MAX_WARNINGS:
            self._warned.add(text)
            logger.warning(text)
            self._texts.notify(Severity.WARNING, text)
