// The nib pad's geometry, its capacitances by closed form, and the selectivity of its clusters.
#include <array>
#include <set>

#include "sensors/nib_pad/nib_pad.h"
#include "tests/expect.h"
#include "tests/sensors/nib_pad/rig.h"

namespace slipbench::nib_pad_test {
namespace {

TEST(NibPad, NibsStandInRowsFromNorthToSouth) {
  const auto sensor = make({{"height_sd", 0.0}});
  const PadLayout& layout = sensor->layout();
  ASSERT_EQ(layout.elements.size(), 36U);
  const std::array<std::array<double, 3>, 5> corners{
      {{0, -9.5, 9.5}, {5, 9.5, 9.5}, {14, -1.9, 1.9}, {30, -9.5, -9.5}, {35, 9.5, -9.5}}};  // unit, mm: 2.5 times 3.8 mm
  for (const auto& [unit, x, y] : corners) {
    const Element& element = layout.elements[static_cast<std::size_t>(unit)];
    EXPECT_NEAR(element.tip.x(), 1e-3 * x, 1e-18) << unit;
    EXPECT_NEAR(element.tip.y(), 1e-3 * y, 1e-18) << unit;
    EXPECT_EQ(element.tip.z(), 0.0);
  }
  for (std::size_t n = 0; n < 36; ++n) {
    EXPECT_EQ(layout.units[n].first, n);
    EXPECT_EQ(layout.units[n].count, 1U);
    EXPECT_EQ(layout.elements[n].k_normal, 830.0);
    EXPECT_EQ(layout.elements[n].k_tangential, 200.0);
  }
}

// 200 devices of 36 nibs: the sd has a relative standard error of 1/sqrt(2*7200) = 0.83 %, the mean
// one of sd/85; five of each are allowed.
TEST(NibPad, HeightsScatterByDevice) {
  double sum = 0.0, squares = 0.0;
  for (std::uint64_t device = 0; device < 200; ++device) {
    const auto sensor = make({{"height_sd", 0.1e-3}, {"device", std::string("redrawn")}}, device);
    for (const Element& element : sensor->layout().elements) {
      sum += element.tip.z() / 0.1e-3;
      squares += element.tip.z() * element.tip.z() / 1e-8;
    }
  }
  EXPECT_NEAR(sum / 7200.0, 0.0, 5.0 / 85.0);
  EXPECT_NEAR(std::sqrt(squares / 7200.0), 1.0, 5.0 * 0.0083);
  EXPECT_EQ(make({}, 1)->layout().elements[3].tip, make({}, 2)->layout().elements[3].tip) << "one device for all trials";
}

TEST(NibPad, DescribesItsChannels) {
  const auto sensor = make();
  EXPECT_EQ(sensor->rate(), 300.0);
  const auto& channels = sensor->channels();
  ASSERT_EQ(channels.size(), 3U);
  EXPECT_EQ(channels[0].name, "si");
  EXPECT_THAT(channels[0].shape, ElementsAre(9, 4));
  EXPECT_EQ(channels[1].name, "fl");
  EXPECT_EQ(channels[2].name, "fr");
  for (const Channel& channel : channels) {
    EXPECT_EQ(channel.unit, "counts");
    EXPECT_EQ(channel.channel_names.size(), channel.size());
  }
  EXPECT_EQ(channels[0].channel_names[9], "T2_N");
}

TEST(NibPad, UnloadedReadingIsAtEightyFivePercentOfFullScale) {
  // 0.85 * 8191 = 6962.35; at 12 bit 0.85 * 4095 = 3480.75.
  for (const float value : image(*make(), contact())) EXPECT_EQ(value, 6962.0F);
  for (const float value : image(*make({{"bits", std::int64_t{12}}}), contact())) EXPECT_EQ(value, 3481.0F);
}

// 0.4 N on every nib closes every gap by 0.4/10.4 mm.
TEST(NibPad, UniformPressureOfOneForceReadsAsThePlateCapacitorSays) {
  const double change = risen(0.4 / 10.4);  // of one nib's electrode, 8.0 fF
  const auto values = image(*make(at_once()), contact(0.4));
  for (std::size_t v = 0; v < 36; ++v) EXPECT_EQ(values[v], counts(850.0, 4.0 * change)) << v;
  for (const std::size_t v : {fl, fl + 1}) EXPECT_EQ(values[v], counts(300.0, 36.0 * change));
  for (const std::size_t v : {fr, fr + 1}) EXPECT_EQ(values[v], counts(300.0, 48.0 * change));  // 12 electrodes of 4 nibs
  // A converter with one bit less has counts of twice the size.
  EXPECT_EQ(image(*make(at_once_and("bits", std::int64_t{12})), contact(0.4))[0],
            std::round(0.85 * 4095.0 + 0.5 * 850.0 * 4.0 * change));
}

// A tip 0.2 mm to the east tilts the fabric by 0.2/3.65: at 1.1 mm the gap is 60.3 um narrower in
// the east, and wider by as much in the west.
TEST(NibPad, ShearNarrowsTheGapOnTheSideLeanedTo) {
  const double closed = 1.1 * 0.2 / 3.65;
  const std::array<std::array<double, 2>, 4> ways{{{-1, 0}, {0, 1}, {1, 0}, {0, -1}}};  // W, N, E, S
  for (std::size_t to = 0; to < 4; ++to) {
    const auto values = image(*make(at_once()), contact(0.0, 0.2e-3 * ways[to][0], 0.2e-3 * ways[to][1]));
    for (std::size_t taxel = 0; taxel < 9; ++taxel) {
      EXPECT_EQ(values[si(taxel, to)], counts(850.0, 4.0 * risen(closed)));
      EXPECT_EQ(values[si(taxel, (to + 2) % 4)], counts(850.0, 4.0 * risen(-closed)));
      EXPECT_EQ(values[si(taxel, (to + 1) % 4)], counts(850.0, 0.0));
      EXPECT_EQ(values[si(taxel, (to + 3) % 4)], counts(850.0, 0.0));
    }
  }
}

// 1/gap is convex: a force on one nib of a taxel reads more than the same force shared by its four.
// This makes a calibration under uniform loads wrong under partial ones; with a linear capacitor
// there is no difference.
TEST(NibPad, UnequalNibsReadMoreThanTheirMean) {
  ContactFrame shared = contact(), uneven = contact();
  for (const std::size_t nib : {0U, 1U, 6U, 7U}) shared.force(2, nib) = 0.4;  // taxel 0
  uneven.force(2, 7) = 1.6;
  const auto sensor = make(at_once());
  const double mean = image(*sensor, shared)[0], one = image(*sensor, uneven)[0];
  EXPECT_EQ(mean, counts(850.0, 4.0 * risen(0.4 / 10.4)));
  EXPECT_EQ(one, counts(850.0, risen(1.6 / 10.4)));
  EXPECT_GT((one - 6962.0) / (mean - 6962.0), 2.0);  // 58.8 over 27.3 counts: about (1 - 0.04/0.254)/(1 - 0.16/0.254)

  const auto linear = make(at_once_and("capacitor", std::string("linear")));
  EXPECT_EQ(image(*linear, shared)[0], image(*linear, uneven)[0]);
  EXPECT_EQ(image(*linear, shared)[0], counts(850.0, 4.0 * 0.045 * (0.4 / 10.4) / 0.254));
}

// The fabric's rim, 1.4 mm from the nib's axis, touches the mask after 0.224 mm: a tilt of 0.16,
// 0.584 mm at the tip. Further lean happens above the fabric. The same holds in any direction.
TEST(NibPad, FabricRestsOnTheMask) {
  const auto sensor = make(at_once());
  const double landed = 1.1 * 0.224 / 1.4;
  for (const double q : {0.6e-3, 1e-3, 3e-3}) {
    EXPECT_EQ(image(*sensor, contact(0.0, q, 0.0))[si(4, east_side)], counts(850.0, 4.0 * risen(landed)));
    const double part = landed / std::sqrt(2.0);
    const auto diagonal = image(*sensor, contact(0.0, q, -q));
    EXPECT_EQ(diagonal[si(4, east_side)], counts(850.0, 4.0 * risen(part)));
    EXPECT_EQ(diagonal[si(4, south)], counts(850.0, 4.0 * risen(part)));
    EXPECT_EQ(diagonal[si(4, west)], counts(850.0, 4.0 * risen(-part)));
  }
  EXPECT_LT(image(*sensor, contact(0.0, 0.58e-3, 0.0))[si(4, east_side)], counts(850.0, 4.0 * risen(landed)));
  // Pressed flat, at 10.4 N/mm times 0.224 mm = 2.33 N, the fabric no longer tilts, and four nibs
  // read 1,142 counts above the unloaded reading: less than the 1,229 left to full scale.
  const double flat = counts(850.0, 4.0 * risen(0.224));
  EXPECT_LT(flat, 8191.0);
  for (const double q : {0.0, 0.4e-3}) {
    const auto pressed = image(*sensor, contact(3.0, q, 0.0));
    for (std::size_t v = 0; v < 36; ++v) EXPECT_EQ(pressed[v], flat);
  }
}

// Reading of the north cluster when all nibs lean north until the fabric's rim touches, under a
// total of `grip` [N].
double pulled_north(double grip) {
  const double u = grip / 36.0 / 10.4;
  return counts(300.0, 36.0 * risen(u + 1.1 * (0.224 - u) / 1.4));
}

TEST(NibPad, ClusterStaysBelowFullScaleUpToEightNewtonAndReadsFullScaleBeyond) {
  const auto sensor = make(at_once());
  EXPECT_LT(pulled_north(8.0), 8191.0);
  EXPECT_EQ(image(*sensor, contact(8.0 / 36.0, 0.0, 1e-3))[fl], pulled_north(8.0));
  EXPECT_EQ(sensor->saturated(), 0u);
  EXPECT_GT(pulled_north(15.0), 8191.0);
  EXPECT_EQ(image(*sensor, contact(15.0 / 36.0, 0.0, 1e-3))[fl], 8191.0F);
  EXPECT_EQ(sensor->saturated(), 9u) << "each sample of an image";
}

TEST(NibPad, RotationClustersAreTwelveTangentialElectrodesEach) {
  using namespace nib_pad;
  std::set<std::pair<std::size_t, std::size_t>> ahead, behind;
  for (const Electrode& e : electrodes_of(fr_first)) ahead.emplace(taxel_of(e.nib), static_cast<std::size_t>(e.side));
  for (const Electrode& e : electrodes_of(fr_first + 1)) behind.emplace(taxel_of(e.nib), static_cast<std::size_t>(e.side));
  // Taxels 0 1 2 / 3 4 5 / 6 7 8 from the north-west: a counter-clockwise turn moves nibs west in
  // the north, south in the west, ...
  using enum Side;
  const std::set<std::pair<std::size_t, std::size_t>> expected{{0, west},       {0, south},     {1, west},       {2, west},
                                                               {2, north_side}, {3, south},     {5, north_side}, {6, south},
                                                               {6, east_side},  {7, east_side}, {8, east_side},  {8, north_side}};
  EXPECT_EQ(ahead, expected);
  std::set<std::pair<std::size_t, std::size_t>> opposite;
  for (const auto& [taxel, side] : expected) opposite.emplace(taxel, (side + 2) % 4);
  EXPECT_EQ(behind, opposite);
  EXPECT_EQ(electrodes_of(fr_first).size(), 48U);
  EXPECT_EQ(electrodes_of(fl_first).size(), 36U);
}

// All nibs under 0.2 N each, dragged by a plate that turns by `angle` counter-clockwise about the
// pad's middle.
ContactFrame turned(double angle) {
  ContactFrame frame = contact(0.2);
  for (std::size_t n = 0; n < 36; ++n) {
    const auto nib = static_cast<Eigen::Index>(n);
    frame.displacement(0, nib) = -angle * north(n);
    frame.displacement(1, nib) = angle * east(n);
  }
  return frame;
}

// By the square's symmetry fr + is four times the east taxel's N and the north-east taxel's N and W
// electrodes: nibs at 5.7 and 9.5 mm to the east, where a turn closes the gap by r angle x/L; at
// the corner's W electrode it closes by r angle y/L.
TEST(NibPad, RotationShowsInFrAndNotInFl) {
  const double angle = 0.02, u = 0.2 / 10.4;
  const auto rises = [&](double arm) { return risen(u + 1.1 * angle * arm / 3.65); };
  for (const double sign : {1.0, -1.0}) {
    double ahead = 0.0, behind = 0.0;
    for (const double arm : {5.7, 9.5}) {  // two nibs each: edge N, corner N, corner W
      ahead += 4.0 * 3.0 * 2.0 * rises(arm);
      behind += 4.0 * 3.0 * 2.0 * rises(-arm);
    }
    const auto values = image(*make(at_once()), turned(sign * angle));
    EXPECT_EQ(values[sign > 0.0 ? fr : fr + 1], counts(300.0, ahead));
    EXPECT_EQ(values[sign > 0.0 ? fr + 1 : fr], counts(300.0, behind));
    EXPECT_EQ(values[fl], values[fl + 1]);
    EXPECT_GT(ahead - behind, 0.1);  // pF
  }
}

TEST(NibPad, TranslationShowsInFlAlongItAndNotInFr) {
  const double closed = 1.1 * 0.1 / 3.65, u = 0.2 / 10.4;
  const auto sensor = make(at_once());
  const auto northwards = image(*sensor, contact(0.2, 0.0, 0.1e-3)), eastwards = image(*sensor, contact(0.2, 0.1e-3, 0.0));
  EXPECT_EQ(northwards[fl], counts(300.0, 36.0 * risen(u + closed)));
  EXPECT_EQ(northwards[fl + 1], counts(300.0, 36.0 * risen(u - closed)));
  EXPECT_EQ(northwards[fr], northwards[fr + 1]);
  EXPECT_EQ(eastwards[fl], eastwards[fl + 1]);
  EXPECT_EQ(eastwards[fr], eastwards[fr + 1]);
}

// Figure 6 of the paper: a hex wrench of 31 g, here along one row of nibs, 50.7 mN each. Eight of a
// taxel's 16 gaps narrow by 4.9 um: its sum rises by 6.0 counts, while the noise of a sum of four
// after a mean of five is 1.5 sqrt(4/5) = 1.3 counts.
TEST(NibPad, FeelsAHexWrench) {
  const double load = 0.031 * 9.81 / 6.0;
  ContactFrame wrench = contact();
  for (Eigen::Index nib = 12; nib < 18; ++nib) wrench.force(2, nib) = load;
  const auto values = image(*make(at_once_and("bits", std::int64_t{16})), wrench);
  const double risen_counts = 2.0 * 4.0 * 850.0 * risen(load / 10.4);
  EXPECT_GT(risen_counts, 4.0 * 1.5 * std::sqrt(4.0 / 5.0));
  for (std::size_t taxel = 0; taxel < 9; ++taxel) {
    double sum = 0.0;  // of 13-bit counts, each rounded to an eighth
    for (std::size_t side = 0; side < 4; ++side) sum += (values[si(taxel, side)] - 0.85 * 65535.0) / 8.0;
    EXPECT_NEAR(sum, taxel / 3 == 1 ? risen_counts : 0.0, 4.0 * 0.5 / 8.0) << taxel;
  }
}

TEST(NibPad, MaskNeedsRoomBelowTheFabric) {
  EXPECT_THAT(refusal_of([&] {
                make({{"mask_gap", 0.3e-3}});
              }),
              AllOf(HasSubstr("sensors.pad.mask_gap"), HasSubstr("0.3 mm"), HasSubstr("0.254 mm")));
}

// The paper's criterion: the pull has moved the object by 2 mm, including the nib's lean.
TEST(PaperLabel, CountsNibsOverWhichTheObjectHasMovedTwoMillimetres) {
  const auto sensor = make();
  ContactFrame truth = contact();
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::no_contact);
  truth.unit_state[3] = truth.unit_state[8] = UnitState::slip;
  truth.slip_distance[3] = 1.59e-3;
  truth.displacement.col(3) << 0.3e-3, 0.4e-3, 0.0;  // 0.5 mm
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::incipient) << "1.59 + 0.5 mm, and of the other nothing";
  truth.slip_distance[3] = 1.49e-3;
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::non_slip);
  truth.slip_distance[3] = truth.slip_distance[8] = 2.1e-3;
  EXPECT_EQ(sensor->paper_label(truth, false), PadState::gross);
}

}  // namespace
}  // namespace slipbench::nib_pad_test
