"""Results in files: written safely, and read and checked in one place."""
