"""The tables of "Tactile-Driven Grasp Stability and Slip Prediction", Robotics 2019."""
