// Grasps and touches of BioTac SP, real and synthetic, as the paper's networks learn from them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/recipes/biotac.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::biotac {

using train::biotac::electrodes;

inline constexpr std::size_t fingers = 3;  // ff, mf, th

// The hand's poses as the paper counts them.
struct Palm {
  const char* text;      // "0": degrees
  const char* imported;  // "down": the real sets' word
  const char* model;     // "hand_down.xml": the scene's
};
inline constexpr std::array<Palm, 3> palms{
    {{"0", "down", "hand_down.xml"}, {"90", "side", "hand_side.xml"}, {"45", "45", "hand_45.xml"}}};

// A grasp at the moment of the paper's snapshot, before the lift, and how it ended.
struct Grasp {
  std::vector<float> counts;  // [fingers, electrodes]
  std::string object;
  std::size_t palm = 0;  // of palms
  bool slipped = false;
};

// Of a trial with sensors ff, mf and th: one that was imported from bts3v2, or one of scenes/biotac_sp/grasp.yaml, whose snapshot is the last row
// before hold.from. Throws InputError where it is neither.
Grasp grasp_of(const TrialRecord& record);

// Throws InputError where the recordings of --data are imported: they would stand in the tables as synthetic.
void check_simulated(const std::string& path);

// Those of a dataset, read in a child process. `options`: whom it tells. Throws InputError, naming the file.
std::vector<Grasp> read_grasps(const std::string& path, const ReproduceOptions& options);
// Those of grasp.yaml: `draws` of each of its nine cells, 0: as many as it says. Throws as run_grid.
std::vector<Grasp> run_grasps(std::size_t draws, const ReproduceOptions& options);

// Each count less its mean over the grasps with that palm, over its standard deviation there (1 count at least): what does not depend on the fingers
// that a set was recorded with.
std::vector<Grasp> levelled(std::vector<Grasp> grasps);

// What a network is shown of a grasp, as an example of one frame: the counts as they are; as images [fingers, rows, columns]; by node [electrodes,
// fingers]. Label 1: slipped.
train::FoldExample as_list(const Grasp& grasp);
train::FoldExample as_image(const Grasp& grasp, const train::biotac::ImageLayout& layout);
train::FoldExample as_graph(const Grasp& grasp);

// A recording of one finger that is touched, slides or turns.
struct Touch {
  std::vector<float> counts;        // [T, electrodes], at 100 Hz
  std::vector<std::uint8_t> label;  // [T] t, n, e, s, w, cw, aw; masked where nothing touches
  std::string object;
};

inline constexpr const char* slip_scene = "scenes/biotac_sp/slip.yaml";
inline constexpr const char* random_site_scene = "scenes/biotac_sp/slip_random_site.yaml";
inline constexpr std::size_t devices = 3;  // fingers that a synthetic set is made with

// Those of a dataset, imported from BioTacSP-DoS or of one of the scenes above. `options`: whom it tells. Throws InputError, naming
// the file.
std::vector<Touch> read_touches(const std::string& path, const ReproduceOptions& options);
// Those of a scene: `draws` of each of its cells with each of `devices` fingers. Throws as run_grid.
std::vector<Touch> run_touches(const char* scene, std::size_t draws, const ReproduceOptions& options);

// What is cut out of a recording.
struct Window {
  std::size_t rows = 5, stride = 5;
  bool site = true;                                    // else each electrode's mean over the window is taken off
  const train::biotac::ImageLayout* layout = nullptr;  // frames are images
  enum class Figures { none, by_electrode, sorted } figures = Figures::none;  // one frame of figures instead of the rows
};
// The windows of one recording in which something touches throughout, as examples in which the last frame alone has a label. Figures by electrode:
// 24 standard deviations and 24 slopes of the straight line through the rows [counts a row]; sorted: the standard deviations, the smallest first.
std::vector<train::FoldExample> windows_of(const Touch& touch, const Window& window);

// The number of its fold for each of `objects`, all of one object in the same: the different ones are dealt out by train::folds. Throws InputError
// where there are fewer than `count`.
std::vector<std::size_t> folds_by_object(std::span<const std::string> objects, std::size_t count, std::uint64_t seed);

}  // namespace slipbench::reproduce::biotac
