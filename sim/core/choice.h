// Tables that give each value of an enumeration its name in files, scenes and commands.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace slipbench {

// One row of a table, which is an array of choices.
template <class Value>
struct Choice {
  const char* name;
  Value value;
};

// Returns the name of a value; empty if the table does not have it.
template <class Choices, class Value>
std::string choice_name(const Choices& choices, Value value) {
  for (const auto& choice : choices) {
    if (choice.value == value) return choice.name;
  }
  return "";
}

// Returns all names of a table, whose rows need not be choices: any type with a member `name`.
template <class Choices>
std::vector<std::string> choice_names(const Choices& choices) {
  std::vector<std::string> names;
  for (const auto& choice : choices) names.emplace_back(choice.name);
  return names;
}

// Returns the value of a name, if the table has it.
template <class Choices>
auto choice_value(const Choices& choices, std::string_view name) {
  std::optional<std::remove_cv_t<decltype(choices[0].value)>> value;
  for (const auto& choice : choices) {
    if (choice.name == name) value = choice.value;
  }
  return value;
}

}  // namespace slipbench
