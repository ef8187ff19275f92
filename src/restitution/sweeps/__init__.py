"""Studies: many cases that differ in swept values, computed in parallel processes."""
