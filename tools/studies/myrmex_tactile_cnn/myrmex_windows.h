// Windows of the Myrmex bench as networks learn from them: spectra, and classes by the paper's rule and by the truth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::reproduce {

inline constexpr std::size_t kinds = 3;  // classes of train::ClassRule::kind: stable, translation, rotation

// Whose word it is that the object slips, and how.
enum class SlipWord {
  truth,   // from the true onset (true_slip) to the end of contact; class by how the object was placed
  bench,   // the paper's: from the onset by the third sensor to the end of contact by the arrays; class likewise
  motion,  // as truth, but the class is that of the slipping taxels' motion, ClassRule::kind
};
inline constexpr std::size_t slip_words = 3;

inline constexpr double last_seconds = 0.5;  // before the true onset: the windows that are hard to tell

// One window of one array; class and time are those of its last sample.
struct MyrmexWindow {
  double time = 0.0;                                           // s
  double to_onset = std::numeric_limits<double>::quiet_NaN();  // s, from here to the true onset; NaN: the trial holds
  std::array<std::uint8_t, slip_words> label{};                // by SlipWord; train::masked: after the end
  std::array<bool, slip_words> drawn{};                        // is one of those that are learnt from and judged, by SlipWord
  std::uint8_t turn = 0;       // its images are turned by so many times 30 degrees; such a copy only learns
  std::vector<float> spectra;  // [12 x 12 taxels, 32 bins] amplitudes

  [[nodiscard]] bool late() const { return to_onset > 0.0 && to_onset <= last_seconds; }
};

struct MyrmexTrial {
  std::string object;       // "cylinder", "remote", "glass"
  bool rotational = false;  // its centre of mass lies to the side of the grip
  bool slips = false;       // by the truth
  std::vector<MyrmexWindow> windows;
};

// How an object falls out of the grip, in s of the trial.
struct SlipSpan {
  std::optional<double> onset;  // empty: it holds
  double end = 0.0;             // of contact
};

// The class at time t of a trial that slips by `span` with class `kind`; train::masked after the end.
std::uint8_t kind_at(double t, const SlipSpan& span, std::uint8_t kind);

struct WindowOptions {
  std::size_t at_most = 60;  // drawn of each class, array and word
  std::size_t turned = 0;    // copies of each window with its image turned, 0 to 11; the angles are drawn by trial
  std::uint64_t seed = 1;    // of RandomStream(seed, trial, "windows")
};

// Windows of `left` and `right` of a trial of scenes/myrmex/dataset.yaml: those drawn, and all that are late().
MyrmexTrial myrmex_trial(const Scene& scene, const TrialRecord& record, const WindowOptions& options);

// Where a window is.
struct WindowPlace {
  std::size_t trial = 0, window = 0;
};

// As many of each class, of those that are not turned: of the drawn windows by `word`, all of the rarest class; the others are drawn by
// RandomStream(seed, 0, "balance"). `late`: the stable ones are late(). Ordered by trial and window.
std::vector<WindowPlace> balanced_windows(const std::vector<MyrmexTrial>& trials, SlipWord word, bool late, std::uint64_t seed);

// What no network is judged on after it has learnt from it.
enum class MyrmexSplit {
  window,  // the paper's: of each class every n-th window in turn; its neighbours, which share 56 of its 64 ms, are learnt from
  trial,   // trials, dealt out by object, placement and whether they slip
  object,  // cylinder, remote, glass
};

// The fold of each place: of `count`, of objects as many as there are.
std::vector<std::size_t> window_folds(const std::vector<MyrmexTrial>& trials, const std::vector<WindowPlace>& places,
                                      SlipWord word, MyrmexSplit split, std::size_t count, std::uint64_t seed);

}  // namespace slipbench::reproduce
