"""The tables of "Tactile Convolutional Networks for Online Slip and Rotation Detection"."""
