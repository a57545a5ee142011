"""The tables of "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation", IEEE RA-L 2020."""
