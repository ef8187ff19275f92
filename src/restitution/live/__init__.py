"""A page on this machine that redraws the curves of a case while a reader changes its values."""
