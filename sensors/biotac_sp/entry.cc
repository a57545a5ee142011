#include "sensors/biotac_sp/entry.h"

#include <utility>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameter_specs.h"

namespace slipbench {
namespace biotac_sp {
namespace {

const std::string recordings = "111 public recordings (yayaneath/BioTacSP-DoS)";

ParameterSpec choice(std::string name, std::vector<std::string> choices, std::string doc, std::string source) {
  ParameterSpec spec =
      number_spec(std::move(name), Quantity::none, choices.front(), any_value, std::move(doc), std::move(source));
  spec.type = ParameterType::choice;
  spec.choices = std::move(choices);
  return spec;
}

ParameterSpec element_count() {
  ParameterSpec spec = number_spec(
      "elements", Quantity::none, "300", {.min = 200.0, .max = 4000.0, .open_min = false},
      "Friction points of the skin, Fibonacci points weighted by the area that they stand for.",
      "a compromise of time and error (README): dents of 1 mm and more within 1 % of a four times finer mesh, edges not");
  spec.type = ParameterType::integer;
  return spec;
}

}  // namespace

Entry about() {
  constexpr Range some_length{0.0, 0.1, true};
  constexpr Range some_rate{
      .min = 1.0, .max = 10e3, .open_min = false};  // the device's own converter makes 4.4 k readings a second
  return {
      .name = "biotac_sp",
      .summary = "BioTac SP fingertip: 24 electrodes under fluid and a curved skin, static pressure, vibration",
      .law =
          "w_e = sum_i d_i (G_ei + S q_i.grad G_ei) - B mean d,  G = (1 - a) exp(-r^2/(2 l^2)) + a exp(-r/L)\n"
          "Z_e = Zrest_e exp(w_e/g) + Zc;  E_e = round(4095/(1 + Z_e/10 kOhm)), 0 to 4095: pressing lowers the counts\n"
          "d_i, q_i: depth of element i, and its drag along the surface; r: from the skin over electrode e; each of G's two parts is scaled so\n"
          "that a dent of the whole skin is felt in full by the electrode that feels it most; mean: by area\n"
          "p = K sum_i min(d_i, core_gap) A_i;  pdc = round(pdc_rest + p/36.5 Pa);  pac = round(2048 + band-pass(p)/0.37 Pa),\n"
          "of first order at 10 and 1040 Hz, moved exactly for a pressure that goes straight between readings\n"
          "skin: elements of stiffness k_normal A_i/A on half an ellipsoid, each along its own normal\n"
          "scan: cycle_rate cycles a second, two slots of a round of 28 and two of pac each: E1 to E24, PDC, TAC, TDC and one more;\n"
          "held, logged at rate",
      .source =
          "BioTac SP product manual, section 5 (divider, conversions, filters) and 9; timing, levels and kernel: measured on " +
          recordings + " and fitted in a dry run on the same; the rest assumed, see each",
      .parameters = {
          number_spec("rate", Quantity::frequency, "100 Hz", some_rate, "Samples a second, rows of the log.",
                      "log of " + recordings),
          number_spec("cycle_rate", Quantity::frequency, "1 kHz", some_rate,
                      "Cycles a second, each of two readings of pac and two slots of the round; a whole multiple of rate.",
                      "Shadow hand's driver; so 20 slots a row, as the repeats in " + recordings +
                          " show (5/7 of the electrodes new in a row)"),
          choice("scan", {"device", "ideal"}, "Whether electrodes and pdc are read by turns and held, or all with each row.",
                 "device: measured; ideal: to see what the scan does"),
          element_count(),
          vector_spec(3, "radii", Quantity::length, "[13.85 mm, 10.1 mm, 9.85 mm]", some_length,
                      "Of the ellipsoid whose lower half is the skin: along the finger, outwards, across.",
                      "bsadr/biotac, a finite element model of the SP: 13.85 x 10.1 x 9.74 to 9.99 mm"),
          number_spec(
              "k_normal", Quantity::stiffness, "37 N/mm", positive, "Stiffness of all elements together.",
              "assumed: 0.047 N/mm3 of 786 mm2, so that a plane dents the skin by core_gap with 2 N, from where on the manual's pressure saturates"),
          number_spec("shear", Quantity::none, "0.5", {.min = 0.0, .max = 2.0, .open_min = true},
                      "Tangential stiffness against the normal one.", "assumed: 0.25 to 1 did not matter in the dry run"),
          number_spec("near", Quantity::length, "3.5 mm", some_length, "l, width of what an electrode feels.",
                      "fitted: 3 to 4 mm; 1.5 and 5 are wrong"),
          number_spec("far", Quantity::length, "9 mm", some_length, "L, reach of the tail.", "fitted; 12 is worse"),
          number_spec("far_share", Quantity::none, "0.5", fraction, "a, share of the tail.", "fitted; 0 and 0.6 are worse"),
          number_spec("swell", Quantity::none, "0.35", non_negative, "B, lift of the skin elsewhere by the fluid driven away.",
                      "fitted: 0.3 to 0.5; 0 and 1 break the correlations of far electrodes"),
          number_spec("stretch", Quantity::none, "0.3", non_negative, "S, how much a dent that is dragged along is felt to move.",
                      "assumed: 0 to 0.7 fit alike; it must stay small"),
          number_spec("gap", Quantity::length, "0.52 mm", some_length, "g, dent that raises an electrode's impedance e times.",
                      "fitted: 0.5 to 0.6 mm"),
          number_spec("common", Quantity::none, "0.1", non_negative, "Zc, impedance in series with all electrodes, in kOhm.",
                      "fitted: 0.1; one session of the recordings has 0.7, cause unknown"),
          number_spec("core_gap", Quantity::length, "1 mm", some_length, "Depth from which on the skin rests on the core.",
                      "assumed: core to skin is 2.0 to 2.6 mm (bsadr/biotac), of which the skin itself about half"),
          number_spec("fluid_stiffness", Quantity::none, "0.56", positive, "K, pressure of the fluid driven away, in kPa/mm3.",
                      "assumed: at 2 N and core_gap the pressure is the force over the area of contact, 23.5 kPa of 42 mm3"),
          number_spec("pdc_rest", Quantity::none, "2600", {.min = 0.0, .max = 4095.0, .open_min = false},
                      "Counts of pdc that nothing touches.", "legacy BioTac at rest: 2580 to 2695"),
          choice("device", {"fixed", "redrawn"},
                 "Whether all trials of a dataset use one device, or each draws its own sensitivities (electronics: gain).",
                 "fixed: one finger made all the recordings"),
          number_spec("label_step", Quantity::length, "10 um", positive,
                      "Change of the bench's position from one row to the next from which on the paper's rule says slip.",
                      "assumed: 1 mm/s at 100 Hz; the paper labels by the motion that the robot was told to make"),
      }};
}

std::vector<Entry> electronics_parts() {
  const std::string recordings = "44 public recordings of a touch (yayaneath/BioTacSP-DoS)";
  return electronics_of(
      "BioTac SP",
      {{"gain",
        "10 % on each electrode's `gap`, which stands in the exponent: assumed; the levels of electrodes differ so much",
        {}},
       {"offset",
        "on the logarithm of each electrode's impedance at rest, sd 0.02: assumed; scale 10 to 30 gives the hundreds of counts between fingers and sessions of public grasps (3dperceptionlab, bts3v2)",
        {}},
       {"drift", "1.5 counts/s, electrodes: " + recordings + ", median of the slope 1.7"},
       {"skewed_noise", "electrodes: 3.1 counts times each one's own noise against the mean, once a reading: " + recordings},
       {"noise",
        "pac alone: 4.8 counts: a legacy BioTac at rest has 4.5 to 5.1; pdc has less than a count, which rounding is",
        {{"corner", "inf", "the legacy recording is nearly white from 2 to 1100 Hz, with no line of the mains"}}}});
}

}  // namespace biotac_sp
}  // namespace slipbench
