#include "tools/studies/hd_papillarray/hd_table1_run.h"

#include <algorithm>
#include <utility>

#include "sim/core/error.h"
#include "tools/base/project/project_file.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench::reproduce {
namespace {

const std::vector<Override> no_friction_scatter{{"friction.scale", "1"}};
const std::vector<Override> no_tilt{{"motion.tilt.0", "0 deg"}, {"motion.tilt.1", "0 deg"}};
const Override wide_friction{"sweep.friction.scale", "{draw: lognormal, median: 1, sd: 0.3}"};
const Override wide_tilt_x{"sweep.motion.tilt.0", "{draw: normal, mean: 0 deg, sd: 2 deg, min: -4 deg, max: 4 deg}"};
const Override wide_tilt_y{"sweep.motion.tilt.1", "{draw: normal, mean: 0 deg, sd: 2 deg, min: -4 deg, max: 4 deg}"};
// Four draws of each motion, so that there are 200 sequences again.
const std::vector<Override> wide_preload{{"sweep.motion.compression", "{draw: uniform, min: 0.5 mm, max: 1.5 mm}"},
                                         {"sweep.trials", "4"}};

std::vector<Override> joined(const std::vector<std::vector<Override>>& parts) {
  std::vector<Override> all;
  for (const std::vector<Override>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::string overrides_key(const std::vector<Override>& overrides) {
  std::string key;
  for (const Override& entry : overrides) key += entry.path + "=" + entry.value + "\n";
  return key;
}

// What is left out is labelled like frames that do not touch: neither learnt nor judged.
void leave_out(Sequence& sequence, KeptFrames keep) {
  if (keep == KeptFrames::all) return;
  const auto first = std::find(sequence.moving.begin(), sequence.moving.end(), 1) - sequence.moving.begin();
  const auto after = sequence.moving.rend() - std::find(sequence.moving.rbegin(), sequence.moving.rend(), 1);
  if (keep == KeptFrames::moving) std::fill_n(sequence.label.begin(), first, PadState::no_contact);
  std::fill(sequence.label.begin() + after, sequence.label.end(), PadState::no_contact);
}

void stop_if_interrupted() {
  if (InterruptGuard::flag()) throw Interrupted();
}

}  // namespace

std::array<hd::Model, 4> ablation(const hd::Model& base) {
  std::array<hd::Model, 4> models{base, base, base, base};
  models[0].encoding = hd::Encoding::spatial;
  models[1].encoding = hd::Encoding::spatial_temporal;
  models[2].encoding = models[3].encoding = hd::Encoding::graph_spatial_temporal;
  for (std::size_t i = 0; i < 3; ++i) models[i].context_driven = false;
  models[3].context_driven = true;
  return models;
}

std::vector<EncoderVariant> scatter_variants() {
  std::vector<EncoderVariant> all{
      {"none, no tilt", joined({no_friction_scatter, no_tilt})},
      {"friction 7 %, no tilt", no_tilt},
      {"none, one tilt for all", no_friction_scatter},
      {"friction 7 %, one tilt for all (hexapod.yaml)", {}},
      {"friction 30 %, one tilt for all", {wide_friction}},
      {"friction 7 %, tilt 2 deg", {wide_tilt_x, wide_tilt_y}},
      {"friction 7 %, one tilt for all, preload 0.5 to 1.5 mm", wide_preload},
      {"friction 30 %, tilt 2 deg, preload 0.5 to 1.5 mm", joined({{wide_friction, wide_tilt_x, wide_tilt_y}, wide_preload})}};
  return all;
}

std::vector<EncoderVariant> cause_variants() {
  std::vector<EncoderVariant> all;
  const auto add = [&all](std::string name, auto&& change) {
    EncoderVariant variant;
    variant.name = std::move(name);
    change(variant);
    all.push_back(std::move(variant));
  };
  add("as published", [](EncoderVariant&) {});
  add("labels strict", [](EncoderVariant& v) { v.labels = SlipRule::strict; });
  add("labels micro", [](EncoderVariant& v) { v.labels = SlipRule::micro; });
  add("labels has_slipped", [](EncoderVariant& v) { v.labels = SlipRule::has_slipped; });
  add("without the rest after a stop", [](EncoderVariant& v) { v.keep = KeptFrames::until_stop; });
  add("moving frames alone", [](EncoderVariant& v) { v.keep = KeptFrames::moving; });
  add("feature exact, from 1/8 mm", [](EncoderVariant& v) { v.quantiser = hd::Quantiser::exact; });
  add("feature unrounded", [](EncoderVariant& v) { v.quantiser = hd::Quantiser::unrounded; });
  add("window 1 frame", [](EncoderVariant& v) { v.model.window = 1; });
  add("window 5 frames", [](EncoderVariant& v) { v.model.window = 5; });
  add("window 30 frames", [](EncoderVariant& v) { v.model.window = 30; });
  add("counts kept in the window (published core)", [](EncoderVariant& v) { v.model.compat = hd::Compat::published_core; });
  add("ties to zero", [](EncoderVariant& v) { v.model.ties = hd::Ties::zero; });
  add("D = 4000", [](EncoderVariant& v) { v.model.dimension = 4000; });
  add("other item memories", [](EncoderVariant& v) { v.other_memories = 1000; });
  add("electronics ideal", [](EncoderVariant& v) { v.overrides = {{"sensors.pad.electronics", "ideal"}}; });
  add("stiff pillars (profile gripper)", [](EncoderVariant& v) { v.overrides = {{"sensors.pad.profile", "gripper"}}; });
  add("pillars slip as a whole (1 bristle)", [](EncoderVariant& v) { v.overrides = {{"sensors.pad.bristles", "1"}}; });
  return all;
}

EncoderDraws EncoderAblation::run(const EncoderVariant& variant, EncoderDraws* by_frame) {
  if (options_.say) options_.say(variant.name);
  read(variant);
  EncoderDraws draws;
  const std::array<hd::Model, 4> models = ablation(variant.model);
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < models.size(); ++i) {
    stop_if_interrupted();
    const hd::Memories memories = hd::generate(models[i], seed_ + variant.other_memories);
    // The last two differ in the prototypes alone.
    if (i < 3) samples = encode(models[i], memories, variant.quantiser, data_.sequences, options_.jobs);
    draws[i] = cross_validate(models[i], memories, data_.sequences, samples, Split::by_sequence, seed_, options_.jobs);
    if (by_frame == nullptr) continue;
    stop_if_interrupted();
    (*by_frame)[i] = cross_validate(models[i], memories, data_.sequences, samples, Split::by_frame, seed_, options_.jobs);
  }
  return draws;
}

void EncoderAblation::read(const EncoderVariant& variant) {
  const std::string key = overrides_key(variant.overrides);
  if (path_.empty() || (key != key_ && options_.data.empty())) {
    path_ = options_.data;
    if (path_.empty()) {
      path_ = folder_.file("hexapod.h5");
      SweepOptions sweep;
      sweep.scene_path = project_file(hexapod_scene);
      sweep.overrides = variant.overrides;
      sweep.seed = seed_;
      sweep.jobs = options_.jobs;
      sweep.output = path_;
      sweep.interrupt = &InterruptGuard::flag();
      run_sweep(sweep, program_catalogues());
      stop_if_interrupted();
    }
    key_ = key;
  } else if (variant.labels == labels_ && variant.keep == keep_) {
    return;
  }
  labels_ = variant.labels;
  keep_ = variant.keep;
  data_ = read_sequences(path_, {labels_, {}});
  for (Sequence& sequence : data_.sequences) leave_out(sequence, keep_);
}

}  // namespace slipbench::reproduce
