"""Box-constrained minimisation of a convex quadratic, and its multilevel start."""
