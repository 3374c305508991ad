"""The vehicle: a MAVLink surface boat on a Raspberry Pi."""

__version__ = "0.2.0"
