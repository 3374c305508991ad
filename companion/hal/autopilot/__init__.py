"""An autopilot as the boat's sensors and outputs: a Pixhawk or its like with ArduPilot Rover, over MAVLink.

`line.py` has the port and the thread, `link.py` the conversation without either. `readings.py` turns messages
into readings, `outputs.py` drives motors and rudder, `mixing.py` is the inverse of Rover's mixer, and
`parameters.py` knows what Rover's parameters must be. The autopilot is no vehicle to the stations:
`services/routed_autopilot.py` makes it a component of the boat where the configuration says so.
"""
