"""Messages of a GNSS receiver, written by pyubx2."""

import math
from dataclasses import dataclass

from pyubx2 import GET, UBXMessage


@dataclass
class Motion:
    """What it measures."""

    lat: float = 50.5
    lon: float = -1.2
    velocity_mm_s: tuple[int, int] = (1200, -300)
    fix_type: int = 3
    fix_ok: int = 1
    carrier: int = 0
    correction_age: int = 0
    invalid_position: int = 0
    h_acc_mm: int = 1500
    s_acc_mm_s: int = 250
    valid: tuple[int, int, int] = (1, 1, 1)
    heading: float = 90.0
    length_m: float = 1.0
    heading_valid: int = 1
    baseline_carrier: int = 2
    heading_accuracy: float = 0.4

    @property
    def course_deg(self) -> float:
        """Over ground."""
        north, east = self.velocity_mm_s
        return math.degrees(math.atan2(east, north)) % 360.0


def sentence(body: str) -> bytes:
    """An NMEA 0183 sentence with its checksum."""
    checksum = 0
    for byte in body.encode():
        checksum ^= byte
    return f"${body}*{checksum:02X}\r\n".encode()


def nav_pvt(tow_ms: int, motion: Motion) -> bytes:
    """NAV-PVT, written by pyubx2."""
    date, clock, resolved = motion.valid
    seconds = tow_ms // 1000 - 216_000
    return bytes(
        UBXMessage(
            "NAV", "NAV-PVT", GET, iTOW=tow_ms,
            year=2024, month=5, day=28, hour=9 + seconds // 3600, min=seconds // 60 % 60, second=seconds % 60,
            validDate=date, validTime=clock, fullyResolved=resolved, nano=tow_ms % 1000 * 1_000_000,
            fixType=motion.fix_type, gnssFixOk=motion.fix_ok, carrSoln=motion.carrier,
            diffSoln=int(motion.carrier > 0 or motion.correction_age > 0), numSV=14,
            lon=motion.lon, lat=motion.lat, hMSL=12_500,
            hAcc=motion.h_acc_mm, vAcc=2 * motion.h_acc_mm, velN=motion.velocity_mm_s[0],
            velE=motion.velocity_mm_s[1],
            gSpeed=round(math.hypot(*motion.velocity_mm_s)), headMot=motion.course_deg,
            sAcc=motion.s_acc_mm_s, pDOP=1.6,
            lastCorrectionAge=motion.correction_age, invalidLlh=motion.invalid_position,
        ).serialize()
    )  # fmt: skip


def nav_relposned(tow_ms: int, motion: Motion) -> bytes:
    """NAV-RELPOSNED, written by pyubx2."""
    return bytes(
        UBXMessage(
            "NAV", "NAV-RELPOSNED", GET, version=1, iTOW=tow_ms,
            relPosLength=round(motion.length_m * 100.0), relPosHeading=motion.heading,
            accHeading=motion.heading_accuracy, gnssFixOK=1, relPosValid=1, carrSoln=motion.baseline_carrier,
            isMoving=1, relPosHeadingValid=motion.heading_valid,
        ).serialize()
    )  # fmt: skip
