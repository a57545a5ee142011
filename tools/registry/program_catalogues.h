// Composes everything that a scene may name in this program: catalogues, detectors, controllers,
// expectations.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/controller_kinds.h"
#include "detectors/hd/engine.h"
#include "sim/api/detector.h"
#include "sim/api/simulation.h"
#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {

enum class FrameSpacing;  // detectors/detector_kinds.h
struct DetectorKind;

Catalogues program_catalogues();
// The same without types registered in this process: those of the command line.
Catalogues command_line_catalogues();

// Expectations that a scene may have of its trials, and their evaluation.

// One kind of expectation.
struct ExpectationKind {
  enum class Comparison {
    at_most,   // observed <= limit; an event that never happened fails
    at_least,  // observed >= limit; an event that never happened passes
    equal,     // a flag
  };

  ExpectationEntry about;
  Comparison comparison = Comparison::at_most;
  double (*observed)(const TrialOutcome&) = nullptr;  // SI, a flag as 0 or 1; NaN: never happened, or no value
  bool of_box = false;                                // concerns the fate of the box, not the grip
  const char* absent = "never";                       // text for users without a value

  // True if a trial keeps the expectation. `limit`: SI, a flag as 0 or 1.
  [[nodiscard]] bool kept(double observed, double limit) const;
  // Badness of an observation: larger is worse; infinite for a required event that never happened.
  [[nodiscard]] double badness(double observed) const;
  // The expectation's parameter `limit` in SI, a flag as 0 or 1.
  [[nodiscard]] double limit(const Parameters& parameters) const;
};

// Which closing commands of a controller answer a slip. For registered controllers and plugins the
// default is Answers::by_own_rule.
Answers answers_of(const Named& controller);

// All expectations that a scene may list under `expect`.
const std::vector<ExpectationKind>& expectation_catalogue();

// `parameters`: all those of the detector's entry.
using DetectorMaker = std::function<std::unique_ptr<Detector>(const Parameters& parameters, const FrameSource& source)>;

// Registers a detector of the embedding application. Scenes of this process may then name it; it
// replaces a detector registered under that name before. Thread-safe. Throws InputError if the name
// is not an identifier or belongs to the program.
void register_detector(const Entry& about, DetectorMaker make);

// Allowed values of detector.type besides none, the oracle included. Every one has the parameter
// flip.
std::vector<Entry> detector_entries();

// Catalogue entry of a detector of the program; null for other types, such as registered ones.
const DetectorKind* detector_kind(const std::string& type);

// DetectorKind::spacing of a detector of this type; `even` for those of register_detector().
FrameSpacing frame_spacing(const std::string& type);

// Creates the detector that `scene` describes for the frames of `source`, with the flips that the
// scene asks for. Only the oracle reads `simulation`, which must outlive it. Throws InputError for
// an unknown type, and as the detector's constructor does.
std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source, const Simulation& simulation);

// As above for recorded frames without a simulation. Throws InputError for the oracle too.
std::unique_ptr<Detector> make_detector(const DetectorScene& scene, const FrameSource& source);

// Throws SceneValueError if `scene` names a trial beyond the first `trials`, at least one.
void check_run(const DetectorScene& scene, std::uint64_t trials);

// Engines of the hyperdimensional classifier, in C++ and in hardware.

// "kernel", "reference", "rtl".
std::vector<std::string> hd_engine_names();

// Creates the engine of that name. Throws InputError for an unknown name, and as the engine's
// constructor does.
std::unique_ptr<hd::Engine> make_hd_engine(std::string_view name, const hd::Model& model, const hd::Memories& memories);

// All controllers of the program that a scene may name as controller.type, besides none.
const std::vector<ControllerKind>& controller_catalogue();

// `parameters`: all those of the controller's entry.
using ControllerMaker = std::function<std::unique_ptr<Controller>(const Parameters& parameters, const GripSource& source)>;

// Registers a controller, as register_detector() does a detector.
void register_controller(const Entry& about, ControllerMaker make);

// Entries of all controllers: the program's own in the same order, then the registered ones.
std::vector<Entry> controller_entries();

// Catalogue entry of a controller of the program; null for other types, such as registered ones.
const ControllerKind* controller_kind(const std::string& type);

// Names of the sensors, detectors and controllers whose code is not part of slipbench: plugins and
// registered types.
std::set<std::string> users_types();

// Creates the controller `controller.name` with its parameters for `source`. Throws InputError for
// an unknown name, and as the controller's constructor does.
std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source);

}  // namespace slipbench
