"""The tables of "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor"."""
