"""The curve of restitution: points, interpolation, and the loop over depths that makes them."""
