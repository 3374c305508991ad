"""Twins of depth sounders on serial lines."""

import struct

from twins.lines import PtyLine


class Ping1dTwin:
    """docs.bluerobotics.com/ping-protocol: it measures always, and sends by itself only what it was told to.

    hear: bytes from the host; say: bytes to the host at one interval. Request and answer of the device
    information are as in Blue Robotics' ping-python (brping/definitions.py). device: 1, or 2 of a Ping360.
    """

    def __init__(self, device: int = 1) -> None:
        self.device = device
        self.distance_mm, self.confidence = 3250, 97
        self.settings: dict[int, bytes] = {}
        self.wrong_sums = 0
        self.streams: set[int] = set()
        self._held = b""

    def power_up(self) -> None:
        """As its supply comes on: it keeps its settings, and is silent."""
        self.streams.clear()
        self._held = b""

    def hear(self, data: bytes) -> bytes:
        """Take commands; the acknowledgements."""
        self._held += data
        answer = b""
        while len(self._held) >= 10:
            assert self._held[:2] == b"BR"
            length, number, source, _ = struct.unpack_from("<HHBB", self._held, 2)
            frame, self._held = self._held[: length + 10], self._held[length + 10 :]
            assert source == 0
            if sum(frame[:-2]) & 0xFFFF != int.from_bytes(frame[-2:], "little"):
                self.wrong_sums += 1
                continue
            payload = frame[8:-2]
            if (number, payload) == (6, b"\x04\x00"):
                answer += self.frame(4, bytes((self.device, 1, 3, 29, 0, 0)))
                continue
            if number == 1400:
                self.streams.add(int.from_bytes(payload, "little"))
            else:
                self.settings[number] = payload
            answer += self.frame(1, struct.pack("<H", number))  # ack
        return answer

    @staticmethod
    def frame(number: int, payload: bytes) -> bytes:
        body = b"BR" + struct.pack("<HHBB", len(payload), number, 1, 0) + payload
        return body + struct.pack("<H", sum(body) & 0xFFFF)

    def say(self) -> bytes:
        """What it sends after a measurement."""
        said = b""
        if 1211 in self.streams:
            said += self.frame(1211, struct.pack("<IB", self.distance_mm, self.confidence))
        if 1212 in self.streams:
            settings = struct.pack("<HIIII", 50, 1, 0, 5000, 3)
            said += self.frame(1212, struct.pack("<IH", self.distance_mm, self.confidence) + settings)
        return said

    def live(self, line: PtyLine) -> None:
        """One interval on a line."""
        line.say(self.hear(line.heard()) + self.say())
