// What Table I of the nib pad's paper records, loads of three kinds under one change after the other, and errors of fits to them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/studies/grid.h"
#include "tools/studies/nib_reconfigurable/nib_calibration.h"

namespace slipbench::reproduce {

// The paper: 4000 rows train, 1000 test.
inline constexpr std::size_t fit_rows = 3000, choose_rows = 1000, test_rows = 1000;

enum CalibrationLoad : std::size_t { plate, end_face, lying, load_count };
inline constexpr std::array<const char*, load_count> calibration_scenes{
    "scenes/nib_pad/calibrate_uniform.yaml", "scenes/nib_pad/calibrate_end_face.yaml", "scenes/nib_pad/calibrate_lying.yaml"};
inline constexpr std::array<const char*, load_count> load_names{"uniform", "end face", "lying"};
using LoadRecordings = std::array<CalibrationRecording, load_count>;

// What is changed of the recordings, one thing at a time.
struct CalibrationVariant {
  std::string name;
  std::vector<Override> overrides = {};
  bool averaged_reference = true;
  std::size_t apart = 1;  // so many times as many recordings, of which every so manieth image is kept
};
// The scenes as they are first.
const std::vector<CalibrationVariant>& calibration_variants();

// The recordings of each variant. Throws InputError and Interrupted as run_grid does.
std::vector<LoadRecordings> record_loads(const ReproduceOptions& options);

// Which loads teach and are tested, in equal parts.
struct CalibrationCase {
  const char* name;
  std::vector<CalibrationLoad> loads;
};
const std::array<CalibrationCase, 4>& calibration_cases();

// One fit: of which variant, and how its rows are dealt out.
struct CalibrationFit {
  std::size_t variant;
  const CalibrationCase* loads;
  SplitKind kind;
};
// The RMS error of each fit on its test rows. Throws Interrupted.
std::vector<PadWrench> fit_errors(const std::vector<CalibrationFit>& fits, const std::vector<LoadRecordings>& recordings,
                                  const ReproduceOptions& options);

// A fit of uniform loads, asked about each kind of load: RMS error and mean error.
struct LoadTransfer {
  std::array<PadWrench, load_count> rms, bias;
};
LoadTransfer transfer_of(const LoadRecordings& recordings, std::uint64_t seed);

}  // namespace slipbench::reproduce
