"""What was found of one pair, in the form in which DEM codes take it."""
