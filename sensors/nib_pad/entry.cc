#include <cmath>
#include <utility>
#include <vector>

#include "sensors/nib_pad/nib_pad.h"
#include "sim/core/parameters.h"

namespace slipbench {
namespace nib_pad {
namespace {

constexpr Range some_length = positive_up_to(0.1);

// Counts at 13 bit. None is published for this device.
constexpr double si_noise = 1.5, cluster_noise = 1.2;
constexpr double offset = 20.0;
constexpr double drift = 0.02;  // counts/s
constexpr double gain = 0.05;   // of one electrode

// Where a taxel is from the middle one: -1, 0 or 1 to the east and to the north.
struct Place {
  int east, north;
};
Place place_of(std::size_t taxel) { return {static_cast<int>(taxel % 3) - 1, 1 - static_cast<int>(taxel / 3)}; }

// Whether the electrode on `side` of a taxel is on the side to which a counter-clockwise turn (`turn` = 1; clockwise: -1) about the pad's
// middle drags it: the turn's velocity there is (-north, east).
bool is_ahead(std::size_t taxel, Side side, int turn) {
  const Place place = place_of(taxel);
  switch (side) {
    case Side::west: return turn * place.north > 0;
    case Side::north: return turn * place.east > 0;
    case Side::east: return turn * place.north < 0;
    case Side::south: return turn * place.east < 0;
  }
  return false;
}

bool connects(std::size_t v, std::size_t taxel, Side side) {
  if (v < si_size) return v == sides * taxel + static_cast<std::size_t>(side);
  if (v < fr_first) return side == (v == fl_first ? Side::north : Side::south);
  return is_ahead(taxel, side, v == fr_first ? 1 : -1);
}

}  // namespace

Entry about() {
  return {
      .name = "nib_pad",
      .summary = "Capacitive nib pad: 6x6 silicone nibs, 9 taxels of four electrodes, clusters for fast shear and torsion.",
      .law =
          "C = C0 g0/(g0 - u - r t), per nib and electrode;  u = min(f_n/k_post, g0 - gf);  t = q/L towards the electrode,\n"
          "|t| <= (g0 - u - gf)/R: at this limit the fabric's rim rests on the mask and tilts no further\n"
          "f_n: normal force of the nib; q: deflection of its tip; r: electrode_place; R: fabric_radius; gf: mask_gap\n"
          "si = C of a taxel's four nibs on one side; fl, fr = C of a cluster: N and S of all taxels; the tangential electrodes\n"
          "of the eight outer taxels, counter-clockwise about +Z first\n"
          "counts = round(rest + gain sum(C - C0)), kept within 0 and full scale as by the converter\n"
          "a sample: fl N, fl S, fr +, fr -, then W, N, E, S of one taxel, each 1/8 of the sampling time after the one before\n"
          "Nine samples make an image of si; si is averaged over the last images.",
      .source =
          "\"Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation\", IEEE RA-L 2020: geometry, electrodes, scan, bits. Stiffness and capacitance follow from the geometry (README)",
      .parameters = {
          number_spec("rate", Quantity::frequency, "300 Hz", positive, "Samples a second; an image of si takes nine.",
                      "the paper: 300 Hz for fl and fr, 33.3 Hz for si"),
          choice_spec(
              "scan", "multiplexed", {"multiplexed", "simultaneous"},
              "multiplexed: the eight readings of a sample follow one another; simultaneous: they, and those of an image of si, are taken at one instant.",
              "multiplexed: the paper's figure 5; simultaneous: to see what the skew does"),
          integer_spec("average", "5", {1.0, 100.0},
                       "Number of images over which si is averaged, fewer at the start; 1: no average.",
                       "the paper: moving average of 5"),
          number_spec(
              "k_normal", Quantity::stiffness, "0.83 N/mm", positive, "Normal stiffness of a nib.",
              "post, nib and rounded tip in series, with 1.15 MPa of Shore A 30. The hardness is assumed: the paper names TAP's RTV no closer"),
          number_spec(
              "k_tangential", Quantity::stiffness, "0.2 N/mm", positive, "Tangential stiffness of a nib's tip without load.",
              "assumed: 0.1 to 0.4 are possible. Neither 0.03, of the post alone, nor 0.1, with the fabric's strips, could carry the paper's 3.5 N of shear"),
          number_spec("height_sd", Quantity::length, "0.03 mm", {0.0, 1e-3},
                      "Standard deviation of the nibs' heights, normal, drawn for the device.",
                      "assumed: the mould is printed in layers of 0.028 mm"),
          number_spec("post", Quantity::stiffness, "10.4 N/mm", positive,
                      "Stiffness of the post below the fabric, which sets the gap.",
                      "the paper's 1 mm x 0.254 mm, bonded on both sides: E (1 + 2 S^2) A/h, S = 0.98, 1.15 MPa"),
          number_spec("lever", Quantity::length, "3.65 mm", some_length, "Distance from the hinge below the fabric to the tip.",
                      "the paper: nib of 3.4 mm on a gap of 0.254 mm"),
          number_spec("fabric_radius", Quantity::length, "1.4 mm", some_length, "Radius of the fabric that tilts with its nib.",
                      "the paper: nibs of 2.8 mm. Assumed: the fabric is stiff below the nib and no further"),
          number_spec("electrode_place", Quantity::length, "1.1 mm", some_length,
                      "Distance from the nib's axis to the middle of an electrode.",
                      "assumed: between the post and the nib's rim"),
          number_spec("gap", Quantity::length, "0.254 mm", some_length, "Gap from the fabric to the electrodes without load.",
                      "the paper: thickness of the mask that shapes the posts"),
          number_spec("mask_gap", Quantity::length, "0.03 mm", some_length,
                      "Gap that the solder mask and the coat of silicone leave where the fabric rests on them.", "assumed"),
          number_spec("capacitance", Quantity::none, "0.045", positive, "C0 of one electrode of one nib, in pF.",
                      "assumed: 1.3 mm2 over 0.254 mm of air"),
          choice_spec("capacitor", "gap", {"gap", "linear"},
                      "gap: capacitance goes with 1/gap; linear: with its tangent at rest, which no device has, for comparison.",
                      "gap: a plate capacitor"),
          number_spec(
              "gain", Quantity::none, "850", positive, "Counts per pF of si, at 13 bit.",
              "assumed: 6960 counts at 8.2 pF, most of which is the wiring's. A taxel whose four nibs have their fabric flat on the mask then just stays below full scale"),
          number_spec(
              "cluster_gain", Quantity::none, "300", positive, "Counts per pF of fl and fr, at 13 bit.",
              "assumed: at the paper's strongest linear grip, 8 N, fl then just stays below full scale however far it is pulled"),
          integer_spec("bits", "13", {4.0, 16.0}, "Resolution of the converter.", "the paper"),
          number_spec("rest", Quantity::none, "85 %", {0.0, 1.0}, "Reading of an untouched pad, as a share of full scale.",
                      "the maker's tuning guide (Infineon, PSoC 4 CapSense): calibrated to 85 %, 6962 of 8191"),
          choice_spec("device", "fixed", {"fixed", "redrawn"},
                      "Whether all trials of a dataset use one device, or each draws its own heights and gains.",
                      "fixed: the paper has two pads and calibrates one"),
          number_spec(
              "label_distance", Quantity::length, "2 mm", positive,
              "Distance that the object has moved over a nib, lean of the nib and slip together, from which the paper's rule says slip.",
              "the paper, section IV-B: its criterion is a pull displacement of about 2 mm"),
      }};
}

SensorView view() {
  std::vector<std::vector<std::size_t>> nibs_of(taxels);
  for (std::size_t nib = 0; nib < nibs; ++nib) nibs_of[taxel_of(nib)].push_back(nib);
  // Differences: north less south electrodes, one sense of rotation less the other (the paper, section II).
  return {.unit = "nib",
          .units = "nibs",
          .letter = "N",
          .from_behind = true,
          .orientation = "so that east is right and north is up",
          .channels = {{.channel = "fl",
                        .name = "FL: clusters N and S",
                        .note = "all nine north electrodes and all nine south electrodes together, 300 Hz",
                        .difference = "FL",
                        .spectrum = SpectrumView{"FL, north minus south", 0.5, 0.1, 20.0}},
                       {.channel = "fr",
                        .name = "FR: clusters + and −",
                        .note = "tangential electrodes of the eight outer taxels, counter-clockwise and clockwise, 300 Hz",
                        .difference = "FR",
                        .spectrum = SpectrumView{"FR, counter-clockwise minus clockwise", 0.5, 0.1, 20.0}},
                       {.channel = "si", .name = "SI: electrodes of one taxel", .note = "one image is read within nine samples"}},
          .picture = PadPicture{.channel = "si",
                                .cells = std::move(nibs_of),
                                .width = 1.88,
                                .note = "Behind each taxel its four electrodes: what SI reads there above its first image."}};
}

SignalModel signal_model(double rate, double count) {
  SignalModel model;
  model.rate = rate;
  model.sources = value_count;
  for (std::size_t v = 0; v < value_count; ++v) {
    model.source.push_back(v);
    model.noise_sd.push_back(count * (v < si_size ? si_noise : cluster_noise));
    model.offset_sd.push_back(count * offset);
    model.drift_sd.push_back(count * drift);
    // A cluster is the sum of 9 or 12 of the same electrodes, whose gains are drawn apart from one another.
    model.gain_sd.push_back(v < fl_first ? gain : gain / std::sqrt(v < fr_first ? 9.0 : 12.0));
  }
  return model;
}

std::vector<Entry> electronics_parts() {
  return electronics_of(
      "nib pad",
      {{"gain", "assumed: 5 % of what is above rest, from electrode to electrode, as gaps and areas are made"},
       {"offset",
        "assumed: 20 counts of 13 bit, about a third of a step of the 7-bit current source that calibrates the reading at rest"},
       {"drift", "assumed: 0.02 counts/s of 13 bit, 3 ppm/s of the reading at rest, by temperature"},
       {"noise",
        "assumed: 1.5 counts of 13 bit for si, 1.2 for clusters. The maker calls less than 10 counts quiet (Infineon's tuning guide); another capacitive fingertip has 0.8 to 1.3 counts (FabricSlide)",
        {{"corner", "inf", "a converter's noise is white: each reading integrates anew"}}}});
}

std::size_t taxel_of(std::size_t nib) { return 3 * (nib / rows / 2) + nib % rows / 2; }

std::vector<Electrode> electrodes_of(std::size_t v) {
  std::vector<Electrode> electrodes;
  for (std::size_t nib = 0; nib < nibs; ++nib) {
    for (const Side side : {Side::west, Side::north, Side::east, Side::south}) {
      if (connects(v, taxel_of(nib), side)) electrodes.push_back({nib, side});
    }
  }
  return electrodes;
}

}  // namespace nib_pad

}  // namespace slipbench
