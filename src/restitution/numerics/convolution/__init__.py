"""Convolution by FFT: operators, devices and the cache of operators."""
