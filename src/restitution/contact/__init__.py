"""One quasi-static contact: bodies, gap, elastic equilibrium, yield and adhesion."""
