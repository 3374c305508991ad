"""Link statistics."""

from dataclasses import dataclass


@dataclass(slots=True)
class Counters:
    """Statistics of one link.

    bad_frames: places where invalid bytes were skipped, bad_crc among them; unknown: frames of messages not
    in the dialect; lost: gaps in sequence numbers.
    """

    bytes_in: int = 0
    bytes_out: int = 0
    frames_in: int = 0
    frames_out: int = 0
    bad_frames: int = 0
    bad_crc: int = 0
    unknown: int = 0
    lost: int = 0
