
#include <filesystem>

#include "tests/controllers/rig.h"
#include "tests/expect.h"

namespace slipbench::controllers {
namespace {

const std::string folder = SLIPBENCH_TEST_PLUGINS;

std::string file(const std::string& name) { return folder + "/" + name + ".so"; }

// A PapillArray on the finger that feels, and a sensor of one value.
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

// What the loop does at an instant at which the gripper is read: every sample, then the update.
GripCommand update(Controller& controller, const ControlInput& input) {
  controller.listener()->hear(0, input.frame);
  return controller.update(input);
}

std::string refused(const std::string& path, const ParameterMap& parameters = {}) {
  return refusal_of([&] { (void)load(path, parameters); });
}

const ParameterMap echo_parameters{{"gain", "2.5 mm"}, {"flag", "true"}, {"word", "4 mm"}};

// One count on slip, and no other before the measured position has followed: a gripper that takes three updates moves a count each three.
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
  EXPECT_EQ(with("gian", "1"), "controller.parameters.gian: '" + file("echo") +
                                   "' has no parameter 'gian'; did you mean 'gain'? allowed: word, flag, gain");
  EXPECT_EQ(with("flag", "1"), "controller.parameters.flag: '1' is not a flag; allowed: true, false");
  EXPECT_THAT(with("gain", "2 N"), StartsWith("controller.parameters.gain: "));
  EXPECT_THAT(with("gain", "2 N"), HasSubstr("allowed: m"));
  EXPECT_EQ(with("gain", "inf"), "controller.parameters.gain: 'inf' is infinite; allowed: a finite number");
  EXPECT_EQ(refused(file("throws"), {{"gain", "1"}}),
            "controller.parameters.gain: '" + file("throws") + "' has no parameter 'gain'; allowed: nothing");
}

TEST(Plugin, IsFoundFromTheWorkingFolderWhenItsNameIsBare) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder);
  EXPECT_EQ(refused("step_and_wait.so"), "accepted");
  std::filesystem::current_path(before);
}

TEST(Plugin, RefusesWhatIsNoController) {
  EXPECT_EQ(refusal_of([] { (void)make("plugin"); }),
            "controller.library: no library is named; allowed: the path of a shared library");
  EXPECT_EQ(refused(file("absent")),
            "controller.library: no file '" + file("absent") + "'; allowed: the path of a shared library");
  const std::string source = SLIPBENCH_SOURCE_DIR "/controllers/plugin_controller.cc";
  EXPECT_THAT(refused(source), AllOf(StartsWith("controller.library: cannot load '" + source + "': "),
                                     HasSubstr("invalid ELF header"), HasSubstr("; allowed: a shared library")));
  const std::string allowed = "; allowed: a library that exports what controllers/plugin_abi.h declares";
  EXPECT_EQ(refused(file("empty")),
            "controller.library: '" + file("empty") + "' has no symbol 'slipbench_controller_abi'" + allowed);
  EXPECT_EQ(refused(file("makes_nothing")),
            "controller.library: '" + file("makes_nothing") + "' has no symbol 'slipbench_make_controller'" + allowed);
  EXPECT_EQ(refused(file("other_version")), "controller.library: '" + file("other_version") +
                                                "' was built for version 3 of the controller interface; allowed: 2");
  EXPECT_EQ(refused(file("version_1")),
            "controller.library: '" + file("version_1") + "' was built for version 1 of the controller interface; allowed: 2");
  EXPECT_EQ(refused(folder), "controller.library: '" + folder + "' is no file; allowed: the path of a shared library");
}

TEST(Plugin, MayRefuseAScene) {
  EXPECT_EQ(refused(file("echo")), "controller.library: '" + file("echo") +
                                       "' makes no controller for this scene; allowed: a scene that it can work with");
  EXPECT_EQ(refusal_of([&] {
              (void)load(file("step_and_wait"), {}, two_sensors({{"image", "1", {16, 16}, {}}}));
            }),
            "controller.library: '" + file("step_and_wait") +
                "' makes no controller for this scene: 'it reads a channel force {N, 3}, as a papillarray has it'");
}

TEST(Plugin, ThatThrowsIsAtFault) {
  const std::string threw = "controller.library: '" + file("throws") + "' threw ";
  const auto controller = load(file("throws"));
  EXPECT_EQ(refusal_of([&] { (void)controller->update(input_of(PillarFrame(), 20)); }),
            threw + "'out of ideas' in update; allowed: no exceptions");
  EXPECT_EQ(refusal_of([&] { (void)controller->update(input_of(PillarFrame(), 0)); }),
            threw + "an exception in update; allowed: no exceptions");
  EXPECT_EQ(refused(file("throws_at_once")),
            "controller.library: '" + file("throws_at_once") +
                "' threw 'no controller today' in slipbench_make_controller; allowed: no exceptions");
}

TEST(Plugin, ThatCommandsNothingIsAtFault) {
  const auto controller = load(file("throws"));
  EXPECT_EQ(refusal_of([&] { (void)controller->update(input_of(PillarFrame(), 1)); }),
            "controller.library: '" + file("throws") + "' commands in update position -1; allowed: 0 to 255");
}

}  // namespace
}  // namespace slipbench::controllers
