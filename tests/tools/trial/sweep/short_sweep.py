"""The sweep shared by tests of killed and divided sweeps.

Three speeds times `trials`, some 10 ms each.
"""


def scene_text(trials, duration="0.3 s", bristles=3):
    return f"""slipbench: 1
description: short sweep
duration: {duration}
time_step: 1 ms
seed: 7
surface: {{material: acrylic}}
motion: {{kind: stage, gap: 0 mm, compression: 0.1 mm, approach_speed: 10 mm/s, start: 0.1 s, speed: 4 mm/s, acceleration: 1 m/s2}}
sensors:
  pad: {{type: papillarray, rate: 1 kHz, electronics: typical, bristles: {bristles}}}
sweep:
  motion.speed: [1 mm/s, 4 mm/s, 16 mm/s]
  motion.direction: {{draw: uniform, min: 0 deg, max: 360 deg}}
  trials: {trials}
"""
