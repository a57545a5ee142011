// A magnetic skin: magnets in an elastomer move with its surface, and three-axis magnetometers
// behind it read their field. Like a custom library it needs no other header than
// sensors/plugin_abi.h: slipbench_bundled_sensor builds it into the program as `type:
// magnetic_skin`, and g++ -shared -fPIC makes a library of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "sensors/plugin_abi.h"
#ifdef SLIPBENCH_BUNDLED_TYPE  // in the program: bit-identical on every processor
#include "sim/core/math.h"
namespace math = slipbench::math;
#else
namespace math = std;
#endif

// In the order of the declarations below.
enum : std::size_t {
  rate,
  rows,
  columns,
  pitch,
  k_normal,
  k_tangential,
  thickness,
  magnet_depth,
  magnet_diameter,
  magnet_thickness,
  remanence,
  pole_pitch,
  chips,
  chip_pitch,
  gap,
  sensitivity,
  sensitivity_z,
  noise,
  offset,
  warming,
  warming_time,
  fading,
  noise_ratio,
  placement,
  refresh,
  refresh_jitter,
  device
};
const slipbench_parameter slipbench_sensor_parameters[] = {
    SLIPBENCH_A_NUMBER("rate", 100.0, "Hz"),
    SLIPBENCH_A_NUMBER("rows", 4.0, ""),
    SLIPBENCH_A_NUMBER("columns", 4.0, ""),
    SLIPBENCH_A_NUMBER("pitch", 4.7e-3, "m"),
    SLIPBENCH_A_NUMBER("k_normal", 1400.0, "N/m"),
    SLIPBENCH_A_NUMBER("k_tangential", 470.0, "N/m"),
    SLIPBENCH_A_NUMBER("thickness", 4e-3, "m"),
    SLIPBENCH_A_NUMBER("magnet_depth", 1e-3, "m"),
    SLIPBENCH_A_NUMBER("magnet_diameter", 1.6e-3, "m"),
    SLIPBENCH_A_NUMBER("magnet_thickness", 0.5e-3, "m"),
    SLIPBENCH_A_NUMBER("remanence", 1.4, ""),
    SLIPBENCH_A_NUMBER("pole_pitch", 0.0, "m"),
    SLIPBENCH_A_TEXT("chips", "grid"),
    SLIPBENCH_A_NUMBER("chip_pitch", 7e-3, "m"),
    SLIPBENCH_A_NUMBER("gap", 1e-3, "m"),
    SLIPBENCH_A_NUMBER("sensitivity", 0.601, ""),
    SLIPBENCH_A_NUMBER("sensitivity_z", 0.968, ""),
    SLIPBENCH_A_NUMBER("noise", 7.3, ""),
    SLIPBENCH_A_NUMBER("offset", 80.0, ""),
    SLIPBENCH_A_NUMBER("warming", 0.0, ""),
    SLIPBENCH_A_NUMBER("warming_time", 600.0, "s"),
    SLIPBENCH_A_NUMBER("fading", 0.0011, ""),
    SLIPBENCH_A_NUMBER("noise_ratio", 1.0, ""),
    SLIPBENCH_A_NUMBER("placement", 0.0, "m"),
    SLIPBENCH_A_NUMBER("refresh", 0.0, "Hz"),
    SLIPBENCH_A_NUMBER("refresh_jitter", 0.2, ""),
    SLIPBENCH_A_TEXT("device", "fixed"),
    SLIPBENCH_NO_MORE,
};

namespace {

const char* const chip = "Melexis MLX90393, data sheet";
const slipbench_note notes[] = {
    {"Sampling rate.", "set for each scene", 0.1, 1e4, ""},
    {"Cells along Y, each with a dipole.", "uSkin (Tomo and others 2018): 4 x 4", 1.0, 64.0, ""},
    {"Cells along X.", "as rows", 1.0, 64.0, ""},
    {"Edge of a cell.", "assumed, after the XR1944, a uSkin", 1e-4, 0.1, ""},
    {"Normal stiffness of a cell; elastic_skin replaces it.", "assumed: silicone of 0.25 MPa, E pitch^2/thickness", 1e-3, 1e9,
     ""},
    {"Tangential stiffness of a cell; elastic_skin replaces it.", "assumed: a third of k_normal, G/E of an incompressible body",
     1e-3, 1e9, ""},
    {"Thickness of the skin, from its surface to its rigid back.", "assumed", 1e-4, 0.1, ""},
    {"Depth of a dipole's middle below the surface.", "assumed", 0.0, 0.1, ""},
    {"Diameter of a magnet, a disc; 0: the whole cell is magnetised.", "assumed: the smallest NdFeB discs", 0.0, 0.1, ""},
    {"Thickness of a magnet, or of the magnetised layer.", "assumed", 1e-6, 0.1, ""},
    {"Remanence of the magnet's material [T], along +Z.", "NdFeB of grade N50: 1.40 to 1.45 T", 0.0, 2.0, ""},
    {"Edge of squares that are magnetised up and down alternately; 0: all cells alike.", "set for each scene", 0.0, 1.0, ""},
    {"Magnetometers: one behind each cell, or five.", "uSkin: grid. ReSkin (Bhirangi and others 2021): cross", 0.0, 0.0,
     "grid|cross"},
    {"Distance from the middle of the cross to its ends.", "ReSkin's board", 1e-4, 1.0, ""},
    {"Distance from the back of the skin to the magnetometers' sensing point.", "assumed: a package is 1 mm high", 1e-5, 0.1, ""},
    {"Field of one count along X and Y, in uT; 16 bits saturate.", chip, 1e-3, 100.0, ""},
    {"Field of one count along Z, in uT.", chip, 1e-3, 100.0, ""},
    {"Standard deviation of a reading along X and Y, in counts.", "measured: public recordings, sensors/magnetic_skin/README.md",
     0.0, 1e4, ""},
    {"Standard deviation of an axis' offset, in counts.", "assumed: Earth's field, 50 uT from any direction", 0.0, 3e4, ""},
    {"Final rise of the skin's temperature [K].", "set for each scene", -100.0, 100.0, ""},
    {"Time constant of the temperature rise.", "assumed", 1e-3, 1e9, ""},
    {"Share of the magnets' field that is lost per K.", "NdFeB: reversible coefficient of remanence", -0.1, 0.1, ""},
    {"Noise of a reading along Z over that along X and Y.", "1: eFlesh's recordings, sensors/magnetic_skin/README.md", 0.0, 100.0,
     ""},
    {"Standard deviation of a magnet's position along X and Y from the middle of its cell; normal load then appears as shear.",
     "set for each scene; 0.2 mm fits public recordings of a uSkin on a gripper, sensors/magnetic_skin/README.md", 0.0, 0.1, ""},
    {"Rate of new values; samples between them repeat the latest values. 0: each sample is new.",
     "set for each scene; 9.6 Hz in raw recordings of a uSkin at 37 Hz, sensors/magnetic_skin/README.md", 0.0, 1e4, ""},
    {"Standard deviation of the time between new values, divided by its mean.", "measured: the same recordings", 0.0, 0.3, ""},
    {"fixed: all trials use one device; redrawn: each trial draws new positions of the magnets.",
     "fixed: a dataset comes from one device", 0.0, 0.0, "fixed|redrawn"},
};

constexpr double most_counts = 32767.0, pi = 3.141592653589793;

using Vector = std::array<double, 3>;
struct Magnet {
  Vector at;        // m, undeformed
  double strength;  // uT m^3: mu0 m/(4 pi), + or - along Z
};

struct Skin {
  std::array<double, refresh_jitter + 1> values;  // the numeric parameters; 0 for `chips`
  std::vector<slipbench_element> elements;
  std::vector<Magnet> magnets, moved;  // one per cell
  std::vector<Vector> magnetometers;
  std::vector<std::size_t> shape;  // of every channel
  std::vector<slipbench_channel> channels;
  std::vector<double> offset, rest;  // counts per axis: of the chip; and without load, not rounded
  Vector sensitivity;                // uT
  double share;                      // of the surface's displacement, at a magnet's depth
  bool forces;                       // one magnetometer behind each magnet, so that it reads a known magnet
  std::uint64_t random, clock;       // streams of the noise and of the times of new values
  double next, last;                 // s, time of the next new values, and of the last reading
  std::vector<float> latest;         // values of all channels, with `refresh`
};

// SplitMix64 [steele2014].
double uniform(std::uint64_t& state) {
  std::uint64_t z = state += UINT64_C(0x9e3779b97f4a7c15);
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return (static_cast<double>((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
}

// Box and Muller.
double normal(std::uint64_t& state) {
  const double radius = std::sqrt(-2.0 * math::log(uniform(state)));
  return radius * math::cos(2.0 * pi * uniform(state));
}

// Returns the field [uT] of all dipoles at one point: s (3 r (z.r)/r^5 - z/r^3), r from the dipole
// to the point.
Vector field_at(const Vector& place, const std::vector<Magnet>& magnets) {
  Vector field{};
  for (const auto& [at, strength] : magnets) {
    const double x = place[0] - at[0], y = place[1] - at[1], z = place[2] - at[2];
    const double square = x * x + y * y + z * z, cubed = strength / (square * std::sqrt(square));
    const double along = 3.0 * z * cubed / square;
    field[0] += along * x;
    field[1] += along * y;
    field[2] += along * z - cubed;
  }
  return field;
}

// Returns the force [N] on a cell, from the `field` [uT] of a lone dipole straight below the
// magnetometer when unloaded: locates the dipole and multiplies its displacement by the cell's
// stiffness. With t the tangent of the angle of r to Z, B_t/B_z = 3 t/(2 - t^2) and B = s sqrt(1 +
// 3 cos^2)/r^3.
Vector force_of(const Skin& skin, const Vector& field, const Magnet& magnet, double height) {
  const double sign = magnet.strength < 0.0 ? -1.0 : 1.0, z = sign * field[2], across = math::hypot(field[0], field[1]);
  const double tangent = 4.0 * across / (3.0 * z + std::sqrt(9.0 * z * z + 8.0 * across * across));
  const double cosine = 1.0 / math::hypot(1.0, tangent);
  const double distance = math::cbrt(std::abs(magnet.strength) * std::sqrt(1.0 + 3.0 * cosine * cosine) / math::hypot(z, across));
  const double beside =
      across > 0.0 ? -sign * skin.values[k_tangential] * distance * cosine * tangent / (across * skin.share) : 0.0;
  return {beside * field[0], beside * field[1], skin.values[k_normal] * (height - distance * cosine) / skin.share};
}

void convert(Skin& skin, const slipbench_contact* contact, float* values) {
  const double warmer = -skin.values[warming] * math::expm1(-contact->time / skin.values[warming_time]),
               left = 1.0 - skin.values[fading] * warmer;
  skin.moved = skin.magnets;
  for (std::size_t i = 0; i < contact->elements; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      skin.moved[i].at[axis] +=
          skin.share * (contact->shear[axis * contact->elements + i] + (axis == 2 ? contact->depth[i] : 0.0));
  }
  const std::size_t count = skin.magnetometers.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector field = field_at(skin.magnetometers[i], skin.moved);
    float *change = values + 3 * i, *counts = change + 3 * count, *forces = counts + 3 * count;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t k = 3 * i + axis;
      double read = left * field[axis] / skin.sensitivity[axis] + skin.offset[k];
      if (skin.values[noise] > 0.0)
        read += (axis == 2 ? skin.values[noise_ratio] : 1.0) * skin.values[noise] * normal(skin.random);
      read = std::clamp(std::nearbyint(read), -most_counts - 1.0, most_counts);
      counts[axis] = static_cast<float>(read);
      change[axis] = static_cast<float>((read - skin.rest[k]) * skin.sensitivity[axis]);
    }
    if (!skin.forces) continue;
    const Magnet& own = skin.magnets[i];
    const double height = skin.magnetometers[i][2] - own.at[2], alone = 2.0 * own.strength / (height * height * height);
    const Vector force = force_of(skin, {change[0], change[1], alone + change[2]}, own, height);
    std::transform(force.begin(), force.end(), forces, [](double value) { return static_cast<float>(value); });
  }
}

void measure(void* self, const slipbench_contact* contact, float* values) {
  Skin& skin = *static_cast<Skin*>(self);
  if (skin.values[refresh] == 0.0) return convert(skin, contact, values);
  const double now = contact->time + 1e-9;  // s: times are sums of doubles
  // A simulation that was reset begins anew.
  if (now < std::exchange(skin.last, now)) skin.next = now;
  if (now >= skin.next) {
    convert(skin, contact, skin.latest.data());
    while (skin.next <= now)
      skin.next += std::max(0.1, 1.0 + skin.values[refresh_jitter] * normal(skin.clock)) / skin.values[refresh];
  }
  std::copy(skin.latest.begin(), skin.latest.end(), values);
}

// Places the parts in the pad's frame: cells in rows from +Y to -Y, each from -X to +X; the surface
// at z = 0, the magnetometers above.
void place(Skin& skin) {
  const auto& values = skin.values;
  const double edge = values[pitch], radius = 0.5 * values[magnet_diameter], pole = values[pole_pitch];
  const double area = radius > 0.0 ? pi * radius * radius : edge * edge;
  const double strength = 1e6 * values[remanence] * area * values[magnet_thickness] / (4.0 * pi);
  const double back = values[thickness] + values[gap], end = values[chip_pitch];
  const auto odd = [&](double at) { return static_cast<long>(std::floor(at / pole)) % 2 != 0; };
  const double right = 0.5 * (values[columns] - 1.0), top = 0.5 * (values[rows] - 1.0);
  for (std::size_t i = 0; static_cast<double>(i) < values[rows] * values[columns]; ++i) {
    const double above = std::floor(static_cast<double>(i) / values[columns]),
                 beside = static_cast<double>(i) - above * values[columns];
    const double x = (beside - right) * edge, y = (top - above) * edge;
    skin.magnets.push_back({{x, y, values[magnet_depth]}, pole > 0.0 && odd(x) != odd(y) ? -strength : strength});
    skin.elements.push_back({{x, y, 0.0}, {0.0, 0.0, -1.0}, values[k_normal], values[k_tangential], i});
    if (skin.forces) skin.magnetometers.push_back({x, y, back});
  }
  if (!skin.forces) skin.magnetometers = {{0, 0, back}, {-end, 0, back}, {end, 0, back}, {0, end, back}, {0, -end, back}};
}

// FNV-1a hash of the sensor's name, starting from `state`.
std::uint64_t keyed(std::uint64_t state, const char* name) {
  for (const char* letter = name; *letter != '\0'; ++letter)
    state = (state ^ static_cast<unsigned char>(*letter)) * UINT64_C(0x100000001b3);
  return state;
}

// Moves the magnets off the middle of their cells, with a separate random stream.
void misplace(Skin& skin, std::uint64_t random) {
  for (Magnet& magnet : skin.magnets) {
    for (const std::size_t axis : {0U, 1U}) magnet.at[axis] += skin.values[placement] * normal(random);
  }
}

}  // namespace

const slipbench_abi slipbench_sensor_abi = SLIPBENCH_SENSOR_BUILD;

static const slipbench_unit units[] = {{"field", "uT"}, {"counts", "counts"}, {nullptr, nullptr}};

const slipbench_about slipbench_sensor_about = {
    "Magnetic skin: magnets in an elastomer, or magnetised elastomer, above magnetometers of three axes.",
    "u = (1 - magnet_depth/thickness) u_surface: a dipole moves less than the surface above it, in a straight line to the rigid back\n"
    "B = sum of Br V/(4 pi) (3 r (z.r)/r^5 - z/r^3) [T], r from a dipole to the magnetometer, V its volume; nothing tilts\n"
    "counts = round(B (1 - fading T)/sensitivity + offset + noise), T = warming (1 - exp(-t/warming_time)), saturated at 16 bits\n"
    "A single magnet at height h, displaced by e from its cell's middle, causes B_x/B_z = -3 e/(2 h): dB_x/dB_z = -2 e/h under load\n"
    "field [uT] = (counts - counts at rest) sensitivity: the change since the skin was free and cold\n"
    "force (chips: grid): displacement of a single dipole that causes this field, times k_normal and k_tangential; neighbours appear as cross-talk",
    "Point dipoles: Jackson, Classical Electrodynamics, 5.6. Skins: Tomo and others, IEEE RA-L 3, 2018 (uSkin); Bhirangi and others, CoRL 2021 (ReSkin)",
    notes, units};

void slipbench_make_sensor(const slipbench_source* source, slipbench_readout* readout) {
  Skin* skin = new Skin{};
  readout->self = skin;
  readout->destroy = [](void* self) { delete static_cast<Skin*>(self); };
  for (std::size_t k = 0; k < skin->values.size(); ++k) skin->values[k] = source->parameters[k].number;
  auto& values = skin->values;
  const char* wrong = nullptr;
  if (values[magnet_depth] >= values[thickness]) wrong = "magnet_depth must be less than thickness";
  if (values[rows] != std::floor(values[rows]) || values[columns] != std::floor(values[columns]))
    wrong = "rows and columns must be whole numbers";
  if (wrong != nullptr) {
    std::snprintf(readout->refusal, sizeof readout->refusal, "%s", wrong);
    return;
  }
  skin->forces = source->parameters[chips].text[0] == 'g';
  skin->share = 1.0 - values[magnet_depth] / values[thickness];
  skin->sensitivity = {values[sensitivity], values[sensitivity], values[sensitivity_z]};
  place(*skin);

  const std::uint64_t of_seed = readout->seed * UINT64_C(0xd1342543de82ef95);
  skin->random = keyed(of_seed + readout->trial, readout->name);
  skin->clock = keyed(skin->random, "refresh");
  skin->latest.resize(3 * skin->magnetometers.size() * (skin->forces ? 3 : 2));
  const std::uint64_t drawn_for = source->parameters[device].text[0] == 'r' ? readout->trial : 0;
  if (values[placement] > 0.0) misplace(*skin, ~keyed(of_seed + drawn_for, readout->name));
  for (const Vector& at : skin->magnetometers) {
    const Vector field = field_at(at, skin->magnets);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      skin->offset.push_back(values[offset] * normal(skin->random));
      skin->rest.push_back(
          std::clamp(field[axis] / skin->sensitivity[axis] + skin->offset.back(), -most_counts - 1.0, most_counts));
    }
  }

  skin->shape = {skin->magnetometers.size(), 3};
  skin->channels = {{"field", "uT", skin->shape.data(), 2, 0, 0}, {"counts", "counts", skin->shape.data(), 2, 0, 0}};
  if (skin->forces) skin->channels.push_back({"force", "N", skin->shape.data(), 2, 0, 0});
  readout->rate = values[rate];
  readout->elements = skin->elements.data();
  readout->element_count = skin->elements.size();
  readout->channels = skin->channels.data();
  readout->channel_count = skin->channels.size();
  readout->measure = measure;
}
