"""Studies: cases that differ in the values of some keys, computed in parallel processes."""
