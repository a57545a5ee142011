// Pads of the plugin on overlapping and thin geoms.
#include <fmt/format.h>

#include "tests/expect.h"
#include "tests/oracle/meshes.h"
#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

constexpr double k_n = 3000.0, k_t = 500.0;  // of nine_pillars()

// A free object of 1 kg, held up only by the tested contact, under a pad that a motor of `force`
// presses on it from above. The object stands on a stiff slide along Z.
std::string pressed(const std::string& geoms, const std::string& touch, const std::string& solver,
                    const std::string& pad = nine_pillars()) {
  const bool implicit = solver == "implicit";
  return "<mujoco><option timestep='2e-4' gravity='0 0 0' " +
         std::string(implicit ? "integrator='discrete' iterations='20'" : "integrator='implicitfast'") +
         "/><extension><plugin plugin='slipbench.field'><instance name='pad'>" + config("pad", "pad") + config("touch", touch) +
         pad + config("friction", "{static: 0.6}") + config("truth", "true") + config("solver", solver) +
         "</instance></plugin></extension><worldbody><body name='object'>"
         "<joint name='stand' type='slide' axis='0 0 1' stiffness='1e5' damping='200'/><inertial pos='0 0 0' mass='1' diaginertia='1e-3 1e-3 1e-3'/><site name='there'/>" +
         geoms +
         "</body><body name='pad' pos='0 0 0.0001'><joint name='press' type='slide' axis='0 0 1' damping='50'/>"
         "<joint name='shear' type='slide' axis='1 0 0' damping='50'/><inertial pos='0 0 0' mass='0.2' diaginertia='1e-4 1e-4 1e-4'/>"
         "<site name='pad'/><plugin instance='pad'/></body></worldbody>"
         "<actuator><motor name='press' joint='press'/><motor name='shear' joint='shear'/></actuator>" +
         std::string(implicit ? "<tendon><spatial damping='1e-9'><site site='pad'/><site site='there'/></spatial></tendon>"
                              : "") +
         "<sensor><plugin name='pad' instance='pad'/></sensor></mujoco>";
}

std::string box(const std::string& name, const std::string& size, const std::string& place) {
  return "<geom name='" + name + "' type='box' contype='0' conaffinity='0' size='" + size + "' pos='" + place + "'/>";
}

class PluginSurfaces : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Solvers, PluginSurfaces, testing::Values("explicit", "implicit"));

TEST_P(PluginSurfaces, OverlappingGeomsBearTheLoadOnce) {
  // 9 pillars under 8.1 N are F/(9 k_n) = 0.3 mm deep, each with 0.9 N, on any number of geoms; 0.9
  // N of shear is k_t u, so it moves by F/(9 k_t) = 0.2 mm.
  const double force = 8.1, shear = 0.9;
  const std::string one = box("a", ".02 .02 .01", "0 0 -.01"), bars = box("a", ".03 .004 .01", "0 0 -.01") +
                                                                      box("b", ".004 .03 .01", "0 0 -.01") +
                                                                      box("c", ".02 .02 .008", "0 0 -.008");
  const std::string capsule =
      "<geom name='b' type='capsule' contype='0' conaffinity='0' size='.01 .01' pos='0 0 -.01' euler='90 0 0'/>";
  const std::vector<std::pair<const char*, std::string>> objects{
      {"one box", one},
      {"two boxes in one place", one + box("b", ".02 .02 .01", "0 0 -.01")},
      {"three boxes", one + box("b", ".02 .02 .01", ".005 0 -.01") + box("c", ".02 .02 .01", "0 .004 -.01")},
      {"a cross of two bars on a plate", bars},
      {"halves, flush under the middle pillars", box("a", ".01 .02 .01", "-.01 0 -.01") + box("b", ".01 .02 .01", ".01 0 -.01")},
      {"box and capsule with level tops", one + capsule}};
  for (const auto& [what, geoms] : objects) {
    const Model model = load(pressed(geoms, "body:object", GetParam()));
    const Data data = data_of(model);
    for (int k = 0; k < 10000; ++k) {
      data->ctrl[0] = -force * std::min(1.0, k / 1000.0);
      data->ctrl[1] = shear * std::min(1.0, std::max(0.0, (k - 5000) / 1000.0));
      mj_step(model.get(), data.get());
    }
    const ContactFrame& frame = pad_of(model.get(), data.get(), 0)->truth(FramePart::all);
    for (Eigen::Index unit = 0; unit < 9; ++unit) {
      EXPECT_NEAR(frame.force(2, unit), force / 9.0, 1e-5) << what << ", unit " << unit;
      EXPECT_NEAR(frame.displacement(2, unit), force / (9.0 * k_n), 1e-8) << what << ", unit " << unit;
      // Elements move from a capsule's crest to the box once the crest is 1 nm lower, after 4.5 um
      // on a radius of 10 mm. Until then their normal leans by up to 4.5e-4, and that share of 0.9
      // N acts on a spring of 500 N/m: 0.8 um, a fraction of which stays.
      EXPECT_NEAR(frame.displacement(0, unit), -shear / (9.0 * k_t), 2e-7) << what << ", unit " << unit;
    }
    EXPECT_NEAR(data->qpos[0], -force / 1e5, 1e-8) << what << ": the object bears the pad's load";
  }
}

TEST_P(PluginSurfaces, AThinCardBearsWhatPressesOnIt) {
  // Beyond its middle a card of 0.3 mm carries as much as one of 20 mm: 40 N, with a PapillArray's
  // pillars 0.5 to 1.2 mm deep.
  const auto forces_on = [&](double half) {
    const Model model = load(pressed(box("card", ".02 .02 " + std::to_string(half), "0 0 -" + std::to_string(half)), "card",
                                     GetParam(), real_pillars()));
    const Data data = data_of(model);
    for (int k = 0; k < 5000; ++k) {
      data->ctrl[0] = -40.0 * std::min(1.0, k / 1000.0);
      mj_step(model.get(), data.get());
    }
    return Eigen::Array3Xd(pad_of(model.get(), data.get(), 0)->truth(FramePart::all).force);
  };
  const Eigen::Array3Xd card = forces_on(0.15e-3), plate = forces_on(10e-3);
  EXPECT_NEAR(plate.row(2).sum(), 40.0, 1e-6);
  EXPECT_GT(plate.row(2).minCoeff(), 1.0);
  EXPECT_LT((card - plate).abs().maxCoeff(), 1e-6);
}

TEST_P(PluginSurfaces, AnElementThatComesThroughARoundBodyIsRefused) {
  // A wire of 0.6 mm along Y under the middle pillars, pressed until they are beyond its middle.
  const Model model = load(pressed(
      "<geom name='wire' type='capsule' contype='0' conaffinity='0' size='.0003 .02' pos='0.00001 0 -.0003' euler='90 0 0'/>",
      "wire", GetParam()));
  const Data data = data_of(model);
  mjModel* const m = model.get();
  mjData* const d = data.get();
  std::string refused;
  for (int k = 0; k < 5000 && refused.empty(); ++k) {
    d->ctrl[0] = -3.0 * k / 1000.0;
    refused = mju_error_of([=] { mj_step(m, d); });
  }
  EXPECT_THAT(refused, mentions({"wire", "object", "0.6 mm"}));
}

const std::string one_element = config("elements", "[[0, 0, 0, 3000, 500]]");

// Steps for one second under `force` [N] and returns the height of the pad's origin [m]. A slide
// with 3 kN/m and 50 N s/m on 0.2 kg settles at 120 /s.
double height_under(double force, const mjModel* model, mjData* data) {
  data->ctrl[0] = -force;
  for (int k = 0; k < 5000; ++k) mj_step(model, data);
  return data->site_xpos[3 * mj_name2id(model, mjOBJ_SITE, "pad") + 2];
}

TEST_P(PluginSurfaces, TheWallOfAMugBearsAsAThickOne) {
  // The middle of a facet of a mug of 40 mm and 180 facets is level and at z = 0. An element of 3
  // N/mm under 0.6 N is 0.2 mm deep, whatever the wall, and the mug's slide of 100 N/mm 6 um.
  constexpr std::uint32_t sides = 180;
  const double half = M_PI / sides, top = 0.04 * std::cos(half);
  for (const double wall : {3e-3, 1e-3}) {
    const oracle::Mesh mug = oracle::can_mesh(0.04, 0.09, sides, wall);
    std::string vertices, faces;
    for (const Eigen::Vector3d& v : mug.vertices) {
      const Eigen::Vector3d out(std::cos(half), std::sin(half), 0.0), along(-std::sin(half), std::cos(half), 0.0);
      vertices += fmt::format("{:.17g} {:.17g} {:.17g} ", 0.05 - v.z(), along.dot(v), out.dot(v) - top);
    }
    for (const auto& [a, b, c] : mug.faces) faces += fmt::format("{} {} {} ", a, b, c);
    std::string xml =
        pressed("<geom name='mug' type='mesh' mesh='mug' contype='0' conaffinity='0'/>", "mug", GetParam(), one_element);
    xml.insert(xml.find("<worldbody>"),
               fmt::format("<asset><mesh name='mug' inertia='shell' vertex='{}' face='{}'/></asset>", vertices, faces));
    const Model model = load(xml);
    const Data data = data_of(model);
    // Vertices are floats: 6e-8 of 0.08 m.
    EXPECT_NEAR(height_under(0.6, model.get(), data.get()), -0.2e-3 - 6e-6, 10e-9) << wall;
  }
}

TEST_P(PluginSurfaces, ANewSizeOfAGeomIsUsed) {
  // The top of each shape is at z = 0. 2.7 N press an element of 3 N/mm 0.9 mm into it and the
  // object 27 um down. Each millimetre that a size grows raises the top and the pad by as much:
  // after a reset, in a new mjData, and without either.
  struct Case {
    std::string geom;
    std::size_t vertical;  // index of the vertical size
  };
  for (const Case& one :
       {Case{"type='box' size='.02 .02 .01' pos='0 0 -.01'", 2}, Case{"type='sphere' size='.02' pos='0 0 -.02'", 0},
        Case{"type='cylinder' size='.02 .01' pos='0 0 -.01'", 1},
        Case{"type='capsule' size='.02 .01' pos='0 0 -.02' euler='90 0 0'", 0},
        Case{"type='ellipsoid' size='.03 .02 .01' pos='0 0 -.01'", 2}}) {
    const Model model =
        load(pressed("<geom name='object' contype='0' conaffinity='0' " + one.geom + "/>", "object", GetParam(), one_element));
    Data data = data_of(model);
    double top = 0.0;
    const auto check = [&](const char* when) {
      EXPECT_NEAR(height_under(2.7, model.get(), data.get()), top - 0.9e-3 - 27e-6, 1e-8) << one.geom << ", " << when;
    };
    const auto grow = [&] {
      model->geom_size[one.vertical] += 1e-3;
      top += 1e-3;
    };
    check("as compiled");
    grow();
    mj_resetData(model.get(), data.get());
    check("after a reset");
    grow();
    check("without a reset");
    grow();
    data = data_of(model);
    check("in a new mjData");
  }
}

TEST(PluginSurfaces, AGeomThatGrowsReachesAPadFarAway) {
  // 5 mm above a ball of 20 mm the pad is idle; it is 1 mm deep in one of 26 mm. geom_rbound, which
  // MuJoCo leaves to the caller, is still that of 20 mm.
  const Model model = load(pressed("<geom name='ball' type='sphere' size='.02' pos='0 0 -.02' contype='0' conaffinity='0'/>",
                                   "ball", "explicit", one_element));
  const Data data = data_of(model);
  data->qpos[1] = 5e-3 - 1e-4;
  for (int k = 0; k < 10; ++k) mj_step(model.get(), data.get());
  ASSERT_EQ(pad_of(model.get(), data.get(), 0)->fields().front().touching(), 0U);
  model->geom_size[0] = 0.026;
  mj_forward(model.get(), data.get());
  EXPECT_NEAR(pad_of(model.get(), data.get(), 0)->fields().front().penetration(0), 1e-3, 1e-12);
}

TEST_P(PluginSurfaces, PillarsAreNotCompressedBeyondTheirHeight) {
  // A PapillArray's pillars are 4.2 mm high and have 7.1 N/mm. At 4.2 mm of the middle one the edges
  // are 4.0 mm and the corners 3.75 mm compressed: 7.1 (4.2 + 4 x 4.0 + 4 x 3.75) = 250 N.
  const Model model = load(pressed(box("block", ".02 .02 .01", "0 0 -.01"), "block", GetParam(), real_pillars()));
  const Data data = data_of(model);
  mjModel* const m = model.get();
  mjData* const d = data.get();
  std::string refused;
  const auto run = [&](double force) {
    for (int k = 0; k < 6000 && refused.empty(); ++k) {
      d->ctrl[0] = std::max(d->ctrl[0] - 0.1, -force);
      refused = mju_error_of([=] { mj_step(m, d); });
    }
  };
  run(247.0);
  EXPECT_EQ(refused, "");
  run(253.0);
  EXPECT_THAT(refused, mentions({"plugin 'pad'", "element 4", "'block'", "4.2 mm"}));
}

TEST(PluginSurfaces, ACardBetweenTwoPadsIsHeldAtAnyGrip) {
  // 0.76 mm thick, like a bank card: the nearest tips pass its middle from 3 N on, its far side
  // from 7 N on.
  for (const double force : {4.0, 8.0, 15.0, 30.0, 60.0}) {
    Grip grip{.mass = 0.005, .dt = 5e-5, .left = real_pillars(), .right = real_pillars(), .perturbed = false};
    std::string xml = grip_xml(grip);
    const auto replace = [&xml](const std::string& from, const std::string& to) { xml.replace(xml.find(from), from.size(), to); };
    replace("size='0.015 0.02 0.06'", "size='0.00038 0.02 0.04'");
    replace("pos='-0.0151 0 0'", "pos='-0.0005 0 0'");
    replace("pos='0.0151 0 0'", "pos='0.0005 0 0'");
    const Model model = load(xml);
    const Data data = data_of(model);
    for (int k = 0; k < 8000; ++k) {
      data->ctrl[0] = force * std::min(1.0, k / 4000.0);
      mj_step(model.get(), data.get());
    }
    for (const int pad : {0, 1}) {
      EXPECT_NEAR(std::abs(force_of_pad(model.get(), data.get(), pad).x()), force, 1e-3 * force) << force << " N, pad " << pad;
      const ContactFrame& frame = pad_of(model.get(), data.get(), pad)->truth(FramePart::all);
      EXPECT_EQ(frame.unit_state[4], UnitState::stick) << force;
      EXPECT_EQ(frame.force.row(2).maxCoeff(), frame.force(2, 4)) << force << " N: the middle pillar is the highest";
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_plugin
