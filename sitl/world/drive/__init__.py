"""The drive: one or two thrusters, each a bridge or speed controller, a motor and a propeller; a rudder."""
