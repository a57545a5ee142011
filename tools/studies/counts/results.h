// What the reference scenes cost: the file that keeps it, what grew between two counts, a picture.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace slipbench::counts {

// Names with what they are, in an order to be kept.
using Facts = std::vector<std::pair<std::string, std::string>>;

// Instructions of a function without those it calls.
struct FunctionCount {
  std::string name;
  std::uint64_t instructions = 0;
};

// One trial of a reference scene.
struct SceneCount {
  std::string scene;       // "scenes/papillarray/stage.yaml", from the project's root
  double simulated = 0.0;  // s
  std::uint64_t steps = 0;
  std::uint64_t instructions = 0;
  double cpu_time = 0.0;                 // s, without valgrind; 0: not measured
  std::vector<FunctionCount> functions;  // the dearest first; in a file, the first `stored_functions` of them

  [[nodiscard]] double instructions_per_second() const { return static_cast<double>(instructions) / simulated; }
  [[nodiscard]] double instructions_per_step() const { return static_cast<double>(instructions) / static_cast<double>(steps); }
  [[nodiscard]] double times_real_time() const { return simulated / cpu_time; }  // where the time was measured
};

inline constexpr std::size_t stored_functions = 40;

struct Results {
  Facts build;    // what decides the counts: those of two builds can be compared where all of it is alike
  Facts context;  // what else is worth knowing: version, commit, machine, libraries
  std::vector<SceneCount> scenes;
};

// Short name of a scene: "papillarray/stage".
std::string scene_name(std::string_view path);

// "1,234,567".
std::string grouped(std::int64_t value);
inline std::string grouped(std::uint64_t value) { return grouped(static_cast<std::int64_t>(value)); }

// As JSON, with a line for each function.
std::string results_json(const Results& results);

// Throws InputError, which names `path`, the place in the file and what is allowed there, for text that results_json does not
// write.
Results parse_results(std::string_view text, const std::string& path);

// Reads a file. Throws as parse_results, and where it cannot be read.
Results read_results(const std::string& path);

// What of `build` another one has otherwise: "processor ('x86_64' there, 'x86_64 with AVX2' here)"; empty where all is alike.
std::string differences(const Facts& there, const Facts& here);

// The file in `folder` whose results are of `build`. Throws InputError where there is none, with the difference to each that
// there is and with the command that adds one; where there are two; and for a *.json there that holds no results.
std::string find_results(const std::string& folder, const Facts& build);

// What grew between two counts of the reference scenes.

// Growth of a scene's instructions that is no longer accepted, and shrinkage worth storing.
inline constexpr double allowed_growth = 0.02;

struct FunctionChange {
  std::string name;
  std::uint64_t before = 0;
  std::uint64_t now = 0;
  bool listed = true;  // false: no more than `before` then, since the stored results keep the dearest functions only

  // More instructions now, less where negative; where not listed, at least so many more.
  [[nodiscard]] std::int64_t difference() const { return static_cast<std::int64_t>(now) - static_cast<std::int64_t>(before); }
};

struct SceneChange {
  std::string scene;
  std::uint64_t before = 0;
  std::uint64_t now = 0;
  std::uint64_t steps_before = 0;
  std::uint64_t steps_now = 0;
  std::vector<FunctionChange> functions;  // those that changed, the largest change first

  [[nodiscard]] double growth() const {
    return (static_cast<double>(now) - static_cast<double>(before)) / static_cast<double>(before);
  }
  [[nodiscard]] bool grew() const { return growth() > allowed_growth; }
  [[nodiscard]] bool shrank() const { return growth() < -allowed_growth; }
};

// Throws InputError, which names `path`, the file of `before`, where its build is another or its scenes are not the reference
// scenes.
void check_comparable(const Results& before, const Facts& build, const std::string& path);

// Scene by scene. Both have the same scenes in the same order, `now` with all functions there are and `before` with at least one.
std::vector<SceneChange> compare(const Results& before, const Results& now);

// The reference scenes' cost as a picture.

// An SVG of its own, readable on light and dark pages: for each scene two bars on logarithmic axes, instructions per simulated
// second and times real time, with build and machine below. The same results give the same bytes.
std::string drawing(const Results& results);

}  // namespace slipbench::counts
