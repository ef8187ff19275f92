"""Energy that an impact loses besides yielding and adhesion: plates, waves, viscosity."""
