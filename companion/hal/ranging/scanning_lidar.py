"""Scanning lidars on a serial port: LDROBOT LD06, LD19 and STL-19P; Slamtec RPLIDAR A1."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Final

from companion.config.sensors import LidarPart
from companion.core.drain import drain
from companion.core.readings import SonarReading
from companion.hal.port_sensor import PortSensor
from companion.links.interfaces import Port
from companion.links.port_url import open_line
from companion.links.serial_port import LineFormat
from companion.sensors.framing import FrameReader
from companion.sensors.lidar import ld06, rplidar
from companion.sensors.lidar.sectors import SECTORS, Ray, SectorScan

_REST_S: Final = 0.02  # a tick of the boat
# DTR low turns the motor of an A1 on its USB adapter (rplidar_sdk, net_serial.cpp: clearDTR)
_MOTOR_ON: Final = LineFormat(is_ready=False)
_STOP_S: Final = 0.1  # after STOP, as rplidar_sdk
_RESET_S: Final = 2.0  # an A1 starts again in a second
_SILENT_S: Final = 3.0  # its motor needs a second to turn steadily


class ScanningLidar(PortSensor[Sequence[SonarReading]]):
    """One that sends by itself. Satisfies `companion.hal.interfaces.Sonar` by the readings of its sectors."""

    reader: FrameReader

    def __init__(self, port: Port, now: Callable[[], float], part: LidarPart) -> None:
        super().__init__(port, now, _REST_S)
        self.reader = ld06.Ld06Reader()
        self._ray_s = ld06.RAY_S
        self._scan = SectorScan(part)
        self._readings: deque[SonarReading] = deque(maxlen=4 * SECTORS)

    def read(self) -> Sequence[SonarReading]:
        """The readings since the last call, oldest first."""
        return drain(self._readings)

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """No effect: it turns all round."""

    def _rays(self, frames: Sequence[bytes]) -> list[Ray]:
        return ld06.rays_of(frames)

    def _decode(self, chunk: bytes, time_s: float) -> tuple[()]:
        self._readings += self._scan.add(self._rays(self.reader.split(chunk)), time_s, self._ray_s)
        return ()

    def _forget(self) -> None:
        self.reader.forget()


class Rplidar(ScanningLidar):
    """Stopped, asked for its health, and started; again whenever it is silent."""

    def __init__(self, port: Port, now: Callable[[], float], part: LidarPart) -> None:
        super().__init__(port, now, part)
        self.reader = rplidar.RplidarReader()
        self._ray_s = rplidar.RAY_S
        self._health = rplidar.GOOD
        self._has_stopped = False
        self._due_s = now()

    def step(self) -> None:
        """Process received bytes; start the part if it is silent. Never waits."""
        super().step()
        if self._now() < self._due_s:
            return
        self._has_stopped = not self._has_stopped
        if self._has_stopped:
            self._request(rplidar.STOP, _STOP_S)
        else:
            self.reader.forget()
            self._request(rplidar.GET_HEALTH, _SILENT_S)

    def _request(self, request: bytes, patience_s: float) -> None:
        self._due_s = self._now() + patience_s
        for link in self._links:
            link.send(request)

    def _rays(self, frames: Sequence[bytes]) -> list[Ray]:
        for health in filter(None, map(rplidar.health_of, frames)):
            self._on_health(*health)
        rays = rplidar.rays_of(frames)
        if rays:
            self._due_s = self._now() + _SILENT_S
        return rays

    def _on_health(self, status: int, code: int) -> None:
        if status != self._health:
            severity, text = rplidar.HEALTH.get(status, rplidar.HEALTH[rplidar.ERROR])
            self.notify(severity, f"Lidar: {text}, code {code:#06x}")
        self._health = status
        if status >= rplidar.ERROR:
            self._request(rplidar.RESET, _RESET_S)
        else:
            self._request(rplidar.SPIN + rplidar.SCAN, _SILENT_S)


def open_lidar(part: LidarPart, now: Callable[[], float]) -> ScanningLidar:
    """Open the lidar on its port and start reading. Raises as `open_line`."""
    if part.driver == "rplidar_a1":
        port = open_line(part.port, part.baud or rplidar.BAUD, now, _MOTOR_ON)
        return Rplidar(port, now, part).start()
    return ScanningLidar(open_line(part.port, part.baud or ld06.BAUD, now), now, part).start()
