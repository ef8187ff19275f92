"""Arrays only: grids, FFT convolution, box-constrained minimiser, path quadrature."""
