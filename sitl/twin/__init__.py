"""The emulator of a boat from the logs of its voyages."""
