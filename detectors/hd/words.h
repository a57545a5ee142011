// Names of a model's choices in files, scenes and commands.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/model.h"

namespace slipbench::hd {

template <class Value>
struct Word {
  const char* name;
  Value value;
};

inline constexpr std::array encoding_words{Word<Encoding>{"spatial", Encoding::spatial},
                                           Word<Encoding>{"spatial_temporal", Encoding::spatial_temporal},
                                           Word<Encoding>{"graph_spatial_temporal", Encoding::graph_spatial_temporal}};
inline constexpr std::array ties_words{Word<Ties>{"one", Ties::one}, Word<Ties>{"zero", Ties::zero}};
inline constexpr std::array compat_words{Word<Compat>{"paper", Compat::paper},
                                         Word<Compat>{"published_core", Compat::published_core}};
inline constexpr std::array quantiser_words{Word<Quantiser>{"fixed_point", Quantiser::fixed_point},
                                            Word<Quantiser>{"exact", Quantiser::exact},
                                            Word<Quantiser>{"unrounded", Quantiser::unrounded}};

// Returns the word for a value in its table.
template <class Words, class Value>
std::string name_of(const Words& words, Value value) {
  for (const auto& word : words) {
    if (word.value == value) return word.name;
  }
  return "";
}

// Returns all words of a table.
template <class Words>
std::vector<std::string> names_of(const Words& words) {
  std::vector<std::string> names;
  for (const auto& word : words) names.emplace_back(word.name);
  return names;
}

// Returns the value of a word, if the table has it.
template <class Words>
auto value_of(const Words& words, std::string_view name) {
  std::optional<std::remove_cv_t<decltype(words[0].value)>> value;
  for (const auto& word : words) {
    if (word.name == name) value = word.value;
  }
  return value;
}

}  // namespace slipbench::hd
