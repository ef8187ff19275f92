"""One quasi-static contact: bodies, gap, influence, equilibrium, paths, resolution."""
