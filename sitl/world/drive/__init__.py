"""The drive: two thrusters side by side, each a bridge, a brushed motor and a propeller."""
