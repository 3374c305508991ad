"""PCA9685: 16 servo signals on I²C.

The chip makes the pulses by itself, also when the program is killed or the bus fails. Its pin OE is then the
only way to end them: it is high, so the outputs are low, until the chip is set up and whenever it does not
answer. All channels have one frequency. A thread writes the registers, so no caller waits for the bus; one
chip is shared by all its channels.
"""

import logging
import threading
from collections.abc import Callable
from typing import Final, Protocol

from companion.config.actuators import Pca9685Part, PulseOutputSetting
from companion.core.errors import HardwareError, SilentOutputsError
from companion.hal.background import Background
from companion.hal.pulses.pca9685_chip import AT_ONCE, Pca9685
from companion.hal.raspberry_pi import I2cBus, open_i2c_part, opening_pins

_log = logging.getLogger(__name__)

_LOOK_S: Final = 0.25  # between two looks at the registers
_RETRY_S: Final = 0.02
_FAILURES: Final = 3  # in a row, before the users are told: one lost byte is none of their business


class OutputEnable(Protocol):
    """The pin at OE, as gpiozero's OutputDevice: `off` drives it high."""

    def on(self) -> None: ...
    def off(self) -> None: ...


class Pca9685Board:
    """A chip, and the thread that writes to it. `step` is one turn of the thread."""

    def __init__(self, chip: Pca9685, enable: OutputEnable | None = None) -> None:
        """enable: on while the chip answers; None: OE is wired to ground."""
        self.dips = 0  # number of times that it had to be set up again
        self.fault = ""  # why it does not answer; empty while it does
        self.users = 0
        self._chip = chip
        self._enable = enable
        self._are_off = False  # by OE
        self._let_out(True)
        self._lock = threading.Lock()
        self._changed = threading.Event()
        self._wanted: dict[int, int] = {}  # steps to be written, by channel
        self._sent: dict[int, int] = {}  # or under way
        self._failures = 0
        self._background = Background(self._run, "PCA9685", retry_s=_RETRY_S)

    def start(self) -> None:
        """Begin to write in a thread."""
        self._background.start()

    def put(self, channel: int, width_us: float) -> None:
        """Have a width written soon; 0: no pulses."""
        steps = self._chip.steps(width_us)
        with self._lock:
            if steps == self._wanted.get(channel, self._sent.get(channel)):
                return
            self._wanted[channel] = steps
        if not self._changed.is_set():
            self._changed.set()

    def step(self) -> None:
        """Set the chip up again if its supply has dipped, then write what is wanted; failures are counted."""
        try:
            if not self._chip.is_set_up():
                self._let_out(False)
                self._chip.set_up()
                self._let_out(True)
                with self._lock:
                    self._wanted.clear()  # the users are told, and begin anew
                    self._sent.clear()
                    self.dips += 1
                _log.error("PCA9685: its supply dipped; all its signals are off until they are set again")
            while changes := self._next():
                try:
                    self._chip.write(min(changes), *(changes[channel] for channel in sorted(changes)))
                except OSError:
                    with self._lock:
                        self._wanted = changes | self._wanted
                        for channel in changes:
                            del self._sent[channel]  # what the chip has is unknown
                    raise
        except OSError as error:
            self._failures += 1
            if self._failures == _FAILURES:
                self.fault = f"PCA9685: no answer on the I²C bus: {error}"
                _log.error("%s", self.fault)
            if self.fault:
                self._let_out(False)
            return
        if self.fault:
            self._let_out(True)
            _log.info("PCA9685: answers again")
        self._failures, self.fault = 0, ""

    def check(self) -> None:
        """Raises SilentOutputsError while the chip does not answer."""
        if self.fault:
            raise SilentOutputsError(self.fault, are_off=self._are_off)

    def close(self) -> None:
        """Stop the thread, then all pulses, then release the bus."""
        self._changed.set()
        self._background.close()
        try:
            self._chip.all_off()
        except OSError as error:
            raise HardwareError(f"PCA9685: its pulses could not be ended: {error}") from error
        finally:
            self._chip.bus.close()
            self._let_out(False)

    def _let_out(self, is_on: bool) -> None:
        """Set OE, if it is wired."""
        if self._enable is not None:
            self._are_off = False
            (self._enable.on if is_on else self._enable.off)()
            self._are_off = not is_on

    def _run(self) -> float:
        self.step()
        if self._failures:
            return _RETRY_S
        self._changed.wait(_LOOK_S)
        self._changed.clear()
        return 0.0

    def _next(self) -> dict[int, int]:
        """The first wanted channel, and those next to it, which one transfer writes."""
        changes: dict[int, int] = {}
        with self._lock:
            channel = min(self._wanted, default=0)
            while channel in self._wanted and len(changes) < AT_ONCE:
                changes[channel] = self._sent[channel] = self._wanted.pop(channel)
                channel += 1
        return changes


class Pca9685Pulses:
    """Satisfies `companion.hal.interfaces.PulseOutput` with one channel.

    A chip that does not answer, or had to be set up again, is an error of the next write: the boat stops its
    motors and says so.
    """

    def __init__(
        self, board: Pca9685Board, setting: PulseOutputSetting, release: Callable[[], None] = lambda: None
    ) -> None:
        """release: called once, at `close`."""
        self._board = board
        self._setting = setting
        self._release = release
        self._width_us = 0.0  # 0: no pulses
        self._dips = board.dips
        self._is_closed = False

    def write_us(self, width_us: float) -> None:
        """Send pulses of this width, limited to the setting's. Raises HardwareError: closed, or the chip lost
        its settings in a dip of its supply; SilentOutputsError: no answer.
        """
        if self._is_closed:
            raise HardwareError(f"PCA9685 channel {self._setting.channel}: written to after close")
        width_us = self._setting.limited_us(width_us)
        self._put(width_us)
        self._board.check()

    def off(self) -> None:
        if not self._is_closed:
            self._put(0.0)

    def close(self) -> None:
        """No more pulses, then release the channel. May be called twice."""
        if self._is_closed:
            return
        self.off()
        self._is_closed = True
        self._release()

    def _put(self, width_us: float) -> None:
        has_dipped, self._dips = self._dips != self._board.dips, self._board.dips
        if has_dipped and width_us:
            self._width_us = 0.0
            raise HardwareError(f"PCA9685 channel {self._setting.channel}: its supply dipped")
        if has_dipped or width_us != self._width_us:
            self._board.put(self._setting.channel, width_us)
            self._width_us = width_us


_boards: dict[tuple[int | str, int], Pca9685Board] = {}  # open chips by bus and address
_enables: dict[int, OutputEnable] = {}  # by pin; held high without a chip, until the program ends
_opening = threading.Lock()


def open_pca9685_pulses(setting: PulseOutputSetting, part: Pca9685Part) -> Pca9685Pulses:
    """Open a channel, without pulses. Its first channel opens the chip, its last closes it.
    Raises HardwareError: smbus2 is missing, there is no bus, or nothing answers at the address.
    """
    with _opening:
        place = (part.i2c_bus, part.address)
        board = _boards.get(place)
        if board is None:
            enable = _output_enable(part.output_enable)
            chip = open_i2c_part("PCA9685", part.i2c_bus, part.address, lambda bus: Pca9685(bus, part))
            board = Pca9685Board(chip, enable)
            board.start()
            _boards[place] = board
        board.users += 1

    def release() -> None:
        with _opening:
            board.users -= 1
            if not board.users:
                del _boards[place]
                board.close()

    return Pca9685Pulses(board, setting, release)


def _output_enable(pin: int) -> OutputEnable | None:
    """OE, driven high at first; the chip's outputs stay off until its set-up is done."""
    if pin < 0:
        return None
    if pin not in _enables:
        with opening_pins("PCA9685") as gpiozero:
            _enables[pin] = gpiozero.OutputDevice(pin, active_high=False, initial_value=False)
    return _enables[pin]


def replace_pca9685_pulses(channel: int, width_us: float, part: Pca9685Part) -> None:
    """From outside the program: give pulses another width; 0: end those of every channel.
    Raises HardwareError: there is no bus, or nothing answers at the address.
    """

    def replace(bus: I2cBus) -> None:
        chip = Pca9685(bus, part, sets_up=False)
        if width_us:
            chip.write(channel, chip.steps(width_us))
        else:
            chip.all_off()
        bus.close()

    open_i2c_part("PCA9685", part.i2c_bus, part.address, replace)
