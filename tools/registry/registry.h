// Types that an embedding application adds to a catalogue at run time.
#pragma once

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Thread-safe. `Maker` creates an object of the type.
template <class Maker>
class Registry {
 public:
  // `kind` names the catalogue in errors, such as "detector"; `taken`: the catalogue's own entries.
  // Throws InputError if the name is not an identifier or is one of `taken`.
  void put(const std::string& kind, const Entry& about, Maker make, const std::vector<Entry>& taken) {
    if (!is_identifier(about.name))
      throw InputError(kind + " " + quote(about.name) + " is not a valid name; allowed: letters, digits and '_', no digit first");
    if (about.name == "none" || std::ranges::find(taken, about.name, &Entry::name) != taken.end())
      throw InputError(kind + " " + quote(about.name) + " is a name of slipbench itself; choose another name");
    const std::scoped_lock lock(mutex_);
    held_.insert_or_assign(about.name, std::pair(about, std::move(make)));
  }
  [[nodiscard]] std::optional<Maker> find(const std::string& name) const {
    const std::scoped_lock lock(mutex_);
    const auto found = held_.find(name);
    return found == held_.end() ? std::nullopt : std::optional<Maker>(found->second.second);
  }
  // Sorted by name.
  [[nodiscard]] std::vector<Entry> entries() const {
    const std::scoped_lock lock(mutex_);
    std::vector<Entry> entries;
    for (const auto& [name, held] : held_) entries.push_back(held.first);
    return entries;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::pair<Entry, Maker>> held_;
};

}  // namespace slipbench
