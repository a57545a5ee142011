// Output of `slipbench list` and `slipbench describe`. Everything printed comes from the
// declarations that the scene parser reads, so it always matches the parser.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scene/catalogues.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/record/json.h"
#include "tools/train/train_hd.h"

namespace slipbench {

// One of the catalogues.
struct CatalogueKind {
  std::string_view plural;    // "effects", as in `slipbench list effects`
  std::string_view singular;  // "effect"
  std::string_view use;       // key of the scene that names it: "effects"
};

// All kinds, in the order they are listed.
std::span<const CatalogueKind> catalogue_kinds();

// An entry that a scene may name. A material has friction and no parameters; all others have an
// entry only.
struct CatalogueItem {
  CatalogueKind kind;
  Entry entry;
  std::optional<Material> material = {};
  std::string sensor = {};  // for a part of the electronics: type of its sensor
};

// All items of all catalogues: kinds in the order of catalogue_kinds(), items in the order of their
// catalogue.
std::vector<CatalogueItem> catalogue_items(const Catalogues& catalogues);

// The items called `name`: several if catalogues, or several sensors' parts, share the name. Throws
// InputError for an unknown name, with the nearest one of the items and of `others`.
std::vector<CatalogueItem> find_items(const std::vector<CatalogueItem>& items, const std::string& name,
                                      const std::vector<std::string>& others = {});

// The kind with this plural name. Throws InputError for another word, with the nearest one.
CatalogueKind find_kind(const std::string& plural);

// Allowed values of a parameter: "> 0 m and <= 100 mm", "true, false".
std::string allowed_text(const ParameterSpec& spec);

// The part of a scene that names the item with all its parameters at their defaults, ready to be
// copied. `catalogues` provides the other parts that the item needs.
std::string scene_example(const CatalogueItem& item, const Catalogues& catalogues);

// The page of one item: summary, law, source; each parameter with its unit, default, allowed
// values, meaning and source.
std::string describe_text(const CatalogueItem& item, const Catalogues& catalogues, const Style& style, std::size_t width);
Json describe_json(const CatalogueItem& item, const Catalogues& catalogues);

// Names and summaries of the given kinds; a part of the electronics that several sensors share is
// listed once.
std::string list_text(const std::vector<CatalogueItem>& items, std::span<const CatalogueKind> kinds, const Style& style,
                      std::size_t width);
Json list_json(const std::vector<CatalogueItem>& items, std::span<const CatalogueKind> kinds);

// Recipes of `train` (train::recipe_list). `describe` of a recipe runs in Python
// (slipbench/_recipe.py).
std::string recipe_list_text(const Style& style, std::size_t width);
Json recipe_list_json();

// A table of figures, the most informative first: mean and standard deviation over the draws, by
// sequence and by frame.
std::string draws_text(const HdSummary& summary, const Style& style);
// Counts by true class and by assigned class.
std::string confusion_text(const Confusion& confusion, const Style& style);
// Two lines: the delays, and the results by sequence.
std::string delays_text(const Delays& delays);

}  // namespace slipbench
