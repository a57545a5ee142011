// Which settings `slipbench cost` tries on a scene: each is a list of changes that a user could give with --set.
#pragma once

#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "sim/scene/scene.h"

namespace slipbench::cost {

struct Setting {
  std::string series;             // name of its Series: "field"
  std::string label;              // within the series: "1 ms"
  std::vector<Override> changes;  // on top of the user's own; empty: the scene as it is
};

// Settings that differ in one thing and make one curve.
struct Series {
  std::string name;   // "field"
  std::string title;  // "element field, explicit"
  // The series' finest setting, the last, stands for the truth, and not the reference of the scene: the settings are other models of the
  // same sensor, which do not converge to the scene's own.
  bool own_reference = false;
};

const std::vector<Series>& all_series();
// That of a setting.
const Series& series_of(const Setting& setting);

// The fastest of the rates [Hz] that the scene's sensors are given; 0 where none has one.
double fastest_rate(const Scene& scene);

// Whether MuJoCo's own contact, which knows one coefficient of friction, has to take the static one for the kinetic one too.
bool one_friction(const Scene& scene);

// All settings that suit the scene, the scene's own not among them; those of a series from coarse to fine. What the scene's kind refuses
// as such (an integrator where nothing is integrated) is left out; what a scene could have and this one may not (a step that is too long)
// is not. `own`: the step of the fastest sensor's pad [s].
std::vector<Setting> settings_to_try(const Scene& scene, double own);

// The scene itself with a step of `time_step` [s], at its own output rate.
Setting finer(double time_step);

// A step as a scene writes it, exact: "0.05 ms".
std::string step_text(double time_step);
// The same for a person, to four digits: "227.3 us".
std::string short_text(double time_step);

}  // namespace slipbench::cost
