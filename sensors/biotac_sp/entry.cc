#include "sensors/biotac_sp/biotac_sp.h"

#include "sensors/electronics/electronics.h"

namespace slipbench {
namespace biotac_sp {

Entry about() {
  const std::string recordings = "111 public recordings (yayaneath/BioTacSP-DoS)";
  constexpr Range some_length = positive_up_to(0.1);
  constexpr Range some_rate{1.0, 10e3};  // the device's own converter makes 4.4 k readings a second
  return {
      .name = "biotac_sp",
      .summary = "BioTac SP fingertip: 24 electrodes under fluid and a curved skin, static pressure, vibration.",
      .law =
          "w_e = sum_i d_i (G_ei + S q_i.grad G_ei) - B mean d,  G = (1 - a) exp(-r^2/(2 l^2)) + a exp(-r/L)\n"
          "Z_e = Zrest_e exp(w_e/g) + Zc;  E_e = round(4095/(1 + Z_e/10 kOhm)), 0 to 4095: pressing lowers the counts\n"
          "d_i, q_i: depth of element i, and its drag along the surface; r: distance of element i from the skin over electrode e; mean: by area\n"
          "Each of G's two parts is scaled: a dent of the whole skin is felt in full by the electrode that feels it most.\n"
          "p = K sum_i min(d_i, core_gap) A_i;  pdc = round(pdc_rest + p/36.5 Pa);  pac = round(2048 + band-pass(p)/0.37 Pa),\n"
          "of first order at 10 and 1040 Hz, exact for a pressure that is linear between readings\n"
          "skin: elements of stiffness k_normal A_i/A on half an ellipsoid, each along its own normal\n"
          "scan: each of cycle_rate cycles a second has two readings of pac and two slots of a round of 28: E1 to E24, PDC, TAC, TDC and\n"
          "one more. Values are held between readings and logged at `rate`.",
      .source =
          "BioTac SP product manual, sections 5 (divider, conversions, filters) and 9. Timing, levels and kernel: measured on and fitted to " +
          recordings + ". The rest is assumed, see each parameter",
      .parameters = {
          number_spec("rate", Quantity::frequency, "100 Hz", some_rate, "Samples a second: rows of the log.",
                      "log of " + recordings),
          number_spec("cycle_rate", Quantity::frequency, "1 kHz", some_rate,
                      "Cycles a second, a whole multiple of `rate`. A cycle has two readings of pac and two slots of the round.",
                      "Shadow hand's driver; so 20 slots a row, as the repeats in " + recordings +
                          " show (5/7 of the electrodes new in a row)"),
          choice_spec("scan", "device", {"device", "ideal"},
                      "device: electrodes and pdc are read in turn and held; ideal: all are read with each row.",
                      "device: measured; ideal: to see what the scan does"),
          integer_spec(
              "elements", "300", {200.0, 4000.0},
              "Friction points of the skin: Fibonacci points, weighted by the area that each stands for.",
              "a compromise of time and error (README): dents of 1 mm and more are within 1 % of a mesh four times finer; edges are not"),
          vector_spec(3, "radii", Quantity::length, "[13.85 mm, 10.1 mm, 9.85 mm]", some_length,
                      "Half axes of the ellipsoid whose lower half is the skin: along the finger, outwards, across.",
                      "bsadr/biotac, a finite element model of the SP: 13.85 x 10.1 x 9.74 to 9.99 mm"),
          number_spec(
              "k_normal", Quantity::stiffness, "37 N/mm", positive, "Stiffness of all elements together.",
              "assumed: 0.047 N/mm3 of 786 mm2; a plane then dents the skin by core_gap at 2 N, where the manual's pressure begins to saturate"),
          number_spec("shear", Quantity::none, "0.5", positive_up_to(2.0), "Tangential stiffness over the normal one.",
                      "assumed: 0.25 to 1 did not matter in the dry run"),
          number_spec("near", Quantity::length, "3.5 mm", some_length, "l, width of the area that an electrode feels.",
                      "fitted: 3 to 4 mm; 1.5 and 5 are wrong"),
          number_spec("far", Quantity::length, "9 mm", some_length, "L, reach of the tail.", "fitted; 12 is worse"),
          number_spec("far_share", Quantity::none, "0.5", fraction, "a, share of the tail.", "fitted; 0 and 0.6 are worse"),
          number_spec("swell", Quantity::none, "0.35", non_negative, "B, lift of the skin elsewhere by the displaced fluid.",
                      "fitted: 0.3 to 0.5; with 0 and 1 the correlations of far electrodes are wrong"),
          number_spec("stretch", Quantity::none, "0.3", non_negative, "S, sensitivity to the drag of a dent along the surface.",
                      "assumed: 0 to 0.7 fit equally well; it must stay small"),
          number_spec("gap", Quantity::length, "0.52 mm", some_length, "g, dent that multiplies an electrode's impedance by e.",
                      "fitted: 0.5 to 0.6 mm"),
          number_spec("common", Quantity::none, "0.1", non_negative, "Zc, impedance in series with all electrodes, in kOhm.",
                      "fitted: 0.1; one session of the recordings has 0.7 of unknown cause"),
          number_spec("core_gap", Quantity::length, "1 mm", some_length, "Depth from which on the skin rests on the core.",
                      "assumed: core to skin is 2.0 to 2.6 mm (bsadr/biotac); the skin itself is about half of that"),
          number_spec("fluid_stiffness", Quantity::none, "0.56", positive,
                      "K, pressure per displaced volume of fluid, in kPa/mm3.",
                      "assumed: at 2 N and core_gap the pressure is the force over the area of contact, 23.5 kPa for 42 mm3"),
          number_spec("pdc_rest", Quantity::none, "2600", {0.0, 4095.0}, "Counts of pdc of an untouched finger.",
                      "legacy BioTac at rest: 2580 to 2695"),
          choice_spec(
              "device", "fixed", {"fixed", "redrawn"},
              "fixed: all trials of a dataset use one device; redrawn: each draws its own sensitivities (electronics: gain).",
              "fixed: one finger made all the recordings"),
          integer_spec("device_number", "0", {0.0, 1e6},
                       "Which of the dataset's devices this is: each number has sensitivities of its own. With device: fixed.",
                       "free"),
          number_spec("label_step", Quantity::length, "10 um", positive,
                      "Change of the bench's position between two rows from which on the paper's rule says slip.",
                      "assumed: 1 mm/s at 100 Hz; the paper labels by the commanded motion of the robot"),
      }};
}

std::vector<Entry> electronics_parts() {
  const std::string recordings = "44 public recordings of a touch (yayaneath/BioTacSP-DoS)";
  return electronics_of(
      "BioTac SP",
      {{"gain",
        "10 % on each electrode's `gap`, which stands in the exponent: assumed; this is how much the levels of electrodes differ",
        {}},
       {"offset",
        "on the logarithm of each electrode's impedance at rest, sd 0.02: assumed. A scale of 10 to 30 gives the hundreds of counts between fingers and sessions of public grasps (3dperceptionlab, bts3v2)",
        {}},
       {"drift", "1.5 counts/s, electrodes: " + recordings + ", median of the slope 1.7"},
       {"skewed_noise",
        "electrodes: 3.1 counts times the electrode's own noise over the mean of all, drawn at each reading: " + recordings},
       {"noise",
        "pac alone, 4.8 counts: a legacy BioTac at rest has 4.5 to 5.1. pdc has less than a count, no more than its rounding",
        {{"corner", "inf", "the legacy recording is nearly white from 2 to 1100 Hz, with no line of the mains"}}}});
}

}  // namespace biotac_sp
}  // namespace slipbench
