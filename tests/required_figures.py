"""The figures that every run reports."""

REQUIRED = {
    "sim_seconds",
    "cpu_seconds",
    "real_time_factor",
    "planned_length_m",
    "path_length_m",
    "time_s",
    "cross_track_rms_m",
    "cross_track_max_m",
    "min_clearance_m",
    "waypoints_reached",
    "final_mode",
    "state_hash",
}
