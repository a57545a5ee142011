// Settings of a scene whose cost and accuracy are compared.
#pragma once

#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "sim/scene/scene.h"

namespace slipbench::cost {

// Settings that `slipbench cost` tries on a scene: each is a list of changes that a user could give
// with --set.
struct Setting {
  std::string series;             // name of its Series: "field"
  std::string label;              // within the series: "1 ms"
  std::vector<Override> changes;  // applied after the user's own; empty: unchanged scene
};

// Settings that differ in one parameter and form one curve.
struct Series {
  std::string name;   // "field"
  std::string title;  // "element field, explicit"
  // True if the series' finest setting, the last, is its reference instead of the scene's: the
  // settings are other models of the same sensor, which do not converge to the scene's own.
  bool own_reference = false;
};

const std::vector<Series>& all_series();
// Series of a setting.
const Series& series_of(const Setting& setting);

// The highest rate [Hz] set for the scene's sensors; 0 if none is set.
double fastest_rate(const Scene& scene);

// True if MuJoCo's own contact, which has one coefficient of friction, must use the static one as
// the kinetic one too.
bool one_friction(const Scene& scene);

// All settings that suit the scene, except the scene's own; those of a series from coarse to fine.
// Omits what the kind of scene refuses in general (an integrator where nothing is integrated), but
// not what only this scene may refuse (a step that is too long). `own`: the step of the fastest
// sensor's pad [s].
std::vector<Setting> settings_to_try(const Scene& scene, double own);

// The scene with a step of `time_step` [s], at its own output rate.
Setting finer(double time_step);

// A step as in a scene file, exact: "0.05 ms".
std::string step_text(double time_step);
// A step for display, to four digits: "227.3 us".
std::string short_text(double time_step);

}  // namespace slipbench::cost
