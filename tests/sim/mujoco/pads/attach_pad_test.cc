// attach_pad() against the file with the same pads written out. tests/python/mujoco_test.py
// compares attach_pad() with Python's.
#include <fstream>
#include <iterator>
#include <regex>

#include "sim/mujoco/pads/attach_pad.h"
#include "tests/expect.h"
#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

const std::string hold = SLIPBENCH_SOURCE_DIR "/scenes/mujoco/hold.xml";

// The gripper and the box of hold.xml without pads; its geoms collide, like a robot's.
SpecPointer stock() {
  register_plugin_once();
  std::ifstream file(hold);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex pads(
      R"(<extension>[^]*</extension>|<sensor>[^]*</sensor>|<visual>[^]*</visual>|<keyframe>[^]*</keyframe>|<plugin instance=[^>]*/>|<geom contype="0" conaffinity="0"/>)");
  return parse(std::regex_replace(text, pads, ""));
}

// sensordata after `seconds` under 4 N.
std::vector<double> grasped(const ModelPointer& model, double seconds = 1.0) {
  const DataPointer data(mj_makeData(model.get()));
  mju_fill(data->ctrl, 4.0, static_cast<int>(model->nu));
  const auto steps = static_cast<int>(std::ceil(seconds / model->opt.timestep - 1e-6));
  for (int k = 0; k < steps; ++k) mj_step(model.get(), data.get());
  return {data->sensordata, data->sensordata + model->nsensordata};
}

std::vector<double> reference() {
  register_plugin_once();
  std::array<char, 500> error{};
  const ModelPointer model(mj_loadXML(hold.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
  if (!model) throw std::runtime_error(error.data());
  return grasped(model);
}

void expect_reference(const ModelPointer& model) {
  const std::vector<double> expected = reference(), found = grasped(model);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) ASSERT_NEAR(found[k], expected[k], 1e-12) << k;
}

std::array<AttachedPad, 2> attach_both(mjSpec* spec, const std::string& prefix, const std::string& touch,
                                       const PadOptions& options = {.friction = "0.5"}) {
  return {attach_pad(spec, prefix + "left_pad", {touch}, options), attach_pad(spec, prefix + "right_pad", {touch}, options)};
}

TEST(AttachPad, StockGripperIsHoldXml) {
  for (const std::string touch : {"box", "body:box", "subtree:box", "group:0"}) {
    const SpecPointer spec = stock();
    if (touch == "group:0") {  // the box's only
      for (mjsElement* geom = mjs_firstElement(spec.get(), mjOBJ_GEOM); geom != nullptr;
           geom = mjs_nextElement(spec.get(), geom)) {
        mjs_asGeom(geom)->group = std::string(mjs_getString(mjs_getName(geom))) == "box" ? 0 : 3;
      }
    }
    attach_both(spec.get(), "", touch);
    SCOPED_TRACE(touch);
    expect_reference(compile(spec.get()));
  }
}

// Puts all of the child into the parent.
void attach(const SpecPointer& parent, const SpecPointer& child) {
  const mjsFrame* const here = mjs_addFrame(mjs_findBody(parent.get(), "world"), nullptr);
  ASSERT_NE(mjs_attach(here->element, child->element, "robot/", ""), nullptr) << mjs_getError(parent.get());
}

TEST(AttachPad, PadsMayBeAttachedBeforeAndAfterMjsAttach) {
  for (const bool before : {true, false}) {
    const SpecPointer child = stock(), parent(mj_makeSpec());
    parent->option = child->option;
    if (before) attach_both(child.get(), "", "box");
    attach(parent, child);
    if (!before) attach_both(parent.get(), "robot/", "robot/box");
    expect_reference(compile(parent.get()));
  }
}

TEST(AttachPad, WhatTheParentHasIsExcludedAfterwards) {
  const SpecPointer child = stock(), parent(mj_makeSpec());
  parent->option = child->option;
  mjs_delete(child.get(), mjs_findBody(child.get(), "box")->element);
  const std::array<AttachedPad, 2> pads = attach_both(child.get(), "", "box");
  attach(parent, child);
  mjsBody* const box = mjs_addBody(mjs_findBody(parent.get(), "world"), nullptr);
  mjs_setName(box->element, "box");
  box->pos[2] = 0.1;
  mjs_addFreeJoint(box);
  mjsGeom* const geom = mjs_addGeom(box, nullptr);
  mjs_setName(geom->element, "box");
  geom->type = mjGEOM_BOX;
  for (const int k : {0, 1, 2}) geom->size[k] = k == 2 ? 0.03 : 0.02;
  geom->mass = 0.1;
  for (const AttachedPad& pad : pads) {
    complete_pad(parent.get(), pad);
    complete_pad(parent.get(), pad);  // adds nothing more
  }
  const ModelPointer model = compile(parent.get());
  EXPECT_EQ(model->nexclude, 2);
  expect_reference(model);
}

TEST(AttachPad, ImplicitPadsGetAllTheyNeed) {
  const SpecPointer spec = stock();
  spec->option.timestep = 0.002;  // four times the limit of explicit ones
  spec->option.iterations = 5;
  spec->option.noslip_iterations = 3;
  attach_both(spec.get(), "", "box", {.friction = "{static: 0.5}", .solver = "implicit"});
  const ModelPointer model = compile(spec.get());
  EXPECT_EQ(model->ntendon, 2);
  const std::vector<double> read = grasped(model, 3.0);
  // The fingers' 4 N on nine pillars of three values each.
  double normal = 0.0;
  for (std::size_t pillar = 0; pillar < 9; ++pillar) normal += read[3 * pillar + 2];
  EXPECT_NEAR(normal, 4.0, 1e-3);
}

void expect_refused(const SpecPointer& spec, const std::string& site, const PadOptions& pad,
                    const std::vector<std::string>& words) {
  EXPECT_THAT(refusal_of([&] { attach_pad(spec.get(), site, {"box"}, pad); }), mentions(words));
}

TEST(AttachPad, MistakesAreNamed) {
  const SpecPointer spec = stock();
  expect_refused(spec, "left_pat", {}, {"left_pat", "left_pad", "right_pad"});
  expect_refused(spec, "left_pad", {.check = "maybe"}, {"check", "maybe", "error", "warn"});
  EXPECT_EQ(attach_pad(spec.get(), "left_pad", {"box"}).name, "left_pad");
  expect_refused(spec, "left_pad", {}, {"plugin", "left_pad"});
  mjs_setName(mjs_addSensor(spec.get())->element, "taken");
  expect_refused(spec, "right_pad", {.name = "taken"}, {"sensor", "taken"});
}

}  // namespace
}  // namespace slipbench::testing_plugin
