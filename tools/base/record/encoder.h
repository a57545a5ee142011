// A trial turned into the bytes that a dataset stores: the costly part of writing, done by worker threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tools/base/files/output_file.h"
#include "tools/base/record/layout.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

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

// As numpy's dtype.str: "<f8".
std::string_view numpy_name(ElementType type);

// One dataset of a demo: little-endian values in C order, cut along the first axis into chunks of equal extent, each shuffled and
// deflated as HDF5's filters would.
struct EncodedArray {
  std::string path;   // inside the demo: "labels/pad/state"
  std::string unit;   // SI symbol, "1" for a pure number
  std::string codes;  // JSON, what its numbers stand for; empty: they are quantities
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
  std::vector<EncodedArray> arrays;          // in ascending order of path
  std::vector<EncodedAttribute> attributes;  // likewise
  Digest digest{};                           // of all arrays and attributes, see README.md; also the attribute `sha256`

  // Bytes that the chunks take in the file.
  [[nodiscard]] std::size_t stored_bytes() const;
};

// Encodes trials. One object a thread: it holds the compressor and its buffers.
class TrialEncoder {
 public:
  static constexpr int deflate_level = 4;              // README.md has the measurements
  static constexpr std::size_t chunk_bytes = 1 << 20;  // largest chunk before compression

  TrialEncoder();
  ~TrialEncoder();
  TrialEncoder(TrialEncoder&&) noexcept;
  TrialEncoder& operator=(TrialEncoder&&) noexcept;

  // Throws std::logic_error when a column's length does not fit the number of samples: that is a bug.
  EncodedTrial encode(const TrialRecord& record);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// EncodedTrial::digest by its chunks and attributes, whatever it says itself. Throws InputError where a chunk does not hold the rows that it should.
Digest recomputed_digest(const EncodedTrial& trial);

// EncodedTrial::digest of a trial, without encoding it.
Digest trial_digest(const TrialRecord& record);

// SHA-256 of what truly happened at a pad, 64 hexadecimal digits: forces and states of its units. Trials in which it is equal are one experiment
// made twice, whose sensors differ in their noise at most. Empty: the recording has no truth, or nothing pressed on the pad.
std::string truth_sha256(const LabelRecord& labels);

// SHA-256 over the trials' digests in order, as 64 hexadecimal digits: the content_sha256 of schema 1.
std::string content_digest(const std::vector<Digest>& digests);

// SHA-256 of the bytes of a text as 64 hexadecimal digits.
std::string text_sha256(const std::string& text);
// Its bytes.
Digest text_digest(const std::string& text);

// SHA-256 of a file's bytes as 64 hexadecimal digits, as sha256sum prints it. Throws InputError when it cannot be read.
std::string file_sha256(const std::string& path);

// The arrays of a trial under the names that they have in a dataset.

// A column of a record and where it goes. It looks into the record.
struct ArrayView {
  std::string path;        // inside the demo: "labels/pad/state"
  std::string unit;        // SI symbol, "1" for a pure number
  std::string_view codes;  // of JSON, what its numbers stand for; empty: they are quantities
  ElementType type = ElementType::f32;
  Extents shape;                        // a row a sample first
  const std::uint8_t* bytes = nullptr;  // little-endian values in C order

  [[nodiscard]] std::size_t row_bytes() const {
    std::size_t size = size_of(type);
    for (std::size_t axis = 1; axis < shape.size(); ++axis) size *= shape[axis];
    return size;
  }
  [[nodiscard]] std::size_t size_bytes() const { return shape[0] * row_bytes(); }
};

// All arrays of a trial in ascending order of path. Throws std::logic_error when a column's length does not fit the number of
// samples.
std::vector<ArrayView> arrays_of(const TrialRecord& record);

}  // namespace slipbench
