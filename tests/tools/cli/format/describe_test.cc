
#include "tools/cli/format/describe.h"
#include "tests/expect.h"
#include "tests/tools/cost/example.h"
#include "tools/cli/format/describe_key.h"
#include "tools/cli/format/eval_text.h"
#include "tools/cli/format/schema.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench {
namespace {

using ::testing::ContainsRegex;

// A small catalogue with one parameter of each type. Two kinds share the name "pad".
Catalogues small_catalogues() {
  Catalogues catalogues;
  Entry creep;
  creep.name = "creep";
  creep.summary = "The tip creeps under load.";
  creep.law = "du/dt = f_t / c\n  c  damping";
  creep.source = "A. Author 2020";
  creep.parameters = {number_spec("damping", Quantity::damping, "2 N s/m", positive, "How slowly it creeps.", "assumed"),
                      number_spec("share", Quantity::none, "0.5", fraction, "Share that creeps.", ""),
                      integer_spec("steps", "3", {1.0, 8.0}, "How many.", ""),
                      vector_spec(2, "shift", Quantity::length, "[0 mm, 1 mm]", any_value, "Where to.", ""),
                      choice_spec("mode", "soft", {"soft", "hard"}, "Which.", ""),
                      flag_spec("twice", "false", "Whether twice.", ""),
                      path_spec("table", "own", "Which table.", "")};
  catalogues.effects = {creep};
  Entry pad;
  pad.name = "pad";
  pad.summary = "A sensor.";
  catalogues.sensors = {pad};
  catalogues.surfaces = {pad};
  Entry hum;
  hum.name = "hum";
  hum.summary = "Mains hum.";
  catalogues.electronics["pad"] = {hum};
  catalogues.materials = {{"glass", 0.4, 0.3, "assumed: smooth"}};
  Entry threshold;
  threshold.name = "limit";
  threshold.summary = "A threshold.";
  threshold.parameters = {number_spec("ratio", Quantity::none, "0.4", positive, "Above which it slips.", "")};
  catalogues.detectors = {threshold};
  return catalogues;
}

CatalogueItem item(const std::string& name) { return find_items(catalogue_items(small_catalogues()), name).front(); }

std::string page(const std::string& name) { return describe_text(item(name), small_catalogues(), Style(false), 100); }

std::string refusal(const std::string& name) {
  return refusal_of([&] { find_items(catalogue_items(small_catalogues()), name); });
}

TEST(Describe, PageHoldsEverythingDeclared) {
  EXPECT_THAT(page("creep"),
              AllOf(mentions({"effect", "The tip creeps under load.", "du/dt = f_t / c", "A. Author 2020",
                              "How slowly it creeps.", "2 N s/m", "> 0 N s/m", "assumed", ">= 0 and <= 1", ">= 1 and <= 8",
                              "[0 mm, 1 mm]", "soft, hard", "own, or a path relative to the scene's folder"}),
                    HasSubstr("  effects:\n    - creep:\n        damping: 2 N s/m\n        share: 0.5\n")));
}

TEST(Describe, DetectorStandsBesideTheSensors) {
  EXPECT_THAT(page("limit"), HasSubstr("In a scene (detector.type)\n  detector:\n    type: limit\n    ratio: 0.4\n"));
}

TEST(Describe, MaterialShowsItsFrictionAndSource) {
  const std::string text = page("glass");
  EXPECT_THAT(text, HasSubstr("mu_static  0.4\n  mu_kinetic 0.3\n"));
  EXPECT_THAT(text, HasSubstr("assumed: smooth"));
  EXPECT_THAT(text, HasSubstr("surface: {material: glass}"));
}

TEST(Describe, NamesSharedByCataloguesAreAllFound) {
  const std::vector<CatalogueItem> found = find_items(catalogue_items(small_catalogues()), "pad");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].kind.singular, "sensor");
  EXPECT_EQ(found[1].kind.singular, "surface");
}

TEST(Describe, UnknownNameGetsTheNearestOne) {
  EXPECT_THAT(refusal("crep"), refused_at("describe", {"crep", "creep"}));
  EXPECT_THAT(refusal("nonsense"), refused_at("describe", {"nonsense"}));
}

TEST(Describe, ExamplesNameTheEntryWhereItsKindBelongs) {
  const Catalogues catalogues = small_catalogues();
  EXPECT_EQ(scene_example(item("pad"), catalogues), "sensors:\n  pad:\n    type: pad\n");
  EXPECT_EQ(scene_example(find_items(catalogue_items(catalogues), "pad")[1], catalogues), "surface:\n  shape: pad\n");
  EXPECT_EQ(scene_example(item("hum"), catalogues), "sensors:\n  pad:\n    type: pad\n    electronics:\n      - hum\n");
}

// Its numbers have no units, as in MuJoCo: the meaning states them.
TEST(Describe, ContactIsTheScenesOwnKey) {
  const std::string text = page("contact");
  EXPECT_THAT(text, HasSubstr("contact  part of fidelity mujoco_contact\n  MuJoCo's own contact friction"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "  solref  2 numbers\n      Time constant [s] and damping ratio of a contact, both above 0; or -stiffness [1/s2] and\n      -damping [1/s], both below 0.\n"));
  EXPECT_THAT(text, HasSubstr("      default: [0.02, 1]\n"));
  EXPECT_THAT(text, HasSubstr("      unit:    kg (also g)\n      default: 0.1 g\n"));
  EXPECT_THAT(text,
              HasSubstr("In a scene (contact)\n  fidelity: mujoco_contact\n  friction: {static: 0.5, kinetic: 0.5}\n  contact:\n"
                        "    integrator: discrete\n    cone: elliptic\n"));
}

TEST(Describe, ColoursOnlyWhereTheStyleHasThem) {
  EXPECT_THAT(page("creep"), Not(HasSubstr("\033")));
  EXPECT_THAT(terminal_text(describe_text(item("creep"), small_catalogues(), Style(true), 100)),
              HasSubstr("\033[1;36mcreep\033[0m"));
}

TEST(Describe, JsonHoldsEverythingDeclared) {
  const nlohmann::ordered_json json = describe_json(item("creep"), small_catalogues());
  EXPECT_EQ(json["kind"], "effect");
  EXPECT_EQ(json["law"], "du/dt = f_t / c\n  c  damping");
  ASSERT_EQ(json["parameters"].size(), 7U);
  const nlohmann::ordered_json& damping = json["parameters"][0];
  EXPECT_EQ(damping["name"], "damping");
  EXPECT_EQ(damping["unit"], "N s/m");
  EXPECT_EQ(damping["default"], "2 N s/m");
  EXPECT_EQ(damping["allowed"], "> 0 N s/m");
  EXPECT_EQ(damping["source"], "assumed");
  EXPECT_EQ(json["parameters"][4]["choices"], nlohmann::ordered_json({"soft", "hard"}));
  const nlohmann::ordered_json glass = describe_json(item("glass"), small_catalogues());
  EXPECT_EQ(glass["mu_static"], 0.4);
  EXPECT_EQ(glass["mu_kinetic"], 0.3);
}

TEST(List, ShowsNamesAndSummariesByKind) {
  const std::vector<CatalogueItem> items = catalogue_items(small_catalogues());
  const std::string text = list_text(items, catalogue_kinds(), Style(false), 100);
  EXPECT_THAT(text, ContainsRegex("sensors .*sensors.<name>.type\n +pad +A sensor"));
  EXPECT_THAT(text, ContainsRegex("materials .*surface.material\n +glass +mu_static 0\\.4, mu_kinetic 0\\.3\n"));
  EXPECT_THAT(text, ContainsRegex("motions .*motion.kind\n +.none.\n"));
}

TEST(List, OneKindOnly) {
  const std::vector<CatalogueItem> items = catalogue_items(small_catalogues());
  const CatalogueKind kind = find_kind("materials");
  EXPECT_EQ(list_text(items, {&kind, 1}, Style(false), 100),
            "materials  scene key surface.material\n  glass    mu_static 0.4, mu_kinetic 0.3\n");
  EXPECT_EQ(list_json(items, {&kind, 1}).dump(), R"({"materials":[{"name":"glass","summary":"mu_static 0.4, mu_kinetic 0.3"}]})");
}

TEST(List, LongSummariesWrapBesideTheirName) {
  const std::vector<CatalogueItem> items = catalogue_items(small_catalogues());
  const CatalogueKind kind = find_kind("effects");
  // Eleven columns of margin leave 15 of the 26.
  EXPECT_EQ(list_text(items, {&kind, 1}, Style(false), 26),
            "effects  scene key effects\n  creep    The tip creeps\n           under load.\n");
}

TEST(List, UnknownCatalogueGetsTheNearestOne) {
  EXPECT_THAT(refusal_of([&] { find_kind("sensor"); }), refused_at("list", {"sensor", "sensors"}));
}

std::string text_of(const cost::Exploration& exploration) { return cost_text(exploration, Style(false), 120); }

TEST(CostText, SaysFirstWhatAnErrorCosts) {
  cost::Exploration exploration = cost::example();
  exploration.description = "a slide";
  EXPECT_THAT(text_of(exploration), StartsWith("a slide\n  slip onset, error up to 1 %: 500 times real time"));
}

// 2 s in 4 ms: 500 times real time; 0.005 is 0.5 %.
TEST(CostText, EverySettingHasALineBelowItsSeries) {
  const std::string text = text_of(cost::example());
  EXPECT_THAT(text, ContainsRegex("setting +times real time +CPU ms +\\+- +onset \\[%\\]\n"));
  EXPECT_THAT(text, ContainsRegex("    5 ms +500 +4 +0 % +0\\.5\n"));
  EXPECT_LT(text.find("element field"), text.find("MuJoCo's own contact\n"));
}

TEST(CostText, WhatDidNotRunSaysWhyOnce) {
  cost::Exploration exploration = cost::example();
  exploration.rows.push_back(exploration.rows.back());
  exploration.rows.back().setting.label = "stiffer";
  EXPECT_THAT(text_of(exploration), HasSubstr("  contact stiff; contact stiffer: MuJoCo warned\n"));
}

TEST(CostText, ARunInWhichOtherThingsHappenHasNoNumber) {
  cost::Exploration exploration = cost::example();
  exploration.rows[1].errors = cost::onset_error(0.05, true);
  EXPECT_THAT(text_of(exploration), ContainsRegex("    10 ms +1000 +2 +0 % +other\n"));
}

TEST(CostText, PricesStandBelow) {
  cost::Exploration exploration = cost::example();
  EXPECT_THAT(text_of(exploration), Not(HasSubstr("cost and influence of each effect")));
  exploration.prices = {
      {.name = "ageing", .without = cost::CpuTime{0.015, 0.014, 0.016, 9}, .share = 0.25, .low = 0.2, .high = 0.3}};
  EXPECT_THAT(text_of(exploration), HasSubstr("  ageing      25.0 %  20.0 to 30.0"));
}

TEST(Describe, EveryKeyOfAScene) {
  const Json schema = scene_schema(program_catalogues());
  for (const std::string& key : scene_key_names()) {
    const std::string text = describe_key_text(key, schema, Style(false), 100);
    EXPECT_THAT(text, StartsWith(key + "  key of a scene\n  ")) << key;
    EXPECT_EQ(describe_key_json(key, schema)["schema"], schema["properties"][key]) << key;
  }
  const auto said = [&](const char* key) { return describe_key_text(key, schema, Style(false), 100); };
  EXPECT_THAT(said("split"), mentions({"by", "material", "shares", "default:"}));
  EXPECT_THAT(said("expect"), mentions({"confidence", "control"}));
  EXPECT_THAT(said("sweep"), mentions({"trials", "motion.speed", "log_uniform"}));
  EXPECT_THAT(said("motion"), mentions({"kind", "stage", "lift"}));
}

}  // namespace

}  // namespace slipbench
