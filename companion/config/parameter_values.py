"""Names of the values of enumerated and bit-mask parameters, as shown by stations.

Numbers are ArduPilot Rover's where the parameter has its name. QGroundControl's menus cut names after about
25 characters.
"""

from companion.core.modes import Mode

Names = tuple[tuple[int, str], ...]
"""Each value, or the number of each bit, with its name."""

DISABLED_ENABLED: Names = ((0, "Disabled"), (1, "Enabled"))
NO_YES: Names = ((0, "No"), (1, "Yes"))

ACTIONS: Names = (
    (0, "Report only"),
    (1, "RTL"),
    (2, "HOLD"),
    (3, "SMART_RTL or RTL"),
    (4, "SMART_RTL or HOLD"),
    (5, "Disarm"),
    (6, "LOITER or HOLD"),
)
STUCK_ACTIONS: Names = (*ACTIONS, (7, "Clear the propellers"))
MOTOR_ACTIONS: Names = (*STUCK_ACTIONS, (8, "Test each motor"))
GROUND_ACTIONS: Names = (*MOTOR_ACTIONS, (9, "Turn free of the shore"))
RC_FAILSAFES: Names = ((0, "Disabled"), (1, "Enabled"), (2, "Enabled except in AUTO"))
RESUMPTIONS: Names = ((0, "Forget it"), (1, "MISSION_START resumes it"), (2, "Resume automatically"))

MODES: Names = tuple((mode.value, mode.rules.title) for mode in Mode)
ARM_DISARM = 153
SWITCHES: Names = ((0, "Do nothing"), (ARM_DISARM, "Arm or disarm"))

# QGroundControl's Frame page leaves out the first entry: for it, that is the undefined class
FRAME_CLASSES: Names = ((0, "Undefined"), (2, "Boat"))
ARMING_CHECKS: Names = ((0, "All"),)
AVOIDED: Names = ((0, "Fence"), (1, "Rangers"), (2, "No effect"))
FENCE_PARTS: Names = ((0, "No effect"), (1, "Circle around home"), (2, "Polygons and circles"))

EXTERNAL_USES: Names = ((0, "Never"), (1, "If own sensor is silent"), (2, "Before the own sensor"))
OBSTACLE_USES: Names = ((0, "Ignored"), (1, "Added to the own sonar"))
LOG_BACKENDS: Names = ((0, "None"), (1, "File"))
LOG_TIMES: Names = ((0, "While armed"), (1, "From boot"))
MOTOR_SOURCES: Names = ((0, "Disabled"), (1, "Throttle"), (2, "Current"))
MISSION_ENDS: Names = ((0, "HOLD"), (1, "LOITER"))
OBSTACLE_ACTIONS: Names = ((0, "Stop before it"), (1, "Go around it"))
OFFSET_AXES: Names = ((0, "North and east"), (1, "Ahead and to starboard"))
SIGHT_LIMITS: Names = (
    (0, "Nowhere"),
    (1, "Everywhere"),
    (2, "Near unmapped obstacles"),
    (3, "Also outside a fence"),
)
SIMPLE_DIRECTIONS: Names = ((0, "Heading at the start"), (1, "North"))
TURN_DIRECTIONS: Names = ((0, "Clockwise"), (1, "Counter-clockwise"))
