"""One DEM code a module: `write(table, velocity)` returns its input as texts by file name."""
