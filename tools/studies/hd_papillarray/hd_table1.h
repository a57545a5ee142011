// What Table I runs: four encoders, taught and judged on datasets of the published protocol, one thing changed at a time.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/base/files/output_file.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/train/train_hd.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

inline constexpr const char* hexapod_scene = "scenes/papillarray/hexapod.yaml";

// sHDC, stHDC, gstHDC and CL-gstHDC, all else as in `base`.
std::array<hd::Model, 4> ablation(const hd::Model& base);

// Which frames are learnt from and judged.
enum class KeptFrames {
  all,
  until_stop,  // nothing after the motion has ended
  moving,      // nothing before it has begun either
};

// One way to make the data, to label it and to encode it.
struct EncoderVariant {
  std::string name;
  std::vector<Override> overrides = {};  // of the scene
  SlipRule labels = SlipRule::paper;
  hd::Quantiser quantiser = hd::Quantiser::fixed_point;
  hd::Model model = {};
  std::uint64_t other_memories = 0;  // added to the seed of the item memories
  KeptFrames keep = KeptFrames::all;
};
std::vector<EncoderVariant> cause_variants();    // one thing changed at a time
std::vector<EncoderVariant> scatter_variants();  // what differs between sequences; all of them need data of their own

using EncoderDraws = std::array<std::vector<Evaluation>, 4>;  // of the four models

// Runs variants one after the other. A variant that needs no other dataset than the one before it takes that one's.
class EncoderAblation {
 public:
  // `options` must outlive it.
  explicit EncoderAblation(const ReproduceOptions& options) : options_(options), seed_(options.seed.value_or(1)) {}

  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  [[nodiscard]] const TrainingData& data() const { return data_; }  // of the last variant

  // The four models under a variant, split by sequence. `by_frame`: filled as well where given. Throws InputError and
  // Interrupted.
  EncoderDraws run(const EncoderVariant& variant, EncoderDraws* by_frame = nullptr);

 private:
  void read(const EncoderVariant& variant);

  const ReproduceOptions& options_;
  std::uint64_t seed_;
  InterruptGuard guard_{"ending after the step at hand"};  // lets the folder be removed
  ScratchFolder folder_;
  std::string path_;  // of the dataset at hand
  std::string key_;   // what made it
  SlipRule labels_{};
  KeptFrames keep_ = KeptFrames::all;
  TrainingData data_;
};

}  // namespace slipbench::reproduce
