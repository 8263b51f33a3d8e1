"""Records of runs: what was run, how two runs differ, and how a record is sent to others."""
