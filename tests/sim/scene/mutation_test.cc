// Randomly damaged scene files give a valid plan or an InputError that names the file, never a
// crash, a hang or another exception. 10,000 files, the same ones in every run.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/random.h"
#include "sim/scene/parser.h"
#include "tests/sim/scene/test_catalogues.h"

namespace slipbench {
namespace {

// The first fourteen are numbers.
// clang-format off
constexpr std::array<std::string_view, 42> tokens{
    "inf", "-inf", ".nan", "nan", "1e999", "-1", "0", "1e-320", "99999999999999999999", "1e308", "-1e308", "5e-324",
    "1e308 mm/s", "1.7976931348623157e308", "expect: {}", "4 mm/s", "3 N", "true", "~", "null", "[]", "{}", "[", "}",
    "&a ", "*a", "<<: ", "!!int ", "---\n", "...", "? ", ": ", "- ", "\t", "#", "|", ">", "\"", "'",
    "{draw: normal, mean: 0, sd: 1}", "{draw: choice, values: [1, {a: 2}]}", "trials: 1000000"};
// clang-format on

class Mutator {
 public:
  explicit Mutator(std::uint64_t number) : random_(1, number, "mutation") {}

  std::string mutate(std::string text) {
    for (std::uint64_t n = 1 + random_.integer(4); n > 0; --n) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_.integer(std::max<std::size_t>(1, bound))); }

  void change(std::string& text) {
    switch (below(9)) {
      case 0: flip_bit(text); break;
      case 1: text.insert(below(text.size() + 1), tokens.at(below(tokens.size()))); break;
      case 2: text.erase(below(text.size()), below(20)); break;
      case 3: text.resize(below(text.size() + 1)); break;
      case 4: swap_lines(text); break;
      case 5: double_line(text); break;
      case 6: rename_key(text); break;
      case 7: change_number(text); break;
      case 8: move_piece(text); break;
    }
  }

  void flip_bit(std::string& text) {
    if (text.empty()) return;
    char& byte = text[below(text.size())];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ (1u << below(8)));
  }

  static std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text) {
      lines.back() += c;
      if (c == '\n') lines.emplace_back();
    }
    return lines;
  }

  static std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line;
    return text;
  }

  void swap_lines(std::string& text) {
    std::vector<std::string> lines = lines_of(text);
    std::swap(lines[below(lines.size())], lines[below(lines.size())]);
    text = joined(lines);
  }

  void double_line(std::string& text) {
    std::vector<std::string> lines = lines_of(text);
    const std::string line = lines[below(lines.size())];
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(below(lines.size())), line);
    text = joined(lines);
  }

  // Changes the letter before a random colon.
  void rename_key(std::string& text) {
    const std::size_t colon = text.find(':', below(text.size()));
    if (colon == std::string::npos || colon == 0) return;
    text[colon - 1] = static_cast<char>('a' + below(26));
  }

  // Replaces the digits at or after a random position.
  void change_number(std::string& text) {
    const std::size_t first = text.find_first_of("0123456789", below(text.size()));
    if (first == std::string::npos) return;
    const std::size_t last = std::min(text.find_first_not_of("0123456789.", first), text.size());
    text.replace(first, last - first, tokens.at(below(14)));  // the first fourteen are numbers
  }

  void move_piece(std::string& text) {
    const std::size_t first = below(text.size());
    const std::string piece = text.substr(std::min(first, text.size()), below(40));
    text.insert(below(text.size() + 1), piece);
  }

  RandomStream random_;
};

class Mutation : public testing::TestWithParam<const char*> {};

TEST_P(Mutation, IsAValidPlanOrAnInputError) {
  const Catalogues catalogues = test_catalogues();
  const SceneFile original = SceneFile::load(std::string(SLIPBENCH_SOURCE_DIR) + "/scenes/papillarray/" + GetParam());
  constexpr std::uint64_t count = 5000;
  std::uint64_t valid = 0;
  for (std::uint64_t number = 0; number < count; ++number) {
    const std::string text = Mutator(number).mutate(original.text());
    try {
      const TrialPlan plan(SceneFile::from_text(text, "mutant.yaml"), catalogues, 0, number);
      static_cast<void>(plan.trial(plan.size() - 1));
      ++valid;
    } catch (const InputError& error) {
      ASSERT_TRUE(std::string_view(error.what()).starts_with("mutant.yaml")) << error.what() << "\nmutant " << number << ":\n"
                                                                             << text;
    } catch (const std::exception& error) {
      FAIL() << error.what() << "\nmutant " << number << ":\n" << text;
    }
  }
  // Mutations are small: some leave a valid scene (in a comment, or a number in range), most do
  // not.
  EXPECT_GT(valid, count / 20);
  EXPECT_LT(valid, count);
}

INSTANTIATE_TEST_SUITE_P(ShippedScenes, Mutation, testing::Values("stage.yaml", "hexapod.yaml"),
                         [](const testing::TestParamInfo<const char*>& info) {
                           return std::string(info.param, std::string_view(info.param).find('.'));
                         });

}  // namespace
}  // namespace slipbench
