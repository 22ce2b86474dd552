"""The hot loops, compiled by numba: plain arrays in, plain arrays out."""
