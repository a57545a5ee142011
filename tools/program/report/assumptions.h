// What a grasp was computed with, and which of it is not measured.
#pragma once

#include <string>

#include "tools/base/page/json.h"

namespace slipbench::report {

// Every parameter of the entries grip, box, scatter (where the scene has it), of the motion `lift`, of `contact` with fidelity
// mujoco_contact, and the surface's material:
// [{"path": "grip.stiffness", "value": as a scene writes it, "by": "scene" (or the command line), "sweep", "protocol" or "default", "doc",
//   "source", "assumed": the source says so}].
// `scene`: the text of a scene file with a grasp. `overrides`: {path: YAML text} of the command line. `swept`: object whose keys are the swept
// paths; their value is "". `place` names the scene in messages. Throws InputError when the overrides do not fit the scene.
Json grasp_parameters(const std::string& scene, const Json& overrides, const Json& swept, const std::string& place);

}  // namespace slipbench::report
