
#include <filesystem>

#include "tests/controllers/rig.h"
#include "tests/expect.h"

namespace slipbench::controllers {
namespace {

const std::string folder = SLIPBENCH_TEST_PLUGINS;

std::string file(const std::string& name) { return folder + "/" + name + ".so"; }

// A PapillArray on the sensing finger, and a sensor with one value.
GripSource two_sensors(const std::vector<Channel>& channels = papillarray_channels()) {
  GripSource source{.channels = channels, .preset = 4.0};
  source.sensors = {{"pad", "papillarray", 1000.0, channels}, {"skin", "piezo_skin", 500.0, {{"signal", "counts", {1}, {}}}}};
  return source;
}

std::unique_ptr<Controller> load(const std::string& path, const ParameterMap& parameters = {},
                                 const GripSource& source = two_sensors()) {
  Named controller = named("plugin", {{"library", path}});
  controller.parameters.set("parameters", parameters);
  return make_controller(controller, source);
}

// The loop's calls when the gripper is read: every sample, then the update.
GripCommand update(Controller& controller, const ControlInput& input) {
  controller.listener()->hear(0, input.frame);
  return controller.update(input);
}

std::string refused(const std::string& path, const ParameterMap& parameters = {}) {
  return refusal_of([&] { (void)load(path, parameters); });
}

const ParameterMap echo_parameters{{"gain", "2.5 mm"}, {"flag", "true"}, {"word", "4 mm"}};

// One count on slip, then none until the measured position has followed: a gripper that takes three
// updates moves one count per three updates.
TEST(Plugin, RunsTheExample) {
  const auto controller = load(file("step_and_wait"));
  const PillarFrame frame = PillarFrame::of_forces(4.1);
  EXPECT_EQ(update(*controller, input_of(frame, 20, PadState::non_slip)).position, 20);
  EXPECT_EQ(update(*controller, input_of(frame, 20, PadState::incipient)).position, 21);
  EXPECT_EQ(update(*controller, input_of(frame, 20, PadState::gross)).position, 21);
  EXPECT_EQ(update(*controller, input_of(frame, 21, PadState::gross)).position, 22);
  EXPECT_EQ(update(*controller, input_of(frame, 21, PadState::non_slip)).position, 22);
  EXPECT_EQ(update(*controller, input_of(frame, 22, PadState::non_slip)).position, 22);
  EXPECT_EQ(update(*controller, input_of(PillarFrame::of_forces(3.9), 22)).position, 23) << "below the preset of 4 N";
}

TEST(Plugin, MakesAControllerOfItsOwnEachTime) {
  const auto one = load(file("step_and_wait"));
  const auto other = load(file("step_and_wait"));
  const PillarFrame frame = PillarFrame::of_forces(4.1);
  EXPECT_EQ(update(*one, input_of(frame, 20, PadState::gross)).position, 21);
  EXPECT_EQ(update(*other, input_of(frame, 30, PadState::gross)).position, 31);
  EXPECT_EQ(update(*one, input_of(frame, 20)).position, 21);
}

TEST(Plugin, RunsTheExampleWithItsParameter) {
  const auto controller = load(file("step_and_wait"), {{"counts", "3"}});
  EXPECT_EQ(update(*controller, input_of(PillarFrame::of_forces(4.1), 20, PadState::gross)).position, 23);
}

TEST(Plugin, IsHandedEverything) {
  const auto controller = load(file("echo"), echo_parameters);
  std::vector<float> values(2 * pillars * 3);
  values.back() = 7.0F;
  ControlInput input;
  input.slip = {.time = 0.1, .latency = 0.2, .state = PadState::gross, .stuck_fraction = 0.5};
  input.frame = {.time = 0.3, .values = values};
  input.gripper = {.time = 0.4, .position = 42, .moving = false, .stopped = true};
  const GripCommand first = update(*controller, input);
  EXPECT_EQ(first.position, 13) << "one of the values was not as it was given";
  EXPECT_EQ(first.speed, 0);
  EXPECT_EQ(first.force, 255) << "the other sensor has no sample yet";
  for (const float value : {1.5F, 2.5F}) controller->listener()->hear(1, {.time = 0.4, .values = {&value, 1}});
  const GripCommand second = update(*controller, input);
  EXPECT_EQ(second.speed, 2);
  EXPECT_EQ(second.force, 25);
  const GripCommand third = update(*controller, input);
  EXPECT_EQ(third.speed, 0) << "nothing is new";
  EXPECT_EQ(third.force, 25);
}

TEST(Plugin, TakesTheParametersThatItDeclares) {
  const auto with = [](const std::string& name, const std::string& text) { return refused(file("echo"), {{name, text}}); };
  EXPECT_THAT(with("gian", "1"), refused_at("controller.parameters.gian", {file("echo"), "gian", "gain"}));
  EXPECT_THAT(with("flag", "1"), refused_at("controller.parameters.flag", {"1", "true", "false"}));
  EXPECT_THAT(with("gain", "2 N"), refused_at("controller.parameters.gain", {"2 N", "m"}));
  EXPECT_THAT(with("gain", "inf"), refused_at("controller.parameters.gain", {"inf", "finite"}));
  EXPECT_THAT(refused(file("throws"), {{"gain", "1"}}), refused_at("controller.parameters.gain", {file("throws"), "gain"}));
}

TEST(Plugin, IsFoundFromTheWorkingFolderWhenItsNameIsBare) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  EXPECT_EQ(refused("step_and_wait.so"), "accepted");
  std::filesystem::current_path(before);
}

TEST(Plugin, RefusesWhatIsNoController) {
  EXPECT_THAT(refusal_of([] { (void)make("plugin"); }), refused_at("controller.library", {"path"}));
  EXPECT_THAT(refused(file("absent")), refused_at("controller.library", {file("absent")}));
  const std::string source = SLIPBENCH_SOURCE_DIR "/controllers/plugin_controller.cc";
  EXPECT_THAT(refused(source), refused_at("controller.library", {source, "invalid ELF header"}));
  EXPECT_THAT(refused(file("empty")),
              refused_at("controller.library", {file("empty"), "slipbench_controller_abi", "controllers/plugin_abi.h"}));
  EXPECT_THAT(refused(file("makes_nothing")),
              refused_at("controller.library", {file("makes_nothing"), "slipbench_make_controller", "controllers/plugin_abi.h"}));
  EXPECT_THAT(refused(file("other_version")), refused_at("controller.library", {file("other_version"), "version 3", "2"}));
  EXPECT_THAT(refused(file("version_1")), refused_at("controller.library", {file("version_1"), "version 1", "2"}));
  EXPECT_THAT(refused(folder), refused_at("controller.library", {folder, "shared library"}));
}

TEST(Plugin, MayRefuseAScene) {
  EXPECT_THAT(refused(file("echo")), refused_at("controller.library", {file("echo"), "scene"}));
  EXPECT_THAT(refusal_of([&] {
                (void)load(file("step_and_wait"), {}, two_sensors({{"image", "1", {16, 16}, {}}}));
              }),
              refused_at("controller.library", {file("step_and_wait"), "force {N, 3}", "papillarray"}));
}

TEST(Plugin, ThatThrowsIsAtFault) {
  const auto controller = load(file("throws"));
  EXPECT_THAT(refusal_of([&] { (void)controller->update(input_of(PillarFrame(), 20)); }),
              refused_at("controller.library", {file("throws"), "out of ideas", "update"}));
  EXPECT_THAT(refusal_of([&] { (void)controller->update(input_of(PillarFrame(), 0)); }),
              refused_at("controller.library", {file("throws"), "exception", "update"}));
  EXPECT_THAT(refused(file("throws_at_once")),
              refused_at("controller.library", {file("throws_at_once"), "no controller today", "slipbench_make_controller"}));
}

TEST(Plugin, ThatCommandsNothingIsAtFault) {
  const auto controller = load(file("throws"));
  EXPECT_THAT(refusal_of([&] { (void)controller->update(input_of(PillarFrame(), 1)); }),
              refused_at("controller.library", {file("throws"), "update", "position", "-1", "255"}));
}

}  // namespace
}  // namespace slipbench::controllers
