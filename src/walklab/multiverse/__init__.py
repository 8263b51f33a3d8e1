"""The study under other choices: what each claim owes to what the paper leaves open and to uncertain constants."""
