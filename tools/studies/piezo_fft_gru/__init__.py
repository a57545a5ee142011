"""The tables of "Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor"."""

SCENE = "scenes/piezo_skin/dataset.yaml"
