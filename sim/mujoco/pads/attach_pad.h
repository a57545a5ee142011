// Pads in a model that is being put together by MuJoCo's mjSpec: what slipbench.mujoco.attach_pad() of tools/python does, for C++.
// README.md shows a call; MuJoCo must know the plugin before (mj_loadPluginLibrary() or register_field_plugin()). The sensor has the pad's name, and
// pad_instance.h says what stands in its sensordata.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

struct mjSpec_;

namespace slipbench {

// What a pad is, in the words of pad_instance.h.
struct PadOptions {
  // A sensor's name, one with parameters ({type: papillarray, bristles: 6}), or elements ([[x, y, z, k_n, k_t], ...]).
  std::string pad = "papillarray";
  std::string name{};      // of the instance and its sensor; default: that of the site
  std::string friction{};  // 0.5, or {static: 0.5, kinetic: 0.4}
  std::string material{};
  std::string effects{};            // a list, as in a scene
  std::string solver = "explicit";  // or implicit, for which integrator, iterations and cone are set and tendons added
  std::optional<double> damping{};  // s
  bool truth = true;                // whether the sensor reads the truth, too
  std::uint64_t seed = 0, trial = 0;
  std::string check = "error";  // or warn
  std::string unloaded = "1";   // or nan
};

// A pad of a model, as complete_pad() wants to know it: MuJoCo does not tell what a plugin's attributes are.
struct AttachedPad {
  std::string name;  // of the instance and its sensor, without what mjs_attach() puts before or behind it
  std::string site;
  std::vector<std::string> touch;
  bool implicit;
};

// Puts a pad on a site, with a sensor that reads it, and calls complete_pad(). `touch`: names of geoms, body:NAME, subtree:NAME, group:N. Works
// before and after mjs_attach(). Throws InputError for a site that is not there, a name that is taken, a `check` that is not known, and where
// MuJoCo does not know the plugin; other mistakes are errors of mj_compile().
AttachedPad attach_pad(mjSpec_* spec, const std::string& site, const std::vector<std::string>& touch,
                       const PadOptions& options = {});

// Adds what every pad of this name needs and the model lacks: excludes between what moves with it and what it touches, and for implicit pads options
// and tendons. Call it on a spec to which one with the pad has been attached. What the pad names and the spec does not have is left for mj_compile()
// to refuse.
void complete_pad(mjSpec_* spec, const AttachedPad& pad);

}  // namespace slipbench
