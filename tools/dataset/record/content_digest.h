// Computes the digests that README.md defines from the content of a file.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/record/encoder.h"
#include "tools/files/output_file.h"

namespace slipbench {

// Attribute of a demo that holds its digest; it is not part of the digest.
inline constexpr const char* trial_sha256_name = "sha256";
// Attribute of a trial: the third-party libraries that computed in it (TrialRecord::libraries).
inline constexpr const char* libraries_name = "libraries";
// Attribute of a file that holds its digest; it is not part of the digest.
inline constexpr const char* file_sha256_name = "content_sha256";

// Digest of a demo: all of its arrays and attributes. `read`: arrays just read from it, whose
// values are not read again. Throws InputError if something in it is unreadable or of a type that
// no dataset has.
Digest stored_trial_digest(const hdf5::Place& demo, const std::map<std::string, ArrayView>& read = {});

// Digest of a demo by schema 1: its arrays alone.
Digest stored_arrays_digest(const hdf5::Place& demo);

// Digest of a file with root `root`: all content except its trials, and the trials' digests.
Digest stored_file_digest(const hdf5::Place& root, const std::vector<std::pair<std::size_t, Digest>>& trials);

// Digest of named values, the entries of README.md, in memory or in a file.
class ContentDigest {
 public:
  // Adds one array or attribute of numbers: `type` as numpy writes it ("<f8"), values little-endian
  // in C order. The key of an attribute is its object's path, "@" and its name. Keys must be
  // unique. Returns the entry's digest.
  const Digest& add_numbers(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents,
                            const void* bytes, std::size_t size);
  // Adds an array or attribute of texts. A single text has no extents.
  void add_texts(const std::string& key, const std::vector<std::size_t>& extents, const std::vector<std::string>& texts);
  void add_text(const std::string& key, const std::string& text) { add_texts(key, {}, {text}); }
  // Adds a trial of a file.
  void add_trial(const std::string& key, const Digest& digest) { add_numbers(key, "trial", {}, digest.data(), digest.size()); }

  // SHA-256 over the entries' digests in ascending order of key.
  [[nodiscard]] Digest finish() const;

 private:
  void begin(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents);

  mutable Sha256 hash_;
  std::map<std::string, Digest> entries_;
};

}  // namespace slipbench
