// The magnetic skin against closed-form fields of dipoles.
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/sensor.h"
#include "sim/api/sensor_kind.h"
#include "tests/expect.h"

namespace slipbench {

SensorKind magnetic_skin_sensor();

namespace {

using Eigen::Vector3d;
using Given = std::map<std::string, double>;
using Texts = std::map<std::string, std::string>;
using Rows = Eigen::MatrixX3d;

// A skin without noise and offset unless `given` sets them.
class Skin {
 public:
  explicit Skin(Given given, const std::string& chips = "cross", std::uint64_t trial = 1, const std::string& name = "pad",
                const Texts& texts = {}) {
    given.insert({"noise", 0});
    given.insert({"offset", 0});
    for (const auto& [key, value] : given) parameters_.set(key, value);
    parameters_.set("chips", chips);
    for (const auto& [key, value] : texts) parameters_.set(key, value);
    sensor_ = magnetic_skin_sensor().create(parameters_, {}, 7, trial, name);
  }

  [[nodiscard]] double parameter(const std::string& key) const { return parameters_.number(key); }
  [[nodiscard]] Vector3d magnet(int cell) const {
    return sensor_->layout().elements[static_cast<std::size_t>(cell)].tip + Vector3d(0, 0, parameter("magnet_depth"));
  }
  // Distance from an unloaded magnet to its magnetometer; factor on the surface's displacement at
  // the magnet.
  [[nodiscard]] double height() const { return parameter("thickness") + parameter("gap") - parameter("magnet_depth"); }
  [[nodiscard]] double share() const { return 1 - parameter("magnet_depth") / parameter("thickness"); }
  // uT m^3: mu0 m/(4 pi) with m = Br V/mu0, for a disc.
  [[nodiscard]] double strength() const {
    return 1e6 * parameter("remanence") * std::pow(parameter("magnet_diameter") / 4, 2) * parameter("magnet_thickness");
  }

  // Returns channel `channel` (0 field, 1 counts, 2 force) with the surface of each cell displaced
  // by `moved`; +Z goes into the pad.
  Rows read(std::size_t channel, const Rows& moved, double time = 0) {
    ContactFrame truth;
    truth.time = time;
    truth.element_depth = moved.col(2);
    truth.element_shear = moved;
    truth.element_shear.col(2) = 0;
    const std::size_t count = sensor_->channels()[channel].shape[0];
    const float* values = sensor_->measure(truth).values.data() + 3 * count * channel;
    return Eigen::Map<const Eigen::Matrix3Xf>(values, 3, static_cast<Eigen::Index>(count)).transpose().cast<double>();
  }
  // Readings are within half a count per axis of `expected` [uT], which includes the field without
  // load.
  void expect_total(const Vector3d& counts, const Vector3d& expected) const {
    const Vector3d count{parameter("sensitivity"), parameter("sensitivity"), parameter("sensitivity_z")};
    EXPECT_LT((counts - expected.cwiseQuotient(count)).cwiseAbs().maxCoeff(), 0.501) << counts.transpose();
  }

 private:
  Parameters parameters_ = defaults_of(magnetic_skin_sensor().about.parameters);
  std::unique_ptr<Sensor> sensor_;
};

Given one(Given more = {}) {
  more.insert({{"rows", 1}, {"columns", 1}});
  return more;
}
Rows moved(double x, double y, double z) { return Eigen::RowVector3d(x, y, z); }
const Rows still = moved(0, 0, 0);

// On the axis of m a dipole's field is 2 mu0 m/(4 pi h^3), on its equator -mu0 m/(4 pi d^3), both
// along m. So d(2/h^3)/dh = -6/h^4; a magnet that moves sideways by e gives B_x = -3 e/h^4. The
// second order is 2 e/h = 0.6 %; a sideways move by rho gives B_z = -6 rho^2/h^5; half a count is
// 0.1 %.
TEST(MagneticSkin, DipoleOnAxisAndEquatorAndItsGradient) {
  Skin skin(one({{"sensitivity", 0.01}, {"sensitivity_z", 0.01}, {"remanence", 0.1}, {"chip_pitch", 4e-3}}));
  const double h = skin.height(), e = 12e-6, u = e / skin.share(), slope = e * skin.strength() / std::pow(h, 4);
  skin.expect_total(skin.read(1, still).row(0), {0, 0, 2 * skin.strength() / std::pow(h, 3)});
  // Pressed until the magnet is level with the magnetometers: those at the ends are on its equator.
  // It just misses the middle one.
  const Rows level = skin.read(1, moved(0, 1e-6, h / skin.share()));
  for (const int end : {1, 2}) skin.expect_total(level.row(end), {0, 0, -skin.strength() / std::pow(4e-3, 3)});
  const Rows beside = skin.read(0, moved(u, -2 * u, 0)) / slope, down = skin.read(0, moved(0, 0, u)) / slope;
  EXPECT_LT((beside.row(0) - Eigen::RowVector3d(-3, 6, -30 * e / h)).norm(), 0.06) << beside.row(0);
  EXPECT_LT((down.row(0) - Eigen::RowVector3d(0, 0, 6)).norm(), 0.06) << down.row(0);
}

// B = mu0/(4 pi) (3 r (m.r)/r^5 - m/r^3) as vectors, for 3 x 4 displaced magnets with alternating
// poles in squares of two cells.
TEST(MagneticSkin, SumOfMagnets) {
  Skin skin({{"rows", 3}, {"columns", 4}, {"pole_pitch", 9.4e-3}}, "grid");
  Rows displaced(12, 3);
  for (int k = 0; k < 12; ++k) displaced.row(k) = 1e-4 * Eigen::RowVector3d(std::sin(k), std::cos(2 * k), 3 + 0.25 * k);
  const Rows found = skin.read(1, displaced);
  ASSERT_EQ(found.rows(), 12);
  for (int j = 0; j < 12; ++j) {
    Vector3d field(0, 0, 0);
    for (int i = 0; i < 12; ++i) {
      const bool down = (skin.magnet(i).x() < 0) != (skin.magnet(i).y() < -1e-3);
      const Vector3d m(0, 0, down ? -skin.strength() : skin.strength());
      const Vector3d r =
          skin.magnet(j) + Vector3d(0, 0, skin.height()) - skin.magnet(i) - skin.share() * displaced.row(i).transpose();
      field += 3 * r * m.dot(r) / std::pow(r.norm(), 5) - m / std::pow(r.norm(), 3);
    }
    skin.expect_total(found.row(j), field);
  }
}

// A lone magnet's position follows from its field at any displacement: forces equal the springs'
// within half a count of up to 1 uT. Without load B_x changes by 3 K/h^4 per metre, at a distance
// by less: twice that is allowed.
TEST(MagneticSkin, ForceOfALoneMagnet) {
  Skin skin(one(), "grid");
  const double metre = skin.strength() / std::pow(skin.height(), 4) * skin.share();
  const Eigen::RowVector3d k{skin.parameter("k_tangential"), skin.parameter("k_tangential"), skin.parameter("k_normal")};
  for (const Rows& u : {still, moved(0, 0, 1e-3), moved(8e-4, -3e-4, 6e-4), moved(-1e-3, 0, 2e-4)}) {
    const Rows found = skin.read(2, u).cwiseQuotient(k);
    EXPECT_LT((found - u).cwiseAbs().maxCoeff(), 1 / (3 * metre)) << u;
  }
}

TEST(MagneticSkin, CountsSaturateScatterAndDrift) {
  Skin strong(one({{"magnet_diameter", 4e-3}, {"magnet_thickness", 4e-3}}));  // 175 mT on the axis; the converter ends at 32 mT
  EXPECT_EQ(strong.read(1, still)(0, 2), 32767);
  EXPECT_EQ(strong.read(0, still)(0, 2), 0);  // saturated, so no change is seen

  // 6,000 values: the relative sd of their sd is 1 %. Rounding adds 1/12.
  const Given loud = one({{"noise", 7}});
  Skin noisy(loud), again(loud), other(loud, "cross", 2), named(loud, "cross", 1, "left");
  const Rows quiet = Skin(one()).read(1, still);
  double square = 0;
  for (int sample = 0; sample < 400; ++sample) {
    const Rows counts = noisy.read(1, still);
    EXPECT_EQ(counts, again.read(1, still));
    EXPECT_NE(counts, other.read(1, still));
    EXPECT_NE(counts, named.read(1, still));
    square += (counts - quiet).squaredNorm() / 6000;
  }
  EXPECT_NEAR(std::sqrt(square), std::sqrt(49 + 1.0 / 12), 0.04 * 7);

  // 10 K warmer in the end, all but 1/e of it after one time constant; each K reduces the field by
  // 0.11 %.
  Skin warm(one({{"warming", 10}, {"warming_time", 60}}));
  const double cold = warm.read(1, still)(0, 2);
  EXPECT_NEAR(warm.read(1, still, 60)(0, 2), cold * (1 - 0.011 * (1 - 1 / std::numbers::e)), 1);
  EXPECT_NEAR(warm.read(1, still, 6e4)(0, 2), cold * (1 - 0.011), 1);
}

// A lone dipole at (ex, ey) beside its magnetometer, h below: B_x = 3 s h (-ex)/r^5, B_z = s (3
// h^2/r^5 - 1/r^3), r^2 = h^2 + ex^2 + ey^2. The unloaded readings give ex and ey; under load the
// law with these values must give the readings. Magnets 100 mm apart are independent: at that
// distance a dipole has s/d^3 = 0.1 uT, compared with 3,500. Half a count is 0.3 uT and 3 s/h^4 =
// 1.3 uT/um: ex is known to 0.3 um.
TEST(MagneticSkin, MisplacedMagnetShowsLoadAsShear) {
  const Given given{{"rows", 20}, {"columns", 20}, {"pitch", 0.1}, {"placement", 0.2e-3}};
  Skin skin(given, "grid");
  const Rows rest = skin.read(1, Rows::Zero(400, 3));
  Rows pressed = Rows::Zero(400, 3);
  pressed.col(2).setConstant(0.5e-3);
  const Rows loaded = skin.read(1, pressed);
  const double s = skin.strength(), cx = skin.parameter("sensitivity"), cz = skin.parameter("sensitivity_z");
  double squares = 0.0, sum = 0.0;
  for (int i = 0; i < 400; ++i) {
    double ex = 0.0, ey = 0.0;
    const auto field = [&](double h) -> Vector3d {
      const double r2 = h * h + ex * ex + ey * ey, r3 = r2 * std::sqrt(r2), r5 = r2 * r3;
      return {-3 * s * h * ex / r5 / cx, -3 * s * h * ey / r5 / cx, s * (3 * h * h / r5 - 1 / r3) / cz};
    };
    for (int k = 0; k < 20; ++k) {  // B_x is nearly -3 s ex/h^4: each iteration leaves some 3 (e/h)^2 of the error
      const Vector3d now = field(skin.height());
      const double slope = 3 * s / std::pow(skin.height(), 4) / cx;
      ex += (now.x() - rest(i, 0)) / slope;
      ey += (now.y() - rest(i, 1)) / slope;
    }
    // h^-4 grows by (4/3.625)^4 = 1.48: half a count without load is 0.74 counts under load, plus
    // half a count there, 1.3 across in total. Along Z: half a count; all neighbours of the grid,
    // 9.0 s/d^3 = 1.1 counts; and 0.3 um of 0.6 mm in 6 s e^2/h^5, 0.2 counts.
    const Vector3d under_load = field(skin.height() - skin.share() * 0.5e-3);
    EXPECT_LT((under_load - loaded.row(i).transpose()).cwiseAbs().maxCoeff(), 1.8) << i;
    sum += ex + ey;
    squares += ex * ex + ey * ey;
  }
  // 800 draws: the sd of their sd is 0.2 mm/sqrt(1600) = 5 um, of their mean 7 um.
  EXPECT_NEAR(std::sqrt(squares / 800.0), 0.2e-3, 4 * 5e-6);
  EXPECT_NEAR(sum / 800.0, 0.0, 4 * 7e-6);

  Skin again(given, "grid", 2), other(given, "grid", 2, "pad", {{"device", "redrawn"}}), named(given, "grid", 1, "left");
  EXPECT_EQ(again.read(1, Rows::Zero(400, 3)), rest);
  EXPECT_NE(other.read(1, Rows::Zero(400, 3)), rest);
  EXPECT_NE(named.read(1, Rows::Zero(400, 3)), rest);
}

// 2,000 values along Z, 4,000 across: the relative sds of their sds are 1.6 and 1.1 %. Rounding
// adds 1/12.
TEST(MagneticSkin, NoiseByAxis) {
  const Rows quiet = Skin(one({{"placement", 0.2e-3}})).read(1, still);
  Skin skin(one({{"noise", 2.2}, {"noise_ratio", 2.2}, {"placement", 0.2e-3}}));
  double across = 0, along = 0;
  for (int sample = 0; sample < 400; ++sample) {
    const Rows from_rest = skin.read(1, still) - quiet;
    across += from_rest.leftCols(2).squaredNorm() / 4000;
    along += from_rest.col(2).squaredNorm() / 2000;
  }
  // `quiet` is rounded as well.
  EXPECT_NEAR(std::sqrt(across), std::sqrt(2.2 * 2.2 + 1.0 / 6), 0.05 * 2.2);
  EXPECT_NEAR(std::sqrt(along), std::sqrt(4.84 * 4.84 + 1.0 / 6), 0.07 * 4.84);
}

// New values at 10 Hz, read each ms for 100 s: some 1,000 times of sd 20 ms between new values. Their mean is
// known to 20/sqrt(1000) = 0.6 ms, their sd to 20/sqrt(2000) = 0.45 ms; a reading to the ms adds
// 1/sqrt(6) ms to the sd, which 20 ms hide. Four times that is allowed.
TEST(MagneticSkin, RepeatsItsValuesUntilTheNextRefresh) {
  Skin skin(one({{"noise", 2.2}, {"refresh", 10}})), regular(one({{"noise", 2.2}, {"refresh", 10}, {"refresh_jitter", 0}})),
      named(one({{"noise", 2.2}, {"refresh", 10}}), "cross", 1, "left");
  std::vector<double> between;
  Rows last = skin.read(1, still, 0), last_regular = regular.read(1, still, 0);
  int since = 0, differs = 0;
  for (int ms = 1; ms < 100'000; ++ms) {
    const double time = 1e-3 * ms;
    const Rows now = skin.read(1, still, time), other = named.read(1, still, time);
    differs += now != other;
    if (now != last) {
      between.push_back(ms - since);
      since = ms;
      last = now;
    }
    if (ms > 1000) continue;
    const Rows now_regular = regular.read(1, still, time);
    EXPECT_EQ(now_regular != last_regular, ms % 100 == 0) << ms;
    last_regular = now_regular;
  }
  const Eigen::Map<const Eigen::ArrayXd> times(between.data(), static_cast<Eigen::Index>(between.size()));
  EXPECT_NEAR(times.mean(), 100, 4 * 0.6);
  EXPECT_NEAR(std::sqrt((times - times.mean()).square().mean()), 20, 4 * 0.45);
  EXPECT_GT(differs, 90'000);
}

// A simulation of MuJoCo that is reset to 0 s gets new values at once, and the next ones 0.1 s later.
TEST(MagneticSkin, RefreshesAfterAReset) {
  Skin skin(one({{"noise", 2.2}, {"refresh", 10}, {"refresh_jitter", 0}}));
  const Rows last = skin.read(1, still, 10.0), reset = skin.read(1, still, 0.0);
  EXPECT_NE(reset, last);
  EXPECT_EQ(skin.read(1, still, 0.09), reset);
  EXPECT_NE(skin.read(1, still, 0.1), reset);
}

TEST(MagneticSkin, RefusesWhatDoesNotGoTogether) {
  const auto refused = [](const Given& given) { return scene_refusal_of([&] { Skin{given}; }); };
  EXPECT_THAT(refused({{"rows", 1.5}}), mentions({"rows", "columns"}));
  EXPECT_THAT(refused({{"magnet_depth", 4e-3}}), mentions({"thickness"}));
}

}  // namespace
}  // namespace slipbench
