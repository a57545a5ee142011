// Arrays and attributes of a trial in a dataset, and their encoding: the expensive part of writing,
// which worker threads do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/dataset/record/trial_record.h"
#include "tools/files/output_file.h"

namespace slipbench {

// Arrays and attributes of a trial in the file: one list for both writer and reader.
using Extents = std::vector<std::size_t>;

// Attribute `frame` of a sensor's labels.
inline constexpr const char* label_frame_text =
    "contact plane: the pad frame P turned the shortest way until its z is the surface's normal; x and y are tangential, z is normal, compression is positive; forces act on the pad; positions, heights and slip_centre are in the pad frame P itself";

// True if some samples of a recording have unknown_state.
inline bool has_unknown(const LabelRecord& labels) {
  return std::ranges::find(labels.state_paper, static_cast<std::uint8_t>(unknown_state)) != labels.state_paper.end();
}

// Calls visit(name, unit, extents after the first axis, column) for every label with one row per
// sample. `units`: N. Labels without truth have state_paper alone, and neither events nor
// attributes of units.
template <class Labels, class Visit>
void for_each_label(Labels& labels, std::size_t units, Visit&& visit) {
  if (!labels.truth) {
    visit("state_paper", "1", Extents{}, labels.state_paper);
    return;
  }
  visit("unit_state", "1", Extents{units}, labels.unit_state);
  visit("slip_velocity", "m/s", Extents{units, 2}, labels.slip_velocity);
  visit("slip_distance", "m", Extents{units}, labels.slip_distance);
  visit("margin", "1", Extents{units}, labels.margin);
  visit("force", "N", Extents{units, 3}, labels.force);
  visit("state", "1", Extents{}, labels.state);
  visit("state_micro", "1", Extents{}, labels.state_micro);
  visit("state_paper", "1", Extents{}, labels.state_paper);
  visit("stuck_fraction", "1", Extents{}, labels.stuck_fraction);
  visit("slip_direction", "rad", Extents{}, labels.slip_direction);
  visit("slip_centre", "m", Extents{2}, labels.slip_centre);
  visit("slip_angle", "rad", Extents{}, labels.slip_angle);
}

// As above for the columns of the events, with one row per event.
template <class Labels, class Visit>
void for_each_event_column(Labels& labels, Visit&& visit) {
  if (!labels.truth) return;
  visit("events/t", "s", Extents{}, labels.event_time);
  visit("events/unit", "1", Extents{}, labels.event_unit);
  visit("events/kind", "1", Extents{}, labels.event_kind);
}

// Calls visit(name, value) for every attribute of a recorded sensor's time stamps.
template <class Timing, class Visit>
void for_each_timing_attribute(Timing& timing, Visit&& visit) {
  visit("mean_rate_hz", timing.mean_rate);
  visit("median_rate_hz", timing.median_rate);
  visit("largest_gap_s", timing.largest_gap);
  visit("largest_gap_at_s", timing.largest_gap_at);
  visit("time_resolution_s", timing.resolution);
}

// Calls visit(name, unit, extents after the first axis, values) for every attribute of the labels with
// one row per unit.
template <class Labels, class Visit>
void for_each_unit_attribute(Labels& labels, Visit&& visit) {
  if (!labels.truth) return;
  visit("unit_positions", "m", Extents{2}, labels.unit_positions);
  visit("unit_heights", "m", Extents{}, labels.unit_heights);
  visit("k_normal", "N/m", Extents{}, labels.k_normal);
  visit("k_tangential", "N/m", Extents{}, labels.k_tangential);
  visit("mu_static", "1", Extents{}, labels.mu_static);
  visit("mu_kinetic", "1", Extents{}, labels.mu_kinetic);
  visit("onset_time_s", "s", Extents{}, labels.onset_time);
  visit("micro_onset_time_s", "s", Extents{}, labels.micro_onset_time);
}

// Calls visit(name, unit, extents after the first axis, column) for every array of a body.
template <class Body, class Visit>
void for_each_body_column(Body& body, Visit&& visit) {
  visit("pose", "m, quaternion wxyz", Extents{7}, body.pose);
  visit("velocity", "m/s, rad/s", Extents{6}, body.velocity);
}

// As above for every array of the control loop, with one row per sample of the sensor that the loop
// reads.
template <class Control, class Visit>
void for_each_control_column(Control& control, Visit&& visit) {
  visit("detector_class", "1", Extents{}, control.detector_class);
}

// As above for the arrays of a grasp.
template <class Grip, class Visit>
void for_each_grip_column(Grip& grip, Visit&& visit) {
  visit("command", "1", Extents{3}, grip.command);
  visit("measured_position", "1", Extents{}, grip.measured_position);
  visit("grip_force", "N", Extents{}, grip.grip_force);
}

// As above for the arrays of a grasp with a guided arm.
template <class Grip, class Visit>
void for_each_arm_column(Grip& grip, Visit&& visit) {
  visit("arm_speed", "m/s", Extents{2}, grip.arm);
}

// True if a sensor has a group of labels; an imported recording without slip labels has none.
inline bool has_labels(const LabelRecord& labels) { return labels.truth || !labels.state_paper.empty(); }

inline constexpr const char* control_group = "control";
inline std::string sensor_group(const std::string& sensor) { return "sensors/" + sensor; }
// Path of the time stamps of a channel that has its own.
inline std::string own_time_path(const std::string& channel) { return channel + "_t"; }
inline std::string label_group(const std::string& sensor) { return "labels/" + sensor; }
inline std::string body_group(const std::string& body) { return "truth/" + body; }

enum class ElementType : std::uint8_t { f64, f32, u32, u8 };

// Bytes of one element.
constexpr std::size_t size_of(ElementType type) {
  switch (type) {
    case ElementType::f64: return 8;
    case ElementType::f32:
    case ElementType::u32: return 4;
    case ElementType::u8: return 1;
  }
  return 0;
}

// Type as in numpy's dtype.str: "<f8".
std::string_view numpy_name(ElementType type);

// One dataset of a demo: little-endian values in C order, cut along the first axis into chunks of
// equal extent, each shuffled and deflated like HDF5's filters do.
struct EncodedArray {
  std::string path;   // inside the demo: "labels/pad/state"
  std::string unit;   // SI symbol, "1" for a pure number
  std::string codes;  // JSON, meaning of its codes; empty: quantities
  ElementType type = ElementType::f32;
  std::vector<std::size_t> shape;
  std::size_t chunk_rows = 0;  // extent of a chunk along the first axis; 0: the array is empty
  std::vector<std::vector<std::uint8_t>> chunks;
};

// One attribute of a group of a demo.
struct EncodedAttribute {
  // A matrix of doubles in C order.
  struct Doubles {
    std::vector<std::size_t> shape;
    std::vector<double> values;
  };
  std::string path;  // of the group inside the demo; "" is the demo itself
  std::string name;
  std::variant<std::uint64_t, double, std::string, std::vector<std::string>, Doubles> value;
};

struct EncodedTrial {
  std::size_t trial = 0;
  std::string material;
  std::vector<EncodedArray> arrays;          // ascending by path
  std::vector<EncodedAttribute> attributes;  // ascending by path
  Digest digest{};                           // of all arrays and attributes, see README.md; also the attribute `sha256`
};

// Encodes trials. Use one object per thread: it holds the compressor and its buffers.
class TrialEncoder {
 public:
  static constexpr int deflate_level = 1;              // for the measurements see README.md
  static constexpr std::size_t chunk_bytes = 1 << 20;  // largest chunk before compression

  TrialEncoder();
  ~TrialEncoder();

  // Throws std::logic_error if a column's length does not match the number of samples, which is a
  // bug.
  EncodedTrial encode(const TrialRecord& record);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Computes EncodedTrial::digest of a trial without encoding it.
Digest trial_digest(const TrialRecord& record);

// SHA-256 of the truth at a pad, 64 hexadecimal digits: forces and states of its units. Trials with
// equal values are one experiment made twice; their sensors differ at most in noise. Empty if the
// recording has no truth or nothing pressed on the pad.
std::string truth_sha256(const LabelRecord& labels);
// Likewise at all pads of a trial.
std::string truth_sha256(std::span<const SensorRecord> sensors);

// SHA-256 over the trials' digests in order, as 64 hexadecimal digits: the content_sha256 of schema
// 1.
std::string content_digest(const std::vector<Digest>& digests);

// SHA-256 of the bytes of a text as 64 hexadecimal digits.
std::string text_sha256(const std::string& text);
// SHA-256 of the bytes of a text.
Digest text_digest(const std::string& text);

// SHA-256 of a file's bytes as 64 hexadecimal digits, as sha256sum prints it. Throws InputError if
// the file is unreadable.
std::string file_sha256(const std::string& path);

// Arrays of a trial under their names in a dataset.

// A view of a column of a record with its path in the dataset. The record must outlive it.
struct ArrayView {
  std::string path;        // inside the demo: "labels/pad/state"
  std::string unit;        // SI symbol, "1" for a pure number
  std::string_view codes;  // JSON, meaning of its codes; empty: quantities
  ElementType type = ElementType::f32;
  Extents shape;                        // samples first
  const std::uint8_t* bytes = nullptr;  // little-endian values in C order

  [[nodiscard]] std::size_t row_bytes() const {
    std::size_t size = size_of(type);
    for (std::size_t axis = 1; axis < shape.size(); ++axis) size *= shape[axis];
    return size;
  }
  [[nodiscard]] std::size_t size_bytes() const { return shape[0] * row_bytes(); }
};

// All arrays of a trial in ascending order of path. Throws std::logic_error if a column's length
// does not match the number of samples.
std::vector<ArrayView> arrays_of(const TrialRecord& record);

// Attributes of a trial and its groups, without `sha256`.
std::vector<EncodedAttribute> attributes_of(const TrialRecord& record);

}  // namespace slipbench
