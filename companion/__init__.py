"""The vehicle: a MAVLink surface boat on a Raspberry Pi."""
