// What a scene may name. Filled by whoever composes the program, so that the parser depends on no effect and no sensor.
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
  std::string source;  // where the figures come from, or "assumed: why"
};

// A named set of defaults: path of a scene's key -> what stands there unless the scene says otherwise.
struct Protocol {
  std::string name;
  std::map<std::string, std::string> defaults;
};

// What a scene may ask of its trials. The first parameter of each is `limit`, which is what `expect: {NAME: LIMIT}` gives.
struct ExpectationEntry : Entry {
  bool of_grasp = false;     // only where there is a gripper
  bool of_detector = false;  // only where there is a detector
};

// The catalogues, by the scene key that draws from them.
struct Catalogues {
  std::vector<Material> materials;
  std::vector<Entry> surfaces;  // surface.shape
  std::vector<Entry> motions;   // motion.kind
  std::vector<Entry> sensors;   // sensors.*.type
  std::map<std::string, std::vector<Entry>>
      electronics;                  // sensors.*.electronics: by type the parts that it has, those of `typical`
  std::vector<Entry> effects;       // effects
  std::vector<Entry> bodies;        // bodies.*.shape
  std::vector<Entry> grasp;         // box, grip, scatter: one entry each
  std::vector<Protocol> protocols;  // grip.protocol
  // The time [s] at which the motion `lift` with these parameters has raised the arm, which no trial may end before; null: any may.
  double (*lift_end)(const Parameters& motion) = nullptr;
  std::vector<Entry> detectors;                // detector.type
  std::vector<Entry> controllers;              // controller.type
  std::vector<ExpectationEntry> expectations;  // expect
};

// The materials that a surface may be made of.

// Friction of the pads' silicone on each material, dry unless the name says otherwise.
std::vector<Material> material_table();

}  // namespace slipbench
