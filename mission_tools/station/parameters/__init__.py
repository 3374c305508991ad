"""The parameters of a boat: downloaded, described, set, compared with a file. No I/O, no clock, no thread."""
