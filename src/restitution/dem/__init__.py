"""Export of restitution laws to codes of the discrete element method (DEM)."""
