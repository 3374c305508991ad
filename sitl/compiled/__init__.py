"""The boat and its emulator as machine code, for campaigns: the same files, through mypyc."""
