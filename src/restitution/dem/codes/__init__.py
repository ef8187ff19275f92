"""One module for each DEM code: `write(table, velocity)` returns file names and their texts."""
