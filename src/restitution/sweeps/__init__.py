"""Studies: a case swept over values, computed on many processes."""
