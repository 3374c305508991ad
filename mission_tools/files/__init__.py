"""Files that missions are written to besides .plan and QGC WPL 110, each by its suffix."""
