"""The MAVLink client of the shore page: frames in, snapshots out, requests answered in words."""
