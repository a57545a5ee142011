// A sensor that uses every property that a SensorKind can declare: a grid of elements with force and
// displacement of each, an image in counts and a vibration of two values.
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "sensors/electronics/pad_sensor.h"
#include "sim/api/sensor_kind.h"

namespace slipbench {
namespace {

constexpr double full_scale = 255.0, counts_per_newton = 200.0;  // of the image
constexpr double gain_sd = 0.05, force_noise = 1e-3, displacement_noise = 1e-6;

PadLayout layout_of(const Parameters& p) {
  PadLayout layout;
  const auto rows = p.integer("rows"), columns = p.integer("columns"), bristles = p.integer("bristles");
  const auto count = static_cast<double>(bristles);
  const auto middle = [](std::int64_t index, std::int64_t number) { return 0.5 * static_cast<double>(2 * index - number + 1); };
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) {
      layout.units.push_back({layout.elements.size(), static_cast<std::size_t>(bristles)});
      for (std::int64_t bristle = 0; bristle < bristles; ++bristle) {
        const Eigen::Vector3d place(middle(column, columns) + middle(bristle, bristles) / count, -middle(row, rows), 0.0);
        layout.elements.push_back({.tip = p.number("pitch") * place,
                                   .k_normal = p.number("k_normal") / count,
                                   .k_tangential = p.number("k_tangential") / count});
      }
    }
  }
  return layout;
}

std::vector<Channel> channels_of(const Parameters& p) {
  const auto rows = static_cast<std::size_t>(p.integer("rows")), columns = static_cast<std::size_t>(p.integer("columns"));
  std::vector<Channel> channels{{"force", "N", {rows * columns, 3}, {}},
                                {"displacement", "m", {rows * columns, 3}, {}},
                                {"image", "counts", {rows, columns}, {}},
                                {"vibration", "V", {2}, {"LEFT", "RIGHT"}}};
  for (std::size_t unit = 0; unit < rows * columns; ++unit) {
    for (const char* const axis : {"X", "Y", "Z"}) {
      channels[0].channel_names.push_back("E" + std::to_string(unit) + "_F" + axis);
      channels[1].channel_names.push_back("E" + std::to_string(unit) + "_D" + axis);
    }
    channels[2].channel_names.push_back("E" + std::to_string(unit));
  }
  return channels;
}

SignalModel model_of(double rate, std::size_t units) {
  SignalModel model;
  model.rate = rate;
  model.sources = 4 * units + 2;
  const auto append = [&model](std::size_t count, double noise, double gain, ConverterRange range) {
    for (std::size_t i = 0; i < count; ++i) {
      model.source.push_back(model.source.size() % model.sources);
      model.noise_sd.push_back(noise);
      model.gain_sd.push_back(gain);
      model.converter.push_back(range);
    }
  };
  append(3 * units, force_noise, gain_sd, {-10.0, 10.0});
  append(3 * units, displacement_noise, 0.0, {-1e-2, 1e-2});
  append(units, 0.5, 0.0, {0.0, full_scale});
  append(2, 1e-3, 0.0, {-10.0, 10.0});
  return model;
}

class ExamplePad final : public PadSensor {
 public:
  ExamplePad(const Parameters& parameters, const std::vector<Named>& electronics, const ElectronicsKey& key)
      : PadSensor(parameters.number("rate"), layout_of(parameters), channels_of(parameters)),
        electronics_(electronics, model_of(rate_, layout_.units.size()), key),
        values_(7 * layout_.units.size() + 2) {
    frame_.values = values_;
  }

  const SensorFrame& measure(const ContactFrame& truth) override {
    const std::size_t units = layout_.units.size();
    auto to = values_.begin();
    to = std::transform(truth.force.data(), truth.force.data() + 3 * units, to, to_float);
    to = std::transform(truth.displacement.data(), truth.displacement.data() + 3 * units, to, to_float);
    for (std::size_t unit = 0; unit < units; ++unit)
      *to++ = to_float(full_scale - std::min(full_scale, counts_per_newton * truth.force(2, static_cast<Eigen::Index>(unit))));
    *to++ = to_float(truth.force.row(0).sum());
    *to = to_float(truth.force.row(1).sum());
    electronics_.apply(values_, truth.time);
    frame_.time = truth.time;
    return frame_;
  }

  [[nodiscard]] std::vector<std::span<double>> memory() override { return electronics_.memory(); }
  [[nodiscard]] std::uint64_t saturated() const override { return electronics_.saturated(); }
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const override { return truth.state; }

 private:
  static float to_float(double value) { return static_cast<float>(value); }

  Electronics electronics_;
  std::vector<float> values_;
};

std::vector<Entry> parts() {
  const auto coupling = [](const char* name) {
    return number_spec(name, Quantity::none, "0", non_negative, "Largest coefficient; this sensor has none.", "this test");
  };
  return electronics_of(
      "example_pad",
      {{"coupling", "this test", {}, {coupling("shear_to_normal"), coupling("normal_to_shear"), coupling("shear_to_shear")}},
       {"gain", "this test"},
       {"white_noise", "this test"},
       {"quantisation", "this test", {{"bits", "16", "this test"}}}});
}

}  // namespace

SensorKind example_pad_sensor() {
  return {
      .about = {.name = "example_pad",
                .summary = "Example: a grid of elements.",
                .law = "force and displacement of each; image = 255 - 200 f_z/N; vibration: sums of f_x and f_y",
                .source = "this test",
                .parameters = {number_spec("rate", Quantity::frequency, "200 Hz", positive, "Rate of the samples.", "this test"),
                               integer_spec("rows", "4", {1.0, 64.0}, "Units along Y.", "this test"),
                               integer_spec("columns", "3", {1.0, 64.0}, "Units along X.", "this test"),
                               integer_spec("bristles", "1", {1.0, 64.0}, "Elements of a unit, in a row along X.", "this test"),
                               number_spec("pitch", Quantity::length, "3 mm", positive, "Distance of units.", "this test"),
                               number_spec("k_normal", Quantity::stiffness, "1 N/mm", positive, "Of a unit.", "this test"),
                               number_spec("k_tangential", Quantity::stiffness, "0.6 N/mm", positive, "Of a unit.",
                                           "this test")}},
      .electronics = parts(),
      .create = created<ExamplePad>,
      .view =
          {.unit = "dimple",
           .units = "dimples",
           .letter = "D",
           .first = 1,
           .from_behind = true,
           .orientation = "so that the example's X is right",
           .channels = {{.channel = "image", .name = "Example image", .note = "of its dimples", .unit = "counts", .image = true},
                        {.channel = "vibration",
                         .name = "Example vibration",
                         .note = "left and right",
                         .difference = "LR",
                         .spectrum = SpectrumView{"Example spectrum", 0.2, 0.05, 80.0},
                         .unit = "V"}},
           .picture = PadPicture{.channel = "image",
                                 .cells = {{0}, {1}, {2}, {3}, {4}, {5}, {6}, {7}, {8}, {9}, {10}, {11}},
                                 .width = 0.9,
                                 .rest = full_scale,
                                 .falls = true,
                                 .note = "Example picture."}},
      .libraries = {"Example Reader"},
      .users_code = true,
      .disturbance = [](double, double, double) {
        return UnitDisturbance{
            .gain_sd = {gain_sd, gain_sd, gain_sd},
            .noise_sd = {force_noise, force_noise, force_noise, displacement_noise, displacement_noise, displacement_noise}};
      }};
}

}  // namespace slipbench
