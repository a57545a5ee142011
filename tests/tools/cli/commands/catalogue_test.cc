// Every entry of the program's catalogues has a complete description and a valid scene as its
// example.

#include "sim/scene/parser.h"
#include "tests/expect.h"
#include "tools/cli/format/describe.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench {
namespace {

struct ProgramCatalogue : ::testing::Test {
  const Catalogues catalogues_ = program_catalogues();
  const std::vector<CatalogueItem> items_ = catalogue_items(catalogues_);
};

// The text with all spaces and line ends as one space, so that wrapping does not matter.
std::string one_line(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n';
    if (!space) result += c;
    if (space && !result.empty() && result.back() != ' ') result += ' ';
  }
  return result;
}

TEST_F(ProgramCatalogue, NoKindIsEmpty) {
  for (const CatalogueKind& kind : catalogue_kinds()) {
    const auto count =
        std::count_if(items_.begin(), items_.end(), [&](const auto& item) { return item.kind.plural == kind.plural; });
    EXPECT_GT(count, 0) << kind.plural;
  }
}

// A shape is a definition: it has no source.
TEST_F(ProgramCatalogue, EveryEntryHasASummaryAndASource) {
  for (const CatalogueItem& item : items_) {
    EXPECT_FALSE(item.entry.summary.empty()) << item.entry.name;
    EXPECT_TRUE(item.kind.plural == "surfaces" || item.kind.plural == "bodies" || !item.entry.source.empty()) << item.entry.name;
    EXPECT_TRUE(item.kind.plural != "effects" || !item.entry.law.empty()) << item.entry.name;
  }
}

TEST_F(ProgramCatalogue, EveryParameterIsShownWithUnitDefaultMeaningAndSource) {
  for (const CatalogueItem& item : items_) {
    const std::string page = one_line(describe_text(item, catalogues_, Style(false), 100));
    for (const ParameterSpec& spec : item.entry.parameters) {
      const std::string where = item.entry.name + "." + spec.name;
      EXPECT_FALSE(spec.doc.empty()) << where;
      EXPECT_FALSE(spec.source.empty()) << where;
      EXPECT_THAT(page, HasSubstr(one_line("default: " + spec.default_text))) << where;
      EXPECT_THAT(page, HasSubstr(one_line("source: " + spec.source))) << where;
      EXPECT_THAT(page, HasSubstr(one_line(spec.doc))) << where;
      if (spec.quantity != Quantity::none) {
        EXPECT_THAT(page, HasSubstr("unit: " + std::string(si_symbol(spec.quantity)))) << where;
      }
    }
  }
}

TEST_F(ProgramCatalogue, EveryExampleIsAValidScene) {
  for (const CatalogueItem& item : items_) {
    std::string text = "slipbench: 1\n" + scene_example(item, catalogues_);
    if (text.find("sensors:") == std::string::npos) text += "sensors: {pad: {type: papillarray}}\n";
    EXPECT_NO_THROW(parse_scene(SceneFile::from_text(text, item.entry.name), catalogues_)) << text;
  }
}

}  // namespace
}  // namespace slipbench
