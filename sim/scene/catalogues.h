// The names that a scene may use. Filled by the code that composes the program, so that the parser
// depends on no effect or sensor.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// A surface material: friction against the pads' silicone.
struct Material {
  std::string name;
  double mu_static;
  double mu_kinetic;
  std::string source;  // origin of the figures, or "assumed: why"
};

// A named set of defaults: path of a scene's key -> its value unless the scene sets it.
struct Protocol {
  std::string name;
  std::map<std::string, std::string> defaults;
};

// An expectation that a scene may have of its trials. The first parameter of each is `limit`, the
// LIMIT in `expect: {NAME: LIMIT}`.
struct ExpectationEntry : Entry {
  bool of_grasp = false;     // needs a gripper
  bool of_detector = false;  // needs a detector
};

// The catalogues, by the scene key that uses them.
struct Catalogues {
  std::vector<Material> materials;
  std::vector<Entry> surfaces;           // surface.shape
  std::vector<Entry> motions;            // motion.kind; the first one that is not in arm_motions is the default of a stage
  std::vector<std::string> arm_motions;  // those of a grasp's arm, the default first
  std::vector<Entry> sensors;            // sensors.*.type
  // sensors.*.electronics: the parts of each sensor type, those of `typical`
  std::map<std::string, std::vector<Entry>> electronics;
  std::vector<Entry> effects;       // effects
  std::vector<Entry> bodies;        // bodies.*.shape
  std::vector<Entry> grasp;         // box, grip, scatter: one entry each
  std::vector<Protocol> protocols;  // grip.protocol
  // Returns the time [s] at which the motion `lift` with these parameters has raised the arm; no
  // trial may end before. Null: no limit.
  double (*lift_end)(const Parameters& motion) = nullptr;
  std::vector<Entry> detectors;                // detector.type
  std::vector<Entry> controllers;              // controller.type
  std::vector<ExpectationEntry> expectations;  // expect
};

}  // namespace slipbench
