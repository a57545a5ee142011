// What was checked of a dataset, and what does not hold.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace slipbench::verify {

enum class Check : std::size_t { digests, order, times, values, events, cone };

// Where something does not hold.
struct Where {
  std::optional<std::size_t> trial = {};
  std::string array = {};                  // inside the trial: "labels/pad/margin"
  std::optional<std::size_t> sample = {};  // row of the array
};

class Verification {
 public:
  // Of each check so many failures are listed, the others counted.
  static constexpr std::size_t listed = 5;

  // `count` more of what the check looks at: trials for digests and order, values or samples of units for the others.
  void count(Check check, std::size_t count) { of(check).checked += count; }
  // What was left out, and why. Said once.
  void leave_out(Check check, const std::string& why);
  void fail(Check check, const Where& where, const std::string& what);

  [[nodiscard]] bool holds() const;
  // {"holds", "checks": [{"check", "checked", "of", "failed", "left_out": [...]}], "failures": [{"check", "trial", "array", "sample", "what"}]}
  [[nodiscard]] nlohmann::ordered_json json() const;

 private:
  struct Entry {
    std::size_t checked = 0, failed = 0;
    std::vector<std::string> left_out;
    nlohmann::ordered_json failures = nlohmann::ordered_json::array();
  };
  Entry& of(Check check) { return entries_[static_cast<std::size_t>(check)]; }

  std::array<Entry, 6> entries_;
};

}  // namespace slipbench::verify
