"""The boat's water, hull and drive for other autopilots: ArduPilot's simulator over its JSON interface."""
