// Everything that a scene may name in this program, put together in one place: catalogues, detectors, controllers, what it may expect.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/controller_kinds.h"
#include "detectors/hd/engine.h"
#include "sim/core/detector.h"
#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

Catalogues program_catalogues();
// The same without what was registered in this process: what the command line knows.
Catalogues command_line_catalogues();

// What a scene may expect of its trials, and how a trial's outcome is held against it.

// One kind of expectation.
struct ExpectationKind {
  enum class Comparison {
    at_most,   // observed <= limit; what never happened does not keep it
    at_least,  // observed >= limit; what never happened keeps it
    equal,     // a flag
  };

  ExpectationEntry about;
  Comparison comparison = Comparison::at_most;
  double (*observed)(const TrialOutcome&) = nullptr;  // SI, a flag as 0 or 1; NaN: it never happened, or has no value
  bool of_box = false;                                // what becomes of the box, not how it is gripped
  const char* absent = "never";                       // what a person reads where there is no value

  // Whether a trial keeps the expectation. `limit`: SI, a flag as 0 or 1.
  [[nodiscard]] bool kept(double observed, double limit) const;
  // How bad an observation is: the larger the worse; infinite for what never happened and should have.
  [[nodiscard]] double badness(double observed) const;
  // The expectation's parameter `limit` in SI, a flag as 0 or 1.
  [[nodiscard]] double limit(const Parameters& parameters) const;
};

// Which tightenings of a controller answer a slip. What is not known of a controller that was
// registered or is a plugin: by its own rule.
Answers answers_of(const Named& controller);

// All kinds that a scene may name in `expect`.
const std::vector<ExpectationKind>& expectation_catalogue();

// `parameters`: those of the detector's entry, all present.
using DetectorMaker = std::function<std::unique_ptr<Detector>(const Parameters& parameters, const FrameSource& source)>;

// From now on a scene of this process may name a detector of whoever has embedded the program; one registered under that name before is
// replaced. Thread-safe. Throws InputError for a name that is no identifier, or that the program itself uses.
void register_detector(const Entry& about, DetectorMaker make);

// What a scene may name as detector.type, beside none: the oracle among them. Every one has the parameter flip.
std::vector<Entry> detector_entries();

// True if a detector of this type takes frames as evenly spaced (DetectorKind::counts_frames), as those of register_detector() may.
bool counts_frames(const std::string& type);

// The detector that `scene` describes, for the frames that `source` says; flipped as the scene asks. `simulation` is for the oracle alone, and must
// outlive it. Throws InputError for a type that the catalogue does not have, and what the detector itself refuses.
std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source, const Simulation& simulation);

// The same where there are recorded frames and no simulation. Throws InputError for the oracle too.
std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source);

// Throws SceneValueError where `scene` names a trial that is not among the first `trials`, at least one.
void check_run(const DetectorScene& scene, std::uint64_t trials);

// Where the engines of the hyperdimensional classifier are composed: in C++, and those that are hardware.

// "kernel", "reference", "rtl".
std::vector<std::string> hd_engine_names();

// The engine of that name. Throws InputError for a name that the catalogue does not have, and what the engine itself refuses.
std::unique_ptr<hd::Engine> make_hd_engine(std::string_view name, const hd::Model& model, const hd::Memories& memories);

// All of the program's own controllers that a scene may name as controller.type, beside none.
const std::vector<ControllerKind>& controller_catalogue();

// `parameters`: those of the controller's entry, all present.
using ControllerMaker = std::function<std::unique_ptr<Controller>(const Parameters& parameters, const GripSource& source)>;

// As register_detector().
void register_controller(const Entry& about, ControllerMaker make);

// The declarations of all: the program's own in the same order, then those that are registered.
std::vector<Entry> controller_entries();

// The controller `controller.name` with its parameters, for `source`. Throws InputError for a name that the catalogue does
// not have, and what the controller itself refuses.
std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source);

}  // namespace slipbench
