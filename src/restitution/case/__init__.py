"""The case file: reading, checks, and its content as data in SI units. Nothing is solved here."""
