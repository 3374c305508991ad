"""Substitute for a receiver or compass that is not fitted: readings come over MAVLink instead."""


class Absent:
    """Has no readings. Satisfies `Gnss` and `Compass`."""

    def read(self) -> None:
        """Nothing."""

    def close(self) -> None:
        """Nothing to let go."""
