"""Read and check the case file, and hold its content as data in SI units. Nothing is solved."""
