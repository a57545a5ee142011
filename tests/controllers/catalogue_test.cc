// Requirements on every controller of the catalogue.

#include <cmath>
#include <limits>
#include <set>

#include "tests/controllers/rig.h"
#include "tests/expect.h"

namespace slipbench::controllers {
namespace {

// All controllers that read a PapillArray's forces. The user's library and reorient, which reads a
// nib pad, have tests of their own.
std::vector<ControllerKind> built_in() {
  std::vector<ControllerKind> kinds = controller_catalogue();
  std::erase_if(kinds, [](const ControllerKind& kind) { return kind.about.name == "plugin" || kind.about.name == "reorient"; });
  return kinds;
}

// The error that the declaration of `controller`.`key` gives for `text`.
std::string refused_value(const std::string& controller, const std::string& key, const std::string& text) {
  return refusal_of<std::invalid_argument>([&] { (void)named(controller, {{key, text}}); });
}

TEST(Controllers, DeclareThemselvesInFull) {
  std::set<std::string> names;
  for (const Entry& entry : controller_entries()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_FALSE(entry.summary.empty() || entry.law.empty() || entry.source.empty()) << entry.name;
    EXPECT_NO_THROW((void)defaults_of(entry.parameters)) << entry.name;
    for (const ParameterSpec& spec : entry.parameters) {
      EXPECT_FALSE(spec.doc.empty() || spec.source.empty()) << entry.name << "." << spec.name;
    }
  }
}

TEST(Controllers, RefuseAnUnknownName) {
  EXPECT_THAT(refusal_of([] {
                (void)make_controller({"step_on_slipp", {}}, papillarray_source());
              }),
              mentions({"controller", "step_on_slipp", "step_on_slip"}));
}

TEST(Controllers, RefuseASensorWithoutForces) {
  const std::vector<Channel> image{{"image", "1", {16, 16}, {}}, {"force", "N", {3}, {}}};
  for (const ControllerKind& kind : built_in()) {
    const std::string& name = kind.about.name;
    EXPECT_THAT(refusal_of([&] { (void)make_controller(named(name), {.channels = image}); }),
                refused_at("controller.type", {name, "[N, 3]", "image [16, 16]", "force [3]"}));
  }
}

TEST(Controllers, RefuseForcesInAnotherUnit) {
  const std::vector<Channel> small{{"force", "mN", {9, 3}, {}}};
  for (const ControllerKind& kind : built_in()) {
    const std::string& name = kind.about.name;
    EXPECT_THAT(refusal_of([&] { (void)make_controller(named(name), {.channels = small}); }),
                refused_at("controller.type", {name, "in N", "'mN'"}));
  }
}

TEST(Controllers, ThatWaitForADetectorRefuseASceneWithoutOne) {
  GripSource source = papillarray_source();
  source.detected = false;
  const auto refused = [&](const std::string& name) { return refusal_of([&] { (void)make_controller(named(name), source); }); };
  EXPECT_THAT(refused("step_on_slip"), refused_at("controller.type", {"step_on_slip", "detector"}));
  for (const char* name : {"constant_force", "force_ratio", "hold_preset", "timed_grip"}) {
    EXPECT_EQ(refused(name), "accepted") << name;
  }
}

// The channel of forces is not always the first.
TEST(Controllers, FindTheForcesInTheFrame) {
  const std::vector<Channel> channels{{"temperature", "K", {2}, {}}, {"force", "N", {1, 3}, {}}};
  const std::vector<float> values{300.0F, 301.0F, 0.0F, 0.0F, 3.9F};
  for (const ControllerKind& kind : built_in()) {
    const auto controller = make_controller(named(kind.about.name), {.channels = channels, .preset = 4.0});
    ControlInput input;
    input.gripper.position = 20;
    input.frame.values = values;
    EXPECT_EQ(controller->update(input).position, 21) << kind.about.name;
  }
}

TEST(Controllers, RefuseForcesThatAreNotFinite) {
  PillarFrame frame = PillarFrame::of_forces(9.0);
  frame.set_force(4, std::numeric_limits<double>::quiet_NaN(), 0.0);
  for (const ControllerKind& kind : built_in()) {
    const std::string& name = kind.about.name;
    EXPECT_THAT(refusal_of([&] { (void)make(name)->update(input_of(frame, 20, PadState::non_slip, 50)); }),
                refused_at("controller", {"'" + name + "'", "nan N", "1 s"}));
  }
}

TEST(Controllers, KnowAFrameOfAnotherSensorForABug) {
  const std::vector<float> values(3);
  for (const ControllerKind& kind : built_in()) {
    ControlInput input;
    input.frame.values = values;
    EXPECT_THROW((void)make(kind.about.name)->update(input), std::logic_error) << kind.about.name;
  }
}

TEST(Controllers, CommandTheSameForTheSameInputs) {
  for (const ControllerKind& kind : built_in()) {
    const auto one = make(kind.about.name);
    const auto other = make(kind.about.name);
    const auto between = make(kind.about.name);  // instances share nothing
    for (int tick = 0; tick < 200; ++tick) {
      const PillarFrame frame = PillarFrame::of_forces(5.0 + 4.0 * std::sin(0.7 * tick), 1.0 + std::sin(0.3 * tick));
      const ControlInput input = input_of(frame, 40 + tick % 5, tick % 7 == 0 ? PadState::gross : PadState::non_slip, tick);
      const GripCommand command = one->update(input);
      (void)between->update(input_of(PillarFrame::of_forces(0.1), 200, PadState::gross, 3 * tick));
      EXPECT_EQ(other->update(input).position, command.position) << kind.about.name << " update " << tick;
    }
  }
}

TEST(Controllers, RefuseValuesOutOfRange) {
  EXPECT_THAT(refused_value("force_ratio", "mu", "inf"), mentions({"inf", "finite"}));
  EXPECT_THAT(refused_value("hold_preset", "speed_register", "256"), mentions({"256", "0", "255"}));
  EXPECT_THAT(refused_value("step_on_slip", "debounce", "0"), mentions({"0", "1", "1e+06"}));
  EXPECT_THAT(refused_value("step_on_slip", "ceiling", "-1 N"), mentions({"-1 N", "0 N"}));
  EXPECT_EQ(refused_value("step_on_slip", "ceiling", "inf"), "accepted");
  EXPECT_THAT(refused_value("step_on_slip", "overflow", "wrapp"), mentions({"wrapp", "wrap"}));
  EXPECT_THAT(refused_value("force_ratio", "margin", "0"), mentions({"0", "1"}));
}

}  // namespace
}  // namespace slipbench::controllers
