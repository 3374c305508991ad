"""A receiver and a compass that are not there: the boat is told where it is over MAVLink instead."""


class Absent:
    """Never has a reading. Satisfies `Gnss` and `Compass`."""

    def read(self) -> None:
        """Nothing."""

    def close(self) -> None:
        """Nothing to let go."""
