// A pad of many elements, where the field computes only participating ones, against pads of a few
// of its rows, where it computes all.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::sparse_test {
namespace {

// Groups of four cross the ends of rows; the last group of the 225 elements has one.
constexpr std::size_t rows = 15, columns = 15, rows_a_part = 3;

PadLayout part_of_pad(std::size_t first_row, std::size_t count) {
  PadLayout pad;
  for (std::size_t r = first_row; r < first_row + count; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      Element element;
      element.tip = {2e-3 * (static_cast<double>(c) - 7.0), 2e-3 * (static_cast<double>(r) - 7.5),
                     1e-5 * static_cast<double>((r * c) % 7)};
      element.k_normal = 100.0 + static_cast<double>(c);
      element.k_tangential = 50.0 + static_cast<double>(r);
      pad.units.push_back({pad.elements.size(), 1});
      pad.elements.push_back(element);
    }
  }
  return pad;
}

struct Bench {
  Bench(const PadLayout& pad, const Surface& surface, Friction friction) : field(pad, surface, friction), labels(pad) {}
  void step(const Pose& pose, double time, bool drawn = false) {
    field.step(pose, 1e-3);
    if (drawn) field.view_from_pad();  // as a viewer does, between the step and the labels
    labels.update({&field, 1}, time, 1e-3);
  }
  Field field;
  ContactLabels labels;
};

// Treats 0 and -0 as equal, and NaN on both sides as equal.
::testing::AssertionResult same(double a, double b, const char* what) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << what << ": " << a << " and " << b;
}

::testing::AssertionResult same_element(const Bench& whole, std::size_t i, const Bench& part, std::size_t j) {
  if (whole.field.state(i) != part.field.state(j)) return ::testing::AssertionFailure() << "state";
  if (auto r = same(whole.field.normal_force(i), part.field.normal_force(j), "normal force"); !r) return r;
  if (auto r = same(whole.field.penetration(i), part.field.penetration(j), "penetration"); !r) return r;
  if (auto r = same(whole.field.stick_limit(i), part.field.stick_limit(j), "limit"); !r) return r;
  if (auto r = same(whole.field.slip_path(i), part.field.slip_path(j), "path"); !r) return r;
  const ContactFrame &a = whole.labels.frame(), &b = part.labels.frame();
  const auto u = static_cast<Eigen::Index>(i), v = static_cast<Eigen::Index>(j);
  if (auto r = same(a.margin[u], b.margin[v], "margin"); !r) return r;
  if (auto r = same(a.slip_distance[u], b.slip_distance[v], "slip distance"); !r) return r;
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (auto r = same(whole.field.tangential_force(i)[k], part.field.tangential_force(j)[k], "tangential force"); !r) return r;
    if (auto r = same(whole.field.stretch(i)[k], part.field.stretch(j)[k], "stretch"); !r) return r;
    if (auto r = same(whole.field.slip_step(i)[k], part.field.slip_step(j)[k], "slip"); !r) return r;
    if (whole.field.state(i) != ElementState::detached) {
      if (auto r = same(whole.field.contact_point(i)[k], part.field.contact_point(j)[k], "contact point"); !r) return r;
    }
    if (auto r = same(a.force(k, u), b.force(k, v), "force"); !r) return r;
    if (auto r = same(a.contact_force(k, u), b.contact_force(k, v), "force in the contact plane"); !r) return r;
    if (auto r = same(a.displacement(k, u), b.displacement(k, v), "displacement"); !r) return r;
    if (k < 2) {
      if (auto r = same(a.slip_velocity(k, u), b.slip_velocity(k, v), "slip velocity"); !r) return r;
    }
  }
  return ::testing::AssertionSuccess();
}

// The whole's state equals its parts' states, whichever were idle: a flag, then the numbers of each
// element column by column (Field::save_state).
::testing::AssertionResult same_state(Bench& whole, std::vector<std::unique_ptr<Bench>>& parts) {
  std::vector<double> all(whole.field.state_size()), own;
  whole.field.save_state(all);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    own.resize(parts[p]->field.state_size());
    parts[p]->field.save_state(own);
    const std::size_t size = parts[p]->field.size();
    constexpr std::size_t pose = 12;  // at the end, for grids
    for (std::size_t v = 0; v + 1 + pose < own.size(); ++v) {
      const std::size_t column = v / size, element = p * size + v % size;
      const std::string what = "column " + std::to_string(column) + " of element " + std::to_string(element);
      if (auto r = same(all[1 + column * whole.field.size() + element], own[1 + v], what.c_str()); !r) return r;
    }
  }
  return ::testing::AssertionSuccess();
}

TEST(SparseField, IsTheDenseOneElementByElement) {
  std::size_t touched = 0, slid = 0, events = 0, steps = 0;
  for (const Shape shape : {Shape::box, Shape::cylinder, Shape::sphere}) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      RandomStream draw(seed, 0, "sparse field");
      const Target met = target(shape);
      const Friction friction = random_friction(draw);
      const RandomMotion motion(draw, met.facing);
      Bench whole(part_of_pad(0, rows), met.surface, friction);
      ASSERT_TRUE(whole.field.sparse());
      std::vector<std::unique_ptr<Bench>> parts;
      for (std::size_t r = 0; r < rows; r += rows_a_part) {
        parts.push_back(std::make_unique<Bench>(part_of_pad(r, rows_a_part), met.surface, friction));
        ASSERT_FALSE(parts.back()->field.sparse());
      }
      std::vector<double> state(whole.field.state_size());
      for (int tick = 0; tick < 300; ++tick) {
        const double time = tick * 1e-3;
        if (tick % 35 == 34) {
          ASSERT_TRUE(same_state(whole, parts)) << "tick " << tick;
        }
        if (tick % 70 == 69) {  // its state, in a field with another past
          whole.field.save_state(state);
          for (int k = 0; k < 3; ++k) whole.field.step(met.facing, 1e-3);
          whole.field.load_state(state);
        }
        whole.step(motion.at(time), time, tick % 3 != 0);
        std::size_t happened = 0;
        for (std::size_t p = 0; p < parts.size(); ++p) {
          parts[p]->step(motion.at(time), time);
          for (std::size_t j = 0; j < parts[p]->field.size(); ++j) {
            const std::size_t i = p * rows_a_part * columns + j;
            ASSERT_TRUE(same_element(whole, i, *parts[p], j))
                << "shape " << static_cast<int>(shape) << ", seed " << seed << ", tick " << tick << ", element " << i;
            slid += whole.field.state(i) == ElementState::slip ? 1 : 0;
          }
          for (const ContactEvent& event : parts[p]->labels.frame().events) {
            const std::vector<ContactEvent>& all = whole.labels.frame().events;
            EXPECT_TRUE(std::ranges::any_of(all,
                                            [&](const ContactEvent& other) {
                                              return other.time == event.time && other.kind == event.kind &&
                                                     other.unit == event.unit + p * rows_a_part * columns;
                                            }))
                << "event of unit " << event.unit;
            ++happened;
          }
        }
        EXPECT_EQ(whole.labels.frame().events.size(), happened);
        events += happened;
        touched += whole.field.touching();
        ++steps;
      }
    }
  }
  EXPECT_LT(touched, steps * rows * columns / 2) << "the test is of fields of which few touch";
  EXPECT_GT(touched, steps * 10);
  EXPECT_GT(slid, 10000u);
  EXPECT_GT(events, 1000u);
}

// A pad that was far away for long comes down in one step, at a speed and by a distance it never
// had before: it touches as if it had been computed all the time.
TEST(SparseField, WakesInTimeHoweverItComes) {
  for (const Shape shape : {Shape::box, Shape::cylinder, Shape::sphere}) {
    const Target met = target(shape);
    Bench whole(part_of_pad(0, rows), met.surface, {0.5, 0.4});
    std::vector<std::unique_ptr<Bench>> parts;
    for (std::size_t r = 0; r < rows; r += rows_a_part) {
      parts.push_back(std::make_unique<Bench>(part_of_pad(r, rows_a_part), met.surface, Friction{0.5, 0.4}));
    }
    RandomStream draw(11, 0, "far away");
    double time = 0.0;
    std::size_t events = 0;
    const auto step = [&](const Pose& pose) {
      whole.step(pose, time);
      std::size_t own = 0;
      for (std::size_t p = 0; p < parts.size(); ++p) {
        parts[p]->step(pose, time);
        own += parts[p]->labels.frame().events.size();
        for (std::size_t j = 0; j < parts[p]->field.size(); ++j) {
          ASSERT_TRUE(same_element(whole, p * rows_a_part * columns + j, *parts[p], j)) << "time " << time << " element " << j;
        }
      }
      EXPECT_EQ(whole.labels.frame().events.size(), own);
      events += own;
      time += 1e-3;
    };
    for (int flight = 0; flight < 6; ++flight) {
      const double height = draw.uniform(1e-3, 30e-3);
      for (int tick = 0; tick < 40; ++tick) {
        const double turn = tick < 30 ? 0.0 : 0.02 * (tick - 29);
        Pose away = met.facing * at(1e-4 * tick, 0.0, height);
        away.rotation = away.rotation * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitX());
        step(away);
      }
      for (int tick = 0; tick < 5; ++tick) step(met.facing * at(draw.uniform(-1e-3, 1e-3), 0.0, -draw.uniform(0.2e-3, 1e-3)));
    }
    EXPECT_GT(events, 300U);
    ASSERT_TRUE(same_state(whole, parts));
  }
}

// Every unit of a lifted pad reads 0 and touches nothing, however often the pad is drawn and other
// labels are read between the steps.
TEST(SparseField, LooksChangeNoLabel) {
  const Target met = target(Shape::cylinder);
  for (const int looks : {0, 1, 2}) {
    Bench simulation(part_of_pad(0, rows), met.surface, {0.5, 0.4});
    ContactLabels others(part_of_pad(0, rows));
    const auto step = [&](double height, double time) {
      simulation.field.step(met.facing * at(0.0, 0.0, height), 1e-3);
      for (int look = 0; look < looks; ++look) {
        simulation.field.view_from_pad();
        others.judge({&simulation.field, 1}, time, 1e-3);
        others.fill({&simulation.field, 1}, FramePart::felt);
      }
      simulation.labels.update({&simulation.field, 1}, time, 1e-3);
    };
    for (int tick = 0; tick < 5; ++tick) step(-1e-3, 1e-3 * tick);
    const ContactFrame& frame = simulation.labels.frame();
    ASSERT_GT(simulation.field.touching(), 0U);
    // The deepest element, in the middle of its column, is 1 mm deep within its height in the
    // surface: k_n d, with k_n at least 100 N/m.
    ASSERT_GT(frame.force.row(2).maxCoeff(), 100.0 * 0.9e-3);
    for (int tick = 5; tick < 8; ++tick) {
      step(12e-3, 1e-3 * tick);
      EXPECT_EQ(simulation.field.touching(), 0U);
      EXPECT_EQ(frame.force.abs().maxCoeff(), 0.0) << looks << " looks, tick " << tick;
      EXPECT_EQ(frame.contact_force.abs().maxCoeff(), 0.0) << looks << " looks, tick " << tick;
      EXPECT_EQ(frame.displacement.abs().maxCoeff(), 0.0) << looks << " looks, tick " << tick;
      EXPECT_TRUE(frame.margin.isNaN().all()) << looks << " looks, tick " << tick;
    }
  }
}

// The labels of a pad that touches nothing are zeros whose signs depend on its pose alone, not on
// when its sleeping elements were last computed: saving the state computes them all.
TEST(SparseField, SavingTheStateChangesNoLabelOfALiftedPad) {
  PadLayout pad = part_of_pad(0, rows);
  pad.units.clear();
  for (std::size_t r = 0; r < rows; ++r) pad.units.push_back({r * columns, columns});
  const Target met = target(Shape::sphere);
  Bench saved(pad, met.surface, {0.5, 0.4}), other(pad, met.surface, {0.5, 0.4});
  std::vector<double> state(saved.field.state_size());
  std::size_t negative = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    // Round the sphere and round itself, 65 mm from its surface, by less than 2 mm a tick.
    const auto turned = [tick](double x, double y) {
      return Eigen::Matrix3d(Eigen::AngleAxisd(x * tick, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(y * tick, Eigen::Vector3d::UnitY()));
    };
    const Pose pose{turned(0.010, 0.017), turned(0.009, 0.004).col(2) * 80e-3};
    saved.field.step(pose, 1e-3);
    saved.field.save_state(state);
    saved.labels.update({&saved.field, 1}, 1e-3 * tick, 1e-3);
    other.step(pose, 1e-3 * tick);
    ASSERT_EQ(other.field.touching(), 0U);
    const Eigen::Array3Xd &a = saved.labels.frame().contact_force, &b = other.labels.frame().contact_force;
    for (Eigen::Index v = 0; v < b.size(); ++v) {
      ASSERT_EQ(std::signbit(a.data()[v]), std::signbit(b.data()[v])) << "tick " << tick << ", value " << v;
      negative += std::signbit(b.data()[v]) ? 1 : 0;
    }
  }
  EXPECT_GT(negative, 0U);
}

// A stage's vibration presses every unit alike, differently in each step.
TEST(SparseField, IsShakenAnewInEveryStep) {
  const Target met = target(Shape::cylinder);
  Bench simulation(part_of_pad(0, rows), met.surface, {0.5, 0.4}), still(part_of_pad(0, rows), met.surface, {0.5, 0.4});
  const ContactFrame& frame = simulation.labels.frame();
  for (int tick = 0; tick < 5; ++tick) {
    const double shaking = tick < 3 ? 0.125 * (tick + 1) : 0.0;
    simulation.labels.ride({0.0, 0.0, 0.0}, shaking);
    for (Bench* bench : {&simulation, &still}) bench->step(met.facing * at(0.0, 0.0, -1e-3), 1e-3 * tick);
    EXPECT_EQ(frame.force(2, 0), shaking) << "N, a corner touches nothing";
    EXPECT_TRUE((frame.force.row(2) == still.labels.frame().force.row(2) + shaking).all());
  }
}

// Forces and energies are sums over the participating groups, in the order of all groups.
TEST(SparseField, SumsWhatTakesPart) {
  const Target met = target(Shape::cylinder);
  RandomStream draw(2, 0, "sparse sums");
  const RandomMotion motion(draw, met.facing);
  Field field(part_of_pad(0, rows), met.surface, {0.5, 0.4});
  for (int tick = 0; tick < 200; ++tick) {
    field.step(motion.at(tick * 1e-3), 1e-3);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < field.size(); ++i) force += field.normal(i) * field.normal_force(i) - field.tangential_force(i);
    const double rounding = 1e-13 * (1.0 + force.norm());
    EXPECT_NEAR((field.spring_sums().force_on_pad - force).norm(), 0.0, rounding) << tick;
    EXPECT_NEAR((field.damped_wrench_on_pad({{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}, 1e-3).force - force).norm(), 0.0, rounding)
        << tick;
  }
}

}  // namespace
}  // namespace slipbench::testing_field::sparse_test
