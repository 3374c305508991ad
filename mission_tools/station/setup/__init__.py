"""What is looked at and set up while a boat is disarmed: its sensors, its calibrations, its motors."""
