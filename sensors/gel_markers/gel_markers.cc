// A gel pad with markers on its skin and a camera behind it. Like a custom library it needs no
// other header than sensors/plugin_abi.h: slipbench_bundled_sensor builds it into the program, and
// `c++ -std=c++17 -shared -fPIC` makes a library of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "sensors/plugin_abi.h"
#ifdef SLIPBENCH_BUNDLED_TYPE  // in the program: bit-identical on every processor
#include "sim/core/math.h"
namespace math = slipbench::math;
#else
namespace math = std;
#endif

// The parameters, in the order of the declarations below.
enum Key : std::size_t {
  rate,
  columns,
  rows,
  pitch,
  dome,
  k_normal,
  k_tangential,
  marker_columns,
  marker_rows,
  marker_pitch,
  width,
  height,
  field,
  distance,
  exposure,
  noise,
  height_noise,
  dropout,
  map,
};
const slipbench_parameter slipbench_sensor_parameters[] = {
    SLIPBENCH_A_NUMBER("rate", 25.0, "Hz"),
    SLIPBENCH_A_NUMBER("columns", 20.0, ""),
    SLIPBENCH_A_NUMBER("rows", 16.0, ""),
    SLIPBENCH_A_NUMBER("pitch", 1e-3, "m"),
    SLIPBENCH_A_NUMBER("dome", 0.0, "m"),
    SLIPBENCH_A_NUMBER("k_normal", 106.0, "N/m"),
    SLIPBENCH_A_NUMBER("k_tangential", 35.0, "N/m"),
    SLIPBENCH_A_NUMBER("marker_columns", 9.0, ""),
    SLIPBENCH_A_NUMBER("marker_rows", 7.0, ""),
    SLIPBENCH_A_NUMBER("marker_pitch", 2e-3, "m"),
    SLIPBENCH_A_NUMBER("width", 320.0, ""),
    SLIPBENCH_A_NUMBER("height", 240.0, ""),
    SLIPBENCH_A_NUMBER("field", 18.6e-3, "m"),
    SLIPBENCH_A_NUMBER("distance", 28.25e-3, "m"),
    SLIPBENCH_A_NUMBER("exposure", 0.0, "s"),
    SLIPBENCH_A_NUMBER("noise", 0.0, ""),
    SLIPBENCH_A_NUMBER("height_noise", 0.0, "m"),
    SLIPBENCH_A_NUMBER("dropout", 0.0, ""),
    SLIPBENCH_A_NUMBER("map", 0.0, ""),
    SLIPBENCH_NO_MORE,
};

static const char* const data_sheet = "GelSight Mini data sheet";
static const char* const sdk = "gelsightinc/gsrobotics: 7 x 9 markers, 31 px of 0.0634 mm apart, in pictures of 320 x 240";
static const char* const spring = "assumed: E A/t, G A/t of 1 mm2, 4.25 mm, G 0.15 MPa; elastic_skin replaces it";
static const slipbench_note notes[] = {
    {"Frame rate.", data_sheet, 1.0, 1e5, ""},
    {"Elements of the skin along X, a whole number.", "assumed: the skin extends beyond the picture", 2.0, 64.0, ""},
    {"Elements of the skin along Y, a whole number.", "assumed: the skin extends beyond the picture", 2.0, 64.0, ""},
    {"Distance of elements along X and Y.", "assumed: a quarter of the gel's 4.25 mm", 1e-5, 1.0, ""},
    {"Radius of a domed surface; 0: flat.", "GelSight Mini is flat", 0.0, 10.0, ""},
    {"Normal stiffness of an element.", spring, 1e-6, 1e9, ""},
    {"Tangential stiffness of an element.", spring, 1e-6, 1e9, ""},
    {"Markers along X, a whole number.", sdk, 1.0, 512.0, ""},
    {"Markers along Y, a whole number.", sdk, 1.0, 512.0, ""},
    {"Distance of markers.", sdk, 1e-5, 1.0, ""},
    {"Width of the picture in pixels.", sdk, 1.0, 1e5, ""},
    {"Height of the picture in pixels.", sdk, 1.0, 1e5, ""},
    {"Width of the part of the unloaded gel that the camera sees.", data_sheet, 1e-4, 1.0, ""},
    {"Distance from the pinhole to the surface.", "TacEx: 24 mm; gel: 4.25 mm", 1e-3, 1.0, ""},
    {"Exposure time of a frame, up to the time between two frames.", "set for each scene", 0.0, 1.0, ""},
    {"Standard deviation of a marker's position in the picture [px].", "set for each scene", 0.0, 100.0, ""},
    {"Standard deviation of a marker's height.", "set for each scene", 0.0, 1e-2, ""},
    {"Share of the markers that are missing in a frame.", "set for each scene", 0.0, 1.0, ""},
    {"Columns of the picture of heights, a whole number; 0: none.", "set for each scene", 0.0, 1024.0, ""},
};
const slipbench_about slipbench_sensor_about = {
    "A gel with markers on its skin and a camera behind it, after GelSight Mini.",
    "u: displacement of the skin, bilinear between its elements, u = shear across n - depth n; n: direction out of the pad\n"
    "marker: x = x0 + u; the path is linear from frame to frame and averaged over the exposure\n"
    "pixel = middle + f (x, -y)/(distance - z), f = width distance/field, seen from behind: x to the right, y up\n"
    "displacement: pixel and height transformed to the pad's frame, minus the position without load; a marker that is missing or outside the picture repeats its last value",
    "W. Yuan, S. Dong, E. H. Adelson, Sensors 17(12), 2762 (2017): gel, markers, camera; pinhole camera without refraction",
    notes, nullptr};
const slipbench_abi slipbench_sensor_abi = SLIPBENCH_SENSOR_BUILD;

namespace {

using Vector = std::array<double, 3>;

// A point of the skin: its position without load, and its bilinear weights for four elements.
struct Point {
  Vector rest;
  std::array<std::size_t, 4> elements;
  std::array<double, 4> shares;
};

// SplitMix64's mix [steele2014]. Each random number is a mix of its purpose, so that none depends
// on how many others are drawn.
std::uint64_t mixed(std::uint64_t x) {
  x += UINT64_C(0x9e3779b97f4a7c15);
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return x ^ (x >> 31);
}

class Gel {
 public:
  Gel(const slipbench_parameter* parameters, const slipbench_readout& asked) : key_(mixed(mixed(asked.seed) ^ asked.trial)) {
    for (std::size_t i = 0; i < std::size(notes); ++i) values_.push_back(parameters[i].number);
    for (const char* letter = asked.name; *letter != '\0'; ++letter) key_ = mixed(key_ ^ static_cast<unsigned char>(*letter));
  }

  // Returns why the parameters are invalid; "" if they are valid.
  std::string fault() const {
    for (const Key key : {columns, rows, marker_columns, marker_rows, map}) {
      if (values_[key] == std::floor(values_[key])) continue;
      std::ostringstream message;
      message << slipbench_sensor_parameters[key].name << " is " << values_[key] << "; it must be a whole number";
      return message.str();
    }
    if ((values_[marker_columns] - 1.0) * values_[marker_pitch] > across() ||
        (values_[marker_rows] - 1.0) * values_[marker_pitch] > along())
      return "the markers reach beyond the elements; use more elements, or fewer or closer markers";
    if (values_[dome] > 0.0 && math::hypot(across(), along()) >= 2.0 * values_[dome])
      return "dome is too small; it must exceed half the pad's diagonal";
    return values_[exposure] * values_[rate] > 1.0 ? "exposure is longer than a frame, 1/rate" : "";
  }

  void lay_out(slipbench_readout& readout) {
    const double curved = values_[dome] > 0.0 ? 1.0 / values_[dome] : 0.0;
    for (const Point& point : grid(values_[columns], values_[rows], values_[pitch], values_[pitch])) {
      const auto [x, y, z] = point.rest;
      elements_.push_back(
          {{x, y, z}, {x * curved, y * curved, z * curved - 1.0}, values_[k_normal], values_[k_tangential], elements_.size()});
    }
    skin_.resize(elements_.size());
    last_.resize(elements_.size());
    markers_ = grid(values_[marker_columns], values_[marker_rows], values_[marker_pitch], values_[marker_pitch]);
    for (const Point& marker : markers_) shown_.push_back(marker.rest);
    const double map_rows = std::round(values_[map] * values_[rows] / values_[columns]);
    map_ = grid(values_[map], map_rows, across() / std::max(1.0, values_[map] - 1.0), along() / std::max(1.0, map_rows - 1.0));
    shapes_ = {
        markers_.size(), 3, markers_.size(), 2, static_cast<std::size_t>(map_rows), static_cast<std::size_t>(values_[map])};
    channels_ = {{{"displacement", "m", &shapes_[0], 2, 0, 0},
                  {"pixel", "px", &shapes_[2], 2, 0, 0},
                  {"seen", "", &shapes_[0], 1, 0, 0},
                  {"height", "m", &shapes_[4], 2, 0, 0}}};
    readout.rate = values_[rate];
    readout.elements = elements_.data();
    readout.element_count = elements_.size();
    readout.channels = channels_.data();
    readout.channel_count = map_.empty() ? 3 : 4;
  }

  void measure(const slipbench_contact& contact, float* values) {
    move_skin(contact);
    float* const pixels = values + 3 * markers_.size();
    float* const seen = pixels + 2 * markers_.size();
    for (std::size_t i = 0; i < markers_.size(); ++i) {
      seen[i] = look(i) ? 1.0F : 0.0F;
      const auto pixel = pixel_of(shown_[i]);
      for (std::size_t k = 0; k < 3; ++k) values[3 * i + k] = static_cast<float>(shown_[i][k] - markers_[i].rest[k]);
      for (std::size_t k = 0; k < 2; ++k) pixels[2 * i + k] = static_cast<float>(pixel[k]);
    }
    std::transform(map_.begin(), map_.end(), seen + markers_.size(),
                   [&](const Point& point) { return static_cast<float>(place_of(point)[2]); });
    ++frames_;
  }

 private:
  // Displacement of the skin at each element, in P, as a frame shows it. An elastic skin's depth is
  // already measured where its loaded surface is, so it includes the share of the shear along n
  // that comes from the surface's slope.
  void move_skin(const slipbench_contact& contact) {
    const double back = frames_ == 0 ? 0.0 : 0.5 * values_[exposure] * values_[rate];
    for (std::size_t e = 0; e < elements_.size(); ++e) {
      const double *const n = elements_[e].direction, *const s = contact.shear + e;
      const std::size_t next = contact.elements;
      const double along = s[0] * n[0] + s[next] * n[1] + s[2 * next] * n[2] + contact.depth[e];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double now = s[axis * next] - along * n[axis];
        skin_[e][axis] = now + back * (last_[e][axis] - now);
        last_[e][axis] = now;
      }
    }
  }

  // True if the camera sees marker i; then updates where the marker is shown.
  bool look(std::size_t i) {
    const Vector place = place_of(markers_[i]);
    auto [x, y] = pixel_of(place);
    double z = place[2];
    if (values_[noise] > 0.0) {
      x += values_[noise] * gaussian(8 * i);
      y += values_[noise] * gaussian(8 * i + 2);
    }
    if (values_[height_noise] > 0.0) z += values_[height_noise] * gaussian(8 * i + 4);
    const bool missed = values_[dropout] > 0.0 && uniform(8 * i + 6) < values_[dropout];
    if (missed || z >= values_[distance] || x < 0.0 || x > values_[width] || y < 0.0 || y > values_[height]) return false;
    const double scale = (values_[distance] - z) / focal_length();
    shown_[i] = {(x - 0.5 * values_[width]) * scale, (0.5 * values_[height] - y) * scale, z};
    return true;
  }

  Vector place_of(const Point& point) const {
    Vector place = point.rest;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 4; ++k) place[axis] += point.shares[k] * skin_[point.elements[k]][axis];
    }
    return place;
  }

  double focal_length() const { return values_[width] * values_[distance] / values_[field]; }  // px
  std::array<double, 2> pixel_of(const Vector& place) const {
    const double scale = focal_length() / (values_[distance] - place[2]);
    return {0.5 * values_[width] + scale * place[0], 0.5 * values_[height] - scale * place[1]};
  }

  double across() const { return (values_[columns] - 1.0) * values_[pitch]; }  // m, between the first and the last element
  double along() const { return (values_[rows] - 1.0) * values_[pitch]; }

  // Points centred on the pad, in rows from +Y to -Y, each from -X to +X.
  std::vector<Point> grid(double wide, double high, double right, double down) const {
    std::vector<Point> points;
    for (double i = 0.0; i < wide * high; ++i) {
      const double x = (std::fmod(i, wide) - 0.5 * (wide - 1.0)) * right, y = (0.5 * (high - 1.0) - std::floor(i / wide)) * down;
      const double z = values_[dome] > 0.0 ? values_[dome] - std::sqrt(values_[dome] * values_[dome] - x * x - y * y) : 0.0;
      const double u = (x + 0.5 * across()) / values_[pitch], v = (0.5 * along() - y) / values_[pitch];
      const double column = std::clamp(std::floor(u), 0.0, values_[columns] - 2.0),
                   row = std::clamp(std::floor(v), 0.0, values_[rows] - 2.0);
      const double s = u - column, t = v - row;
      const auto corner = static_cast<std::size_t>(row * values_[columns] + column),
                 below = corner + static_cast<std::size_t>(values_[columns]);
      points.push_back(
          {{x, y, z}, {corner, corner + 1, below, below + 1}, {(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t}});
    }
    return points;
  }

  // Random number `which` of this frame, in [0, 1). This number and the next one give a normal one
  // (Box, Muller).
  double uniform(std::size_t which) const { return static_cast<double>(mixed(mixed(key_ + frames_) + which) >> 11) * 0x1p-53; }
  double gaussian(std::size_t which) const {
    return std::sqrt(-2.0 * math::log1p(-uniform(which))) * math::cos(6.283185307179586 * uniform(which + 1));
  }

  std::uint64_t key_, frames_ = 0;
  std::vector<double> values_;  // the parameters, indexed by Key
  std::vector<slipbench_element> elements_;
  std::vector<Vector> skin_, last_;  // displacement of each element: as this frame shows it, and at the end of the last frame
  std::vector<Vector> shown_;        // last seen position of each marker
  std::vector<Point> markers_, map_;
  std::array<std::size_t, 6> shapes_;
  std::array<slipbench_channel, 4> channels_;
};

}  // namespace

void slipbench_make_sensor(const slipbench_source* source, slipbench_readout* readout) {
  auto gel = std::make_unique<Gel>(source->parameters, *readout);
  std::snprintf(readout->refusal, sizeof readout->refusal, "%s", gel->fault().c_str());
  if (readout->refusal[0] != '\0') return;
  gel->lay_out(*readout);
  readout->measure = [](void* self, const slipbench_contact* contact, float* values) {
    static_cast<Gel*>(self)->measure(*contact, values);
  };
  readout->destroy = [](void* self) { delete static_cast<Gel*>(self); };
  readout->self = gel.release();
}
