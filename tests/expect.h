// Includes of every test: GoogleTest, GoogleMock's matchers by their own names, the errors, and
// helpers for refused calls.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/error.h"

namespace slipbench {

using ::testing::AllOf, ::testing::AnyOf, ::testing::Contains, ::testing::DoubleNear, ::testing::Each, ::testing::ElementsAre,
    ::testing::EndsWith, ::testing::HasSubstr, ::testing::IsEmpty, ::testing::Not, ::testing::Pair, ::testing::SizeIs,
    ::testing::StartsWith;

using MessageMatcher = ::testing::Matcher<const std::string&>;

// True if `begin` to `end` of `text` is a whole word, number or key: "4" is neither in "4096" nor
// in "0.4", nor "motion" in "motion.speed".
inline bool stands_alone(std::string_view text, std::size_t begin, std::size_t end) {
  const auto of_a_word = [text](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  // From `at` on, and from its neighbour if a dot joins the two.
  const auto goes_on = [&](std::size_t at, std::size_t neighbour) {
    return of_a_word(at) || (at < text.size() && text[at] == '.' && of_a_word(neighbour));
  };
  return !(of_a_word(begin) && begin > 0 && goes_on(begin - 1, begin - 2)) && !(of_a_word(end - 1) && goes_on(end, end + 1));
}

inline bool has_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    if (stands_alone(text, at, at + word.size())) return true;
  }
  return false;
}

MATCHER_P(HasWord, word, "has the word " + ::testing::PrintToString(word)) { return has_word(arg, word); }

// Matches a message that contains all of `words`: the key, the value found, the nearest name, a
// limit. A test with them fails if another error is reported, but not if a sentence is improved.
inline MessageMatcher mentions(const std::vector<std::string>& words) {
  std::vector<MessageMatcher> all;
  for (const std::string& word : words) all.emplace_back(HasWord(word));
  return ::testing::AllOfArray(all);
}

MATCHER_P2(BeginsAt, place, rest,
           "begins with the place " + ::testing::PrintToString(place) + " and continues with what " +
               ::testing::DescribeMatcher<const std::string&>(rest)) {
  const std::string_view text(arg);
  return text.starts_with(place) && stands_alone(text, 0, place.size()) &&
         ::testing::ExplainMatchResult(rest, std::string(text.substr(place.size())), result_listener);
}

// Matches a message that begins with `place` (a file and its line, a key or a command), followed by
// all of `words`.
inline MessageMatcher refused_at(const std::string& place, const std::vector<std::string>& words) {
  return BeginsAt(place, mentions(words));
}

// A row of a table of wrong inputs. A valid input has the place "accepted", as refusal_of() returns
// it, and no words.
template <class Input = std::string>
struct Refused {
  Input input;
  std::string place;
  std::vector<std::string> words;
};

// Expects for each row that `refusal(input)`, a message, has its place and words.
template <class Input, class Refusal>
void expect_refusals(const std::vector<Refused<Input>>& rows, Refusal&& refusal) {
  for (const auto& [input, place, words] : rows)
    EXPECT_THAT(refusal(input), refused_at(place, words)) << ::testing::PrintToString(input);
}

// Returns the message of the Error that `call` throws, or "accepted".
template <class Error = InputError, class Call>
std::string refusal_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

// Returns path and message of the SceneValueError that `call` throws: "path | message".
template <class Call>
std::string scene_refusal_of(Call&& call) {
  try {
    call();
  } catch (const SceneValueError& error) {
    return error.path() + " | " + error.what();
  }
  return "accepted";
}

}  // namespace slipbench
