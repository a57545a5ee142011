// The digests of README.md, made from what a file holds.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/base/files/output_file.h"
#include "tools/base/hdf5/hdf5_place.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

// Name of a demo's attribute that holds its own digest, which is not among its entries.
inline constexpr const char* trial_sha256_name = "sha256";
// A trial's attribute with the libraries of others that computed in it (TrialRecord::libraries).
inline constexpr const char* libraries_name = "libraries";
// The same of a file.
inline constexpr const char* file_sha256_name = "content_sha256";

// Of a demo: all of its arrays and attributes. `read`: arrays whose values have just been read from it, which are not read again. Throws InputError
// where something in it cannot be read or is of a type that no dataset has.
Digest stored_trial_digest(const hdf5::Place& demo, const std::map<std::string, ArrayView>& read = {});

// Of a demo, as schema 1 has it: over its arrays alone.
Digest stored_arrays_digest(const hdf5::Place& demo);

// Of a file, whose root is given: all that it holds beside its trials, and their digests.
Digest stored_file_digest(const hdf5::Place& root, const std::vector<std::pair<std::size_t, Digest>>& trials);

// The digest of named values: what README.md calls entries, whether they lie in memory or in a file.
class ContentDigest {
 public:
  // One array or attribute of numbers: `type` as numpy writes it ("<f8"), values little-endian in C order. An attribute's key is
  // its object's path, "@" and its name. Keys differ. Returns the entry's own digest.
  const Digest& add_numbers(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents,
                            const void* bytes, std::size_t size);
  // One of texts. A single one has no extents.
  void add_texts(const std::string& key, const std::vector<std::size_t>& extents, const std::vector<std::string>& texts);
  void add_text(const std::string& key, const std::string& text) { add_texts(key, {}, {text}); }
  // A trial of a file.
  void add_trial(const std::string& key, const Digest& digest) { add_numbers(key, "trial", {}, digest.data(), digest.size()); }

  // SHA-256 over the entries' digests in ascending order of key.
  [[nodiscard]] Digest finish() const;

 private:
  void begin(const std::string& key, std::string_view type, const std::vector<std::size_t>& extents);

  mutable Sha256 hash_;
  std::map<std::string, Digest> entries_;
};

}  // namespace slipbench
