#include "tools/dataset/record/encoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/process/regular_file.h"
#include "tools/dataset/record/codes.h"
#include "tools/dataset/record/content_digest.h"

namespace slipbench {
namespace {

EncodedAttribute::Doubles confusion_matrix(const Confusion& confusion) {
  EncodedAttribute::Doubles matrix{{confusion.size(), confusion.size()}, {}};
  for (const StateCounts& truth : confusion) matrix.values.insert(matrix.values.end(), truth.begin(), truth.end());
  return matrix;
}

void add_attribute(ContentDigest& digest, const EncodedAttribute& attribute) {
  struct Adder {
    ContentDigest& digest;
    std::string key;
    void operator()(std::uint64_t value) const { digest.add_numbers(key, "<u8", {}, &value, sizeof value); }
    void operator()(double value) const { digest.add_numbers(key, "<f8", {}, &value, sizeof value); }
    void operator()(const std::string& text) const { digest.add_text(key, text); }
    void operator()(const std::vector<std::string>& texts) const { digest.add_texts(key, {texts.size()}, texts); }
    void operator()(const EncodedAttribute::Doubles& matrix) const {
      digest.add_numbers(key, "<f8", matrix.shape, matrix.values.data(), matrix.values.size() * sizeof(double));
    }
  };
  std::visit(Adder{digest, attribute.path + "@" + attribute.name}, attribute.value);
}

// Returns the digest of the values.
const Digest& add_array(ContentDigest& digest, const std::string& path, ElementType type, const Extents& shape,
                        const void* values, std::size_t bytes, const std::string& unit, std::string_view codes) {
  const Digest& of_values = digest.add_numbers(path, numpy_name(type), shape, values, bytes);
  digest.add_text(path + "@unit", unit);
  if (!codes.empty()) digest.add_text(path + "@codes", std::string(codes));
  return of_values;
}

// Adds the same entries that content_digest.cc finds in the file. Calls see(array, digest of its
// values).
template <class See>
Digest digest_of(const std::vector<ArrayView>& arrays, const std::vector<EncodedAttribute>& attributes, const See& see) {
  ContentDigest digest;
  for (const ArrayView& view : arrays)
    see(view, add_array(digest, view.path, view.type, view.shape, view.bytes, view.size_bytes(), view.unit, view.codes));
  for (const EncodedAttribute& attribute : attributes) add_attribute(digest, attribute);
  return digest.finish();
}

// Applies HDF5's shuffle filter: all first bytes of the elements, then all second bytes, and so on.
template <std::size_t Size>
void shuffle(const std::uint8_t* in, std::size_t bytes, std::uint8_t* out) {
  const std::size_t count = bytes / Size;
  for (std::size_t byte = 0; byte < Size; ++byte) {
    for (std::size_t i = 0; i < count; ++i) out[byte * count + i] = in[i * Size + byte];
  }
}

static_assert(std::endian::native == std::endian::little, "columns are stored as they lie in memory");

constexpr ElementType type_of(double) { return ElementType::f64; }
constexpr ElementType type_of(float) { return ElementType::f32; }
constexpr ElementType type_of(std::uint32_t) { return ElementType::u32; }
constexpr ElementType type_of(std::uint8_t) { return ElementType::u8; }

template <class T>
ArrayView view_of(std::string path, std::string unit, std::size_t rows, const Extents& tail, const std::vector<T>& values) {
  ArrayView view{std::move(path), std::move(unit), {},
                 type_of(T{}),    {rows},          reinterpret_cast<const std::uint8_t*>(values.data())};
  view.shape.insert(view.shape.end(), tail.begin(), tail.end());
  if (view.size_bytes() != values.size() * sizeof(T)) {
    throw std::logic_error(fmt::format("{}: {} values do not fill {} rows", view.path, values.size(), rows));
  }
  return view;
}

}  // namespace

struct TrialEncoder::State {
  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor{
      libdeflate_alloc_compressor(deflate_level), &libdeflate_free_compressor};
  std::vector<std::uint8_t> padded;
  std::vector<std::uint8_t> shuffled;
  std::vector<std::uint8_t> deflated;
  // The last trial's encoded small arrays, by path: time stamps and resting bodies are equal in
  // each trial.
  static constexpr std::size_t most_kept = chunk_bytes / 4;
  struct Kept {
    Digest digest;
    std::vector<std::vector<std::uint8_t>> chunks;
  };
  std::map<std::string, Kept> kept;

  // True if the bytes of a plane are incompressible, as mantissas under noise: deflating a sample
  // gains nothing.
  bool is_noise(const std::uint8_t* plane, std::size_t size) {
    constexpr std::size_t pieces = 4;
    constexpr std::size_t piece = 512;
    if (size < 8 * pieces * piece) return false;
    std::array<std::uint8_t, pieces * piece> sample, smaller;
    for (std::size_t k = 0; k < pieces; ++k) std::memcpy(&sample[k * piece], plane + k * size / pieces, piece);
    return libdeflate_deflate_compress(compressor.get(), sample.data(), sample.size(), smaller.data(), smaller.size()) == 0;
  }

  // Returns a zlib stream. Leading planes of noise are stored uncompressed: searching them for
  // patterns is slow and gains nothing.
  std::vector<std::uint8_t> deflate_chunk(const std::uint8_t* bytes, std::size_t size, std::size_t element) {
    const std::uint8_t* source = bytes;
    if (element > 1) {
      shuffled.resize(std::max(shuffled.size(), size));  // never shrinks, since resize() would clear the bytes again
      if (element == 8) {
        shuffle<8>(bytes, size, shuffled.data());
      } else {
        shuffle<4>(bytes, size, shuffled.data());
      }
      source = shuffled.data();
    }
    const std::size_t plane = size / element;
    std::size_t stored = 0;
    while (stored + plane < size && is_noise(source + stored, plane)) stored += plane;
    constexpr std::size_t header = 2, checksum = 4, block_header = 5, most_in_block = 0xFFFF;  // bytes
    const std::size_t blocks = (stored + most_in_block - 1) / most_in_block;
    const std::size_t bound = libdeflate_deflate_compress_bound(compressor.get(), size - stored);
    deflated.resize(std::max(deflated.size(), header + blocks * block_header + stored + bound + checksum));
    std::uint8_t* out = deflated.data();
    const auto put = [&out](std::size_t value, std::initializer_list<int> shifts) {
      for (const int shift : shifts) *out++ = static_cast<std::uint8_t>(value >> shift);
    };
    put(0x7801, {8, 0});
    for (std::size_t first = 0; first < stored;) {
      const std::size_t block = std::min(stored - first, most_in_block);
      put(block << 8 | ~block << 24, {0, 8, 16, 24, 32});  // a stored block that is not the last (RFC 1951, 3.2.4)
      out = std::copy_n(source + first, block, out);
      first += block;
    }
    const std::size_t compressed = libdeflate_deflate_compress(compressor.get(), source + stored, size - stored, out, bound);
    if (compressed == 0) throw std::logic_error("libdeflate exceeded the bound that it gave for the compressed size");
    out += compressed;
    put(libdeflate_adler32(1, source, size), {24, 16, 8, 0});
    return {deflated.data(), out};
  }

  EncodedArray encode_array(const ArrayView& view, const Digest& digest) {
    EncodedArray array{view.path, view.unit, std::string(view.codes), view.type, view.shape, 0, {}};
    const std::size_t rows = view.shape[0];
    const std::size_t row_bytes = view.row_bytes();
    if (rows == 0 || row_bytes == 0) return array;
    const std::size_t parts = std::max<std::size_t>(1, (view.size_bytes() + chunk_bytes - 1) / chunk_bytes);
    array.chunk_rows = (rows + parts - 1) / parts;
    if (const auto same = kept.find(view.path); same != kept.end() && same->second.digest == digest) {
      array.chunks = same->second.chunks;
      return array;
    }
    for (std::size_t first = 0; first < rows; first += array.chunk_rows) {
      end_if_interrupted();
      const std::uint8_t* bytes = view.bytes + first * row_bytes;
      const std::size_t present = std::min(array.chunk_rows, rows - first) * row_bytes;
      const std::size_t whole = array.chunk_rows * row_bytes;
      if (present < whole) {  // HDF5 stores chunks at full size
        padded.assign(whole, 0);
        std::memcpy(padded.data(), bytes, present);
        bytes = padded.data();
      }
      array.chunks.push_back(deflate_chunk(bytes, whole, size_of(view.type)));
    }
    if (view.size_bytes() <= most_kept) kept[view.path] = {digest, array.chunks};
    return array;
  }
};

std::string_view numpy_name(ElementType type) {
  switch (type) {
    case ElementType::f64: return "<f8";
    case ElementType::f32: return "<f4";
    case ElementType::u32: return "<u4";
    case ElementType::u8: return "|u1";
  }
  return {};
}

TrialEncoder::TrialEncoder() : state_(std::make_unique<State>()) {
  if (!state_->compressor) throw std::bad_alloc();
}
TrialEncoder::~TrialEncoder() = default;

EncodedTrial TrialEncoder::encode(const TrialRecord& record) {
  EncodedTrial trial;
  trial.trial = record.trial;
  trial.material = record.material;
  trial.attributes = attributes_of(record);
  // The sensors of a record read from a file are in another order; the bytes must be equal.
  std::ranges::stable_sort(trial.attributes, {}, &EncodedAttribute::path);
  trial.digest = digest_of(arrays_of(record), trial.attributes, [&](const ArrayView& view, const Digest& digest) {
    trial.arrays.push_back(state_->encode_array(view, digest));
  });
  trial.attributes.push_back({"", trial_sha256_name, hexadecimal(trial.digest)});
  return trial;
}

std::string truth_sha256(const LabelRecord& labels) {
  if (std::ranges::all_of(labels.force, [](float force) { return force == 0.0F; })) return {};
  Sha256 sha;
  sha.update(labels.force.data(), labels.force.size() * sizeof(float));
  sha.update(labels.unit_state.data(), labels.unit_state.size());
  return hexadecimal(sha.finish());
}

std::string truth_sha256(std::span<const SensorRecord> sensors) {
  std::string all;
  for (const SensorRecord& sensor : sensors) all += truth_sha256(sensor.labels);
  return all.empty() ? all : hexadecimal(text_digest(all));
}

Digest trial_digest(const TrialRecord& record) {
  return digest_of(arrays_of(record), attributes_of(record), [](const ArrayView&, const Digest&) {});
}

std::string content_digest(const std::vector<Digest>& digests) {
  Sha256 hash;
  for (const Digest& digest : digests) hash.update(digest.data(), digest.size());
  return hexadecimal(hash.finish());
}

Digest text_digest(const std::string& text) {
  Sha256 hash;
  hash.update(text.data(), text.size());
  return hash.finish();
}

std::string text_sha256(const std::string& text) { return hexadecimal(text_digest(text)); }

std::string file_sha256(const std::string& path) {
  check_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  Sha256 hash;
  std::array<char, 65536> block;
  while (stream.read(block.data(), block.size()), stream.gcount() > 0) {
    hash.update(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.is_open() || stream.bad()) throw InputError(path + ": cannot be read");
  return hexadecimal(hash.finish());
}

std::vector<EncodedAttribute> attributes_of(const TrialRecord& record) {
  std::vector<EncodedAttribute> attributes;
  attributes.push_back({"", "num_samples", static_cast<std::uint64_t>(record.num_samples())});
  attributes.push_back({"", "seed", record.seed});
  attributes.push_back({"", "params", record.params});
  attributes.push_back({"", "outcome", outcome_json(record.outcome)});
  if (!record.model_sha256.empty()) attributes.push_back({"", "model_sha256", record.model_sha256});
  if (!record.libraries.empty()) attributes.push_back({"", libraries_name, record.libraries});
  for (const SensorRecord& sensor : record.sensors) {
    const std::string samples = sensor_group(sensor.name);
    std::vector<std::string> channels;
    for (const SensorColumn& channel : sensor.channels) channels.push_back(channel.name);
    attributes.push_back({samples, "type", sensor.type});
    attributes.push_back({samples, "rate_hz", sensor.rate});
    attributes.push_back({samples, "frame", sensor.frame});
    if (!sensor.follows.empty()) attributes.push_back({samples, "follows", sensor.follows});
    if (sensor.timing) {
      for_each_timing_attribute(*sensor.timing, [&](const char* name, double value) {
        attributes.push_back({samples, name, value});
      });
    }
    attributes.push_back({samples, "channels", std::move(channels)});
    attributes.push_back({samples, "channel_names", sensor.channel_names});
    if (!has_labels(sensor.labels)) continue;
    if (!sensor.labels.truth) {
      attributes.push_back({label_group(sensor.name), "rule", sensor.labels.rule});
      continue;
    }
    attributes.push_back({label_group(sensor.name), "frame", std::string(label_frame_text)});
    for_each_unit_attribute(sensor.labels,
                            [&](const char* name, const char*, const Extents& tail, const std::vector<double>& values) {
                              EncodedAttribute::Doubles matrix{{sensor.labels.units()}, values};
                              matrix.shape.insert(matrix.shape.end(), tail.begin(), tail.end());
                              attributes.push_back({label_group(sensor.name), name, std::move(matrix)});
                            });
  }
  for (const BodyRecord& body : record.bodies) {
    if (!body.size.empty()) {
      attributes.push_back({body_group(body.name), "size", EncodedAttribute::Doubles{{body.size.size()}, body.size}});
    }
  }
  if (record.control) {
    attributes.push_back({control_group, "detector", record.control->detector});
    attributes.push_back({control_group, "controller", record.control->controller});
    attributes.push_back({control_group, "sensor", record.control->sensor});
    attributes.push_back({control_group, "rate_hz", record.control->rate});
    if (record.sensors.empty()) attributes.push_back({control_group, "confusion", confusion_matrix(record.control->confusion)});
  }
  return attributes;
}

std::vector<ArrayView> arrays_of(const TrialRecord& record) {
  std::vector<ArrayView> arrays;
  for (const SensorRecord& sensor : record.sensors) {
    const std::size_t rows = sensor.time.size();
    const std::string samples = sensor_group(sensor.name) + "/";
    arrays.push_back(view_of(samples + "t", "s", rows, {}, sensor.time));
    for (const SensorColumn& channel : sensor.channels) {
      const std::size_t channel_rows = channel.time ? channel.time->size() : rows;
      arrays.push_back(view_of(samples + channel.name, channel.unit, channel_rows, channel.shape, channel.values));
      if (channel.time) arrays.push_back(view_of(own_time_path(samples + channel.name), "s", channel_rows, {}, *channel.time));
    }
    if (!has_labels(sensor.labels)) continue;
    const std::string labels = label_group(sensor.name) + "/";
    arrays.push_back(view_of(labels + "t", "s", rows, {}, sensor.time));
    for_each_label(sensor.labels, sensor.labels.units(),
                   [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
                     arrays.push_back(view_of(labels + name, unit, rows, tail, column));
                     arrays.back().codes = codes_of(name);
                   });
    if (!sensor.labels.truth && has_unknown(sensor.labels)) arrays.back().codes = codes_with_unknown();
    const std::size_t events = sensor.labels.event_time.size();
    for_each_event_column(sensor.labels, [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
      arrays.push_back(view_of(labels + name, unit, events, tail, column));
      arrays.back().codes = codes_of(name);
    });
  }
  for (const BodyRecord& body : record.bodies) {
    const std::string truth = body_group(body.name) + "/";
    arrays.push_back(view_of(truth + "t", "s", record.body_time.size(), {}, record.body_time));
    for_each_body_column(body, [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
      arrays.push_back(view_of(truth + name, unit, record.body_time.size(), tail, column));
    });
  }
  if (record.control && !record.sensors.empty()) {
    const std::string control = std::string(control_group) + "/";
    const std::size_t rows = record.control->time.size();
    arrays.push_back(view_of(control + "t", "s", rows, {}, record.control->time));
    const auto add = [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
      arrays.push_back(view_of(control + name, unit, rows, tail, column));
      arrays.back().codes = codes_of(name);
    };
    for_each_control_column(*record.control, add);
    if (record.outcome.grasp) for_each_grip_column(record.control->grip, add);
    if (record.outcome.grasp && record.outcome.grasp->turn) for_each_arm_column(record.control->grip, add);
  }
  std::sort(arrays.begin(), arrays.end(), [](const ArrayView& a, const ArrayView& b) { return a.path < b.path; });
  return arrays;
}

}  // namespace slipbench
