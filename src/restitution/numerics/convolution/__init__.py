"""Convolution by FFT: operators, the devices that they run on, and the cache that keeps them."""
