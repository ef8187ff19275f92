"""One DEM code a module: `write(matrix, velocity)` returns its input as texts by file name."""
