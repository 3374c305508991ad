"""CalibrationRunner afloat: the boat measures its thrusters and finds its heading gains by itself."""
