#include "tools/program/verify/verification.h"

#include <algorithm>

namespace slipbench::verify {
namespace {

struct About {
  const char* name;
  const char* of;  // what is counted
};
constexpr std::array<About, 6> about{{{"digests", "trials"},
                                      {"order", "trials"},
                                      {"times", "samples"},
                                      {"values", "values"},
                                      {"events", "samples of units"},
                                      {"cone", "samples of units"}}};

}  // namespace

void Verification::leave_out(Check check, const std::string& why) {
  std::vector<std::string>& said = of(check).left_out;
  if (std::ranges::find(said, why) == said.end()) said.push_back(why);
}

void Verification::fail(Check check, const Where& where, const std::string& what) {
  Entry& entry = of(check);
  if (entry.failed++ >= listed) return;
  entry.failures.push_back({{"check", about[static_cast<std::size_t>(check)].name},
                            {"trial", or_null(where.trial)},
                            {"array", where.array.empty() ? Json(nullptr) : Json(where.array)},
                            {"sample", or_null(where.sample)},
                            {"what", what}});
}

bool Verification::holds() const {
  return std::ranges::all_of(entries_, [](const Entry& entry) { return entry.failed == 0; });
}

Json Verification::json() const {
  Json checks = Json::array(), failures = Json::array();
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    checks.push_back({{"check", about[i].name},
                      {"checked", entry.checked},
                      {"of", about[i].of},
                      {"failed", entry.failed},
                      {"left_out", entry.left_out}});
    for (const Json& failure : entry.failures) failures.push_back(failure);
  }
  return {{"holds", holds()}, {"checks", std::move(checks)}, {"failures", std::move(failures)}};
}

}  // namespace slipbench::verify
