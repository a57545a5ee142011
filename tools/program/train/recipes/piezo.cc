#include <fmt/format.h>

#include "tools/program/train/recipes/families.h"

namespace slipbench::train {
namespace {

constexpr double skin_rate = 10e3;  // Hz

network::Input spectra() {
  network::Input input;
  input.sensor = "piezo_skin";
  input.rate = skin_rate;
  input.channels = {{"signal", {}}};
  input.window = 200;
  input.stride = 100;
  input.centre = true;
  input.transform = network::Transform::log_psd;
  input.low = 50.0;
  input.high = 600.0;
  input.floor = 1.0 / 12.0 / (0.5 * skin_rate);  // counts^2/Hz, of rounding to whole counts: finite in silence
  return input;
}

network::Input raw() {
  network::Input input;
  input.sensor = "piezo_skin";
  input.rate = skin_rate;
  input.channels = {{"signal", {}}};
  input.stride = 100;
  return input;
}

// The paper's clips of 128 frames. Its RMSProp at 8e-4 needs thousands of steps for what Adam at a greater rate reaches in hundreds.
Recipe piezo_recipe(const char* name, const char* summary, const char* row, std::size_t steps, std::size_t batch, double rate) {
  Recipe one;
  one.name = name;
  one.summary = summary;
  one.source = fmt::format(
      "Piezoelectric skin, FFT-GRU slip detection (papers/piezo-fft-gru), sections IV.A and IV.B, Table I: "
      "{}",
      row);
  one.assumed =
      "four layers, which give the numbers of parameters printed; weights of classes in place of balanced drawing, no label smoothing, no penalty "
      "of changes; steps of Adam, whose rate falls to a fiftieth, in place of 200 epochs of RMSProp at 8e-4";
  one.input = spectra();
  one.labels = LabelRule::paper;
  one.training = {
      .steps = steps, .batch = batch, .clip = 128, .optimiser = Optimiser::adam, .learning_rate = rate, .final_rate = 0.02};
  one.training.validate_every = steps / 20;
  return one;
}

Layers four(const Layer& layer, bool relu) {
  Layers layers;
  for (int i = 0; i < 4; ++i) {
    layers.push_back(layer);
    if (relu) layers.emplace_back(Relu{});
  }
  layers.emplace_back(Linear{2});
  return layers;
}

}  // namespace

std::vector<Recipe> piezo_recipes() {
  Recipe mlp = piezo_recipe("piezo_mlp", "Spectra of 20 ms, each by itself, through four layers of 32", "MLP 32", 1000, 64, 1e-2);
  mlp.network = {12, four(Linear{32}, true)};
  Recipe mlp_128 = piezo_recipe("piezo_mlp_128", "The same with 128", "MLP 128", 500, 64, 3e-3);
  mlp_128.network = {12, four(Linear{128}, true)};
  Recipe tcn = piezo_recipe("piezo_tcn", "The latest 29 spectra through four causal convolutions of 128, kernel 8",
                            "TCN 128, kernel 8", 800, 16, 1e-3);
  tcn.network = {12, four(Conv1d{128, 8}, true)};
  Recipe fft_gru = piezo_recipe("piezo_fft_gru", "Spectra of 20 ms, one after the other, through four GRUs of 32", "FFT GRU 32",
                                300, 64, 4e-3);
  fft_gru.network = {12, four(Gru{32}, false)};
  Recipe raw_gru = piezo_recipe("piezo_raw_gru", "The signal at 100 Hz through four GRUs of 32", "raw GRU 32", 300, 64, 4e-3);
  raw_gru.input = raw();
  raw_gru.network = {1, four(Gru{32}, false)};
  return {mlp, mlp_128, tcn, fft_gru, raw_gru};
}

}  // namespace slipbench::train
