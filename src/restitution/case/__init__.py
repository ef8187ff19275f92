"""The case file: pure data in SI units. Nothing is solved here."""
