// Errors that a user can correct.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace slipbench {

// Bad input: the message names file:line, what was found and what is allowed. The command line
// prints it and exits with 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A run that has diverged. The scene's time step is the likeliest cause. The caller that read the
// scene adds file and line.
class FailedRun : public InputError {
 public:
  using InputError::InputError;
};

// A value of a scene that is allowed by itself, but conflicts with the rest of the scene. The
// caller that read the scene adds file and line.
class SceneValueError : public InputError {
 public:
  // `path` as in the scene: "motion.start". The message is "motion.start: " and `what`.
  SceneValueError(const std::string& path, const std::string& what) : InputError(path + ": " + what), path_(path) {}
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Levenshtein distance of two words.
std::size_t edit_distance(std::string_view a, std::string_view b);

// `text` in single quotes for a message: made printable, long text cut after 60 bytes with "...".
// Names the first character that looks like one of ASCII: "'4 mm' (with U+00A0 no-break space)".
std::string quote(std::string_view text);

// Returns `text` from an untrusted file for a terminal, a page or a file name. Writes as \xNN control
// characters (ASCII's, line ends unless `lines`, and U+0080 to U+009F) and bytes that are not UTF-8,
// and as \uNNNN characters that are invisible or change the direction of text.
std::string printable(std::string_view text, bool lines = false);

// Returns the candidate nearest to `word` in edit distance if it is close enough to be a likely
// typing error, else "".
template <class Names>
std::string nearest_name(std::string_view word, const Names& candidates) {
  std::string_view best;
  std::size_t best_distance = 1 + (word.size() <= 1 ? 0 : word.size() <= 3 ? 1 : std::max<std::size_t>(2, word.size() / 3));
  for (const auto& candidate : candidates) {
    const std::string_view name(candidate);
    // The difference of the lengths is a lower bound of the distance: it saves computing the
    // distance of words that cannot match.
    const std::size_t difference = std::max(name.size(), word.size()) - std::min(name.size(), word.size());
    if (difference >= best_distance) continue;
    const std::size_t distance = edit_distance(word, name);
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return std::string(best);
}

// Returns the end of a message about an unknown name: "; did you mean 'speed'? allowed: rotation,
// speed". Omits the hint if no candidate is near.
template <class Names>
std::string allowed_names(std::string_view word, const Names& candidates) {
  const std::string near = nearest_name(word, candidates);
  std::string text = near.empty() ? "; allowed: " : "; did you mean '" + near + "'? allowed: ";
  const char* separator = "";
  for (const auto& candidate : candidates) {
    text += separator;
    text += std::string_view(candidate);
    separator = ", ";
  }
  return *separator == '\0' ? text + "nothing" : text;
}

}  // namespace slipbench
