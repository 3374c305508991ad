"""What one link has carried, in numbers."""

from dataclasses import dataclass


@dataclass(slots=True)
class Counters:
    """What went over one link.

    bad_frames counts places where bytes were skipped that were no frame, bad_crc among them; unknown counts
    frames of messages that the dialect does not have; lost is what the senders' sequence numbers say is
    missing.
    """

    bytes_in: int = 0
    bytes_out: int = 0
    frames_in: int = 0
    frames_out: int = 0
    bad_frames: int = 0
    bad_crc: int = 0
    unknown: int = 0
    lost: int = 0
