"""One quasi-static contact: its bodies and gap, its elastic equilibrium, yield and adhesion."""
