// Adds pads to a model under construction by MuJoCo's mjSpec: the C++ counterpart of
// slipbench.mujoco.attach_pad() in python. README.md shows a call; MuJoCo must know the
// plugin before (mj_loadPluginLibrary() or register_field_plugin()). The sensor has the pad's
// name; pad_readout.h describes its sensordata.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

struct mjSpec_;

namespace slipbench {

// Settings of a pad, in the syntax of pad_config.h.
struct PadOptions {
  // A sensor's name, one with parameters ({type: papillarray, bristles: 6}), or elements ([[x, y,
  // z, k_n, k_t], ...]).
  std::string pad = "papillarray";
  std::string name{};      // of the instance and its sensor; default: the site's
  std::string friction{};  // 0.5, or {static: 0.5, kinetic: 0.4}
  std::string material{};
  std::string effects{};  // a list, as in a scene
  // Or implicit: then integrator, iterations and cone are set, and tendons are added.
  std::string solver = "explicit";
  std::optional<double> damping{};  // s
  bool truth = true;                // true: the sensor also reads the truth
  std::uint64_t seed = 0, trial = 0;
  std::string check = "error";  // or warn
  std::string unloaded = "1";   // or nan
};

// A pad of a model for complete_pad(): MuJoCo does not report a plugin's attributes.
struct AttachedPad {
  // Name of the instance and its sensor, without prefix or suffix of mjs_attach().
  std::string name;
  std::string site;
  std::vector<std::string> touch;
  bool implicit;
};

// Adds a pad at a site, with a sensor that reads it, and calls complete_pad(). `touch`: names of
// geoms, body:NAME, subtree:NAME, group:N. Works before and after mjs_attach(). Throws InputError
// for a site that does not exist, a name already in use, an unknown `check`, and if MuJoCo does not
// know the plugin; mj_compile() reports other mistakes.
AttachedPad attach_pad(mjSpec_* spec, const std::string& site, const std::vector<std::string>& touch,
                       const PadOptions& options = {});

// Adds settings that every pad of this name needs and the model lacks: excludes between the bodies
// that move with the pad and those that it touches, and for implicit pads options and tendons. Call
// it on a spec to which one with the pad has been attached. Names that the spec does not contain
// are left for mj_compile() to refuse.
void complete_pad(mjSpec_* spec, const AttachedPad& pad);

}  // namespace slipbench
