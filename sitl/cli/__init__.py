"""The emulator's command line, one file a command."""
