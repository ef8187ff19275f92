"""Laws as the input of DEM codes."""
