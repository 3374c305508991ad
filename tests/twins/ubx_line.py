"""The line between a u-blox receiver and the driver."""

from collections.abc import Callable

from companion.links.memory import MemoryPort, memory_pair
from twins.ubx_receiver import UbxReceiver


class BaudLine:
    """A serial line in memory to a receiver. Bytes at another baud rate arrive garbled."""

    def __init__(self, receiver: UbxReceiver) -> None:
        self.receiver = receiver
        self.baud: int | None = None  # of the host
        self.garbles_every = 0  # byte out of so many is wrong; 0: none
        self.on_sent: Callable[[bytes], object] = bytes  # each piece that the host sends
        self._count = 0
        near, self._far = memory_pair(is_datagram=False)
        self.port = MemoryPort(near)

    def set_baud(self, baud: int) -> None:
        """The host sets its end."""
        self.baud = baud

    def pump(self, now_s: float) -> None:
        """Move the bytes of both directions."""
        before = self.receiver.baud
        for data in self._far.receive():
            self.on_sent(data)
            if self.receiver.baud in (None, self.baud):
                self.receiver.hear(data)
        data = self.receiver.run(now_s)
        if self.baud not in (None, before) and before is not None:
            data = bytes((7 * byte + 13) & 0xFF for byte in data[::2])
        if data:
            self._far.send(self._noisy(data))

    def _noisy(self, data: bytes) -> bytes:
        if not self.garbles_every:
            return data
        result = bytearray(data)
        for at in range(len(result)):
            self._count += 1
            if self._count % self.garbles_every == 0:
                result[at] ^= 0x55
        return bytes(result)
