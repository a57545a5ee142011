"""The tables of the piezo paper.

"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor".
"""

SCENE = "scenes/piezo_skin/dataset.yaml"
