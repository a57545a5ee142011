#include "tools/report/report.h"

#include <filesystem>
#include <limits>

#include "tests/expect.h"
#include "tests/tools/report/sample.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/writer.h"
#include "tools/report/report_grasp.h"
#include "tools/report/report_summary.h"
#include "tools/report/report_trial.h"

namespace slipbench::report {
namespace {

const char* const scene = "slipbench: 1\ndescription: 'A <press> and \"slide\"'\n";

// A scene with a grasp, for its parameters.
const char* const grasp_scene =
    "slipbench: 1\nsurface: {material: felt}\nbox: {mass: 0.5 kg}\ngrip: {protocol: as_printed}\nmotion: {kind: lift}\n";

std::string page_path(const std::string& name) { return (std::filesystem::path(::testing::TempDir()) / name).string(); }

// The data inside a page.
Json data_of(const std::string& path) {
  const std::string page = bytes_of(path);
  const std::string mark = "id=\"slipbench-data\">";
  const std::size_t begin = page.find(mark) + mark.size();
  const auto element = [&](std::size_t from) { return Json::parse(page.substr(from, page.find("</script>", from) - from)); };
  Json data = element(begin);
  // Including the recordings, which follow the scripts, by trial.
  data["curves"] = Json::object();
  for (const Json& trial : data.at("recorded")) {
    const std::string name = trial.dump(), id = "id=\"recording-" + name + "\">";
    const Json recording = element(page.find(id) + id.size());
    data["curves"][name] = recording.at("sensors");
    if (!recording.at("grasp").is_null()) data["by_grasp"][name] = recording.at("grasp");
  }
  return data;
}

// The data of the page of a dataset of these trials.
Json reported(const std::string& name, const std::string& text, const std::vector<TrialRecord>& records) {
  write_report(write_dataset(name + ".h5", text, records), page_path(name + ".html"));
  return data_of(page_path(name + ".html"));
}

std::vector<TrialRecord> trials(std::size_t count) {
  std::vector<TrialRecord> records;
  for (std::size_t k = 0; k < count; ++k) {
    records.push_back(sample_trial(k, R"({"motion.speed": ")" + std::to_string(k + 1) + R"( mm/s"})"));
  }
  return records;
}

std::vector<std::string> embedded(const Json& data) {
  std::vector<std::string> names;
  for (const auto& [name, curves] : data.at("curves").items()) names.push_back(name);
  return names;
}

std::string refusal(const std::string& dataset, const std::string& page, const ReportOptions& options = {}) {
  return refusal_of([&] { write_report(dataset, page, options); });
}

// About the scene in the file, and converters at the end of their range in most of all samples.
TEST(Report, SaysWhatTheSceneWarnsOf) {
  std::vector<TrialRecord> records = trials(2);
  for (TrialRecord& record : records) {
    record.outcome.saturated = {{"pad", 5}};  // of 8
    record.params = "{}";
  }
  const std::string text = "slipbench: 1\nsensors: {pad: {type: papillarray}}\nmotion: {start: 9 s}\nsweep: {trials: 2}\n";
  const Json warnings = reported("report_warnings", text, records).at("warnings");
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings.at(0).at("text").get<std::string>(), HasSubstr("scene:3: motion.start: 9 s is not before the end"));
  EXPECT_EQ(warnings.at(1).at("about"), "sensors.pad.electronics");
  EXPECT_THAT(warnings.at(1).at("text").get<std::string>(), HasSubstr("in 10 of 16 samples"));
}

TEST(Report, SaysWhereTheDataComesFrom) {
  const std::string dataset = write_dataset("report_origin.h5", scene, trials(1));
  write_report(dataset, page_path("report_origin.html"));
  const Json data = data_of(page_path("report_origin.html"));
  EXPECT_EQ(data.at("file"), "report_origin.h5");
  EXPECT_EQ(data.at("description"), "A <press> and \"slide\"");
  EXPECT_EQ(data.at("scene"), scene);
  EXPECT_EQ(data.at("command"), "slipbench run scene.yaml");
  EXPECT_EQ(data.at("version"), "0.1.0");
  EXPECT_EQ(data.at("seed"), "7");
  EXPECT_EQ(data.at("content_sha256").at(0).get<std::string>().size(), 64U);
  EXPECT_TRUE(data.at("complete").get<bool>());
  EXPECT_TRUE(data.at("open").is_null());
}

TEST(Report, HoldsEverySampleOfATrial) {
  const TrialRecord trial = sample_trial(0, "{}");
  const LabelRecord& labels = trial.sensors[0].labels;
  const Json data = reported("report_trial", scene, {trial});
  const Json& pad = data.at("curves").at("0").at(0);
  EXPECT_EQ(pad.at("name"), "pad");
  EXPECT_EQ(pad.at("type"), "papillarray");
  EXPECT_EQ(pad.at("positions"), Json::parse("[[0.007, 0.0], [-0.007, 0.0]]"));
  EXPECT_EQ(pad.at("touch_s"), Json::parse("[0.0005, 0.0015]"));
  EXPECT_EQ(pad.at("micro_onset_s"), Json::parse("[0.00225, 0.0045]"));
  EXPECT_EQ(pad.at("onset_s"), Json::parse("[0.0035, 0.00575]"));
  EXPECT_EQ(pad.at("stride"), 1);
  EXPECT_THAT(unpack(pad.at("time"))[0], ::testing::Pointwise(DoubleNear(1e-9), trial.sensors[0].time));

  const auto states = unpack(pad.at("states").at("unit"));
  EXPECT_THAT(states[0], ElementsAre(0, 1, 1, 3, 2, 2, 2, 2));
  EXPECT_THAT(states[1], ElementsAre(0, 0, 1, 1, 1, 3, 2, 2));
  EXPECT_THAT(unpack(pad.at("states").at("strict"))[0], ElementsAre(0, 1, 1, 1, 2, 2, 3, 3));
  EXPECT_THAT(unpack(pad.at("states").at("micro"))[0], ElementsAre(0, 1, 1, 2, 2, 3, 3, 3));
  EXPECT_THAT(unpack(pad.at("states").at("paper"))[0], ElementsAre(0, 1, 1, 1, 1, 2, 3, 3));

  std::vector<std::string> keys;
  for (const Json& curve : pad.at("curves")) {
    keys.push_back(curve.at("origin").get<std::string>() + "/" + curve.at("key").get<std::string>());
    EXPECT_EQ(curve.at("data").at("rows"), 8);
  }
  EXPECT_THAT(keys, ElementsAre("labels/force", "labels/slip_velocity", "labels/slip_distance", "labels/margin",
                                "labels/stuck_fraction", "labels/slip_direction", "labels/slip_angle", "labels/slip_centre",
                                "sensor/force", "sensor/displacement"));
  const Json& force = pad.at("curves").at(8);
  EXPECT_EQ(force.at("components"), Json::parse(R"(["FX", "FY", "FZ"])"));
  EXPECT_EQ(force.at("unit"), "N");
  const auto columns = unpack(force.at("data"));
  for (std::size_t row = 0; row < 8; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      // The largest magnitude is 1.25 N (sample 0, component 5), so a step is 1.25/32767 N.
      EXPECT_NEAR(columns[column][row], labels.force[6 * row + column], 0.5 * 1.25 / 32767.0 + 1e-12);
    }
  }
}

// The page takes the units' names from the sensor's entry; a type outside the catalogue has
// "units".
TEST(Report, SaysHowItsSensorsAreShown) {
  TrialRecord trial = sample_trial(0, "{}");
  SensorRecord other = trial.sensors[0];
  other.name = "zother";
  other.type = "of_a_later_version";
  trial.sensors.push_back(other);
  const Json types = reported("report_types", scene, {trial}).at("sensor_types");
  ASSERT_EQ(types.size(), 2U);
  EXPECT_EQ(types.at("papillarray").at("units"), "pillars");
  EXPECT_EQ(types.at("papillarray").at("channels").at("force").at("name"), "Force");
  EXPECT_TRUE(types.at("papillarray").at("picture").is_null());
  EXPECT_EQ(types.at("of_a_later_version").at("units"), "units");
}

// A channel with one value per unit has a cell on each unit, one with four values around each unit.
TEST(Report, HoldsThePictureOfAPad) {
  const Json taxels = view_payload("myrmex").at("picture");
  EXPECT_EQ(taxels.at("channel"), "taxels");
  EXPECT_TRUE(taxels.at("cells").empty());
  EXPECT_EQ(taxels.at("rest"), 4095.0);
  const Json electrodes = view_payload("nib_pad").at("picture");
  EXPECT_EQ(electrodes.at("cells").size(), 9U);
  EXPECT_EQ(electrodes.at("cells").at(4), Json::parse("[14, 15, 20, 21]"));
  EXPECT_TRUE(electrodes.at("rest").is_null());
}

// The file is written as by versions before `detection`: the early alarm loses its delay when it is
// read.
TEST(Report, HoldsWhatTheLoopSaw) {
  TrialRecord trial = sample_trial(0, "{}");
  trial.control.emplace();
  trial.control->detector = "ratio";
  trial.control->sensor = "pad";
  trial.control->time = trial.sensors[0].time;
  trial.control->detector_class = {0, 0, 1, 2, 1, 2, 3, 2};
  trial.outcome.false_alarm_time = 3e-3;
  trial.outcome.detection_time = 5e-3;
  trial.outcome.detection_delay = 1.5e-3;
  SensorRecord other = trial.sensors[0];
  other.name = "zother";
  trial.sensors.push_back(other);
  const Json data = reported("report_seen", scene, {trial, sample_trial(1, "{}")});
  const Json& curves = data.at("curves").at("0");
  EXPECT_THAT(unpack(curves.at(0).at("states").at("seen"))[0], ElementsAre(0, 0, 1, 2, 1, 2, 3, 2));
  EXPECT_FALSE(curves.at(1).at("states").contains("seen")) << "the detector reads the other sensor";
  const Json& detector = data.at("trials").at(0).at("detector");
  EXPECT_EQ(detector.at("type"), "ratio");
  EXPECT_EQ(detector.at("sensor"), "pad");
  // Truth 0 1 1 1 2 2 3 3 against the classes above.
  EXPECT_EQ(detector.at("confusion"), Json::parse("[[1,0,0,0],[1,1,1,0],[0,1,1,0],[0,0,1,1]]"));
  EXPECT_EQ(detector.at("detection_s"), 5e-3);
  EXPECT_EQ(detector.at("detection"), "early");
  EXPECT_TRUE(detector.at("delay_s").is_null());
  EXPECT_EQ(detector.at("false_alarm_s"), 3e-3);
  EXPECT_FALSE(data.at("trials").at(1).contains("detector"));
}

TEST(Report, HoldsAGrasp) {
  const Json data = reported("report_grasp", grasp_scene, {sample_grasp(0)});
  EXPECT_EQ(data.at("trials").at(0).at("grasp").at("ideal_force_N"), 2.0);
  EXPECT_EQ(data.at("by_grasp").at("0").at("lift_s"), 3e-3);
  EXPECT_THAT(bytes_of(page_path("report_grasp.html")), HasSubstr("class GraspView"));
}

// The page has every trial of a grasp, but only 6 of other datasets.
TEST(Report, HoldsEveryGraspOfASet) {
  std::vector<TrialRecord> records;
  for (std::size_t k = 0; k < 9; ++k) records.push_back(sample_grasp(k));
  const Json data = reported("report_grasps", grasp_scene, records);
  EXPECT_EQ(embedded(data).size(), 9U);
  EXPECT_EQ(data.at("by_grasp").size(), 9U);
  EXPECT_FALSE(data.at("grasp_parameters").empty());
}

// A dataset without a grasp has no code to draw one in its page.
TEST(Report, PaysNothingForAGraspThatIsNotThere) {
  const Json data = reported("report_no_grasp", scene, trials(1));
  EXPECT_FALSE(data.contains("grasps"));
  EXPECT_FALSE(data.at("trials").at(0).contains("grasp"));
  EXPECT_THAT(bytes_of(page_path("report_no_grasp.html")), Not(HasSubstr("class GraspView")));
}

// A soft skin has the inputs of its closed form (a sphere's radius), and the page has the code to
// draw it. Other pages do not.
TEST(Report, SaysWhatASoftSkinTouches) {
  const std::string skin =
      "slipbench: 1\nsensors: {pad: {type: taxels}}\nfriction: {static: 0.6, kinetic: 0.5}\neffects: [elastic_skin: {shear_modulus: 1 MPa}]\n";
  const Json flat = reported("report_flat_skin", skin, trials(1)).at("skins").at("0");
  EXPECT_EQ(flat, Json({{"sensors", {"pad"}}, {"shear_modulus", 1e6}, {"friction", 0.6}, {"sphere_radius", nullptr}}));
  const Json sphere = reported("report_skin", skin + "surface: {shape: sphere, radius: 30 mm}\n", trials(1)).at("skins").at("0");
  EXPECT_EQ(sphere.at("sphere_radius"), 0.03);
  EXPECT_THAT(bytes_of(page_path("report_skin.html")), HasSubstr("skinSection = "));
  EXPECT_FALSE(reported("report_no_skin", scene, trials(1)).contains("skins"));
  EXPECT_THAT(bytes_of(page_path("report_no_skin.html")), Not(HasSubstr("skinSection = ")));
}

TEST(Report, ListsEveryTrialOfADataset) {
  const Json data = reported("report_sweep", scene, trials(11));
  ASSERT_EQ(data.at("trials").size(), 11U);
  EXPECT_EQ(data.at("trials").at(10).at("index"), 10);
  EXPECT_EQ(data.at("trials").at(10).at("samples"), 8);
  EXPECT_NEAR(data.at("trials").at(10).at("params").at("motion.speed").at("value").get<double>(), 0.011, 1e-15);
  EXPECT_EQ(data.at("trials").at(10).at("motion_start_s"), 2e-3);
  EXPECT_EQ(data.at("trials").at(10).at("sensors").at("pad").at("gross_s"), 5.75e-3);
  EXPECT_EQ(data.at("axes").at(0).at("path"), "motion.speed");
  EXPECT_TRUE(data.at("axes").at(0).at("varied").get<bool>());
  EXPECT_EQ(embedded(data).size(), 11U);
}

TEST(Report, SaysWhoseConverterWasAtItsEnd) {
  TrialRecord cut = sample_trial(1, "{}");
  cut.outcome.saturated = {{"pad", 3}};
  const Json rows = reported("report_saturated", scene, {sample_trial(0, "{}"), cut}).at("trials");
  EXPECT_FALSE(rows.at(0).contains("saturated"));
  EXPECT_EQ(rows.at(1).at("saturated"), Json::parse(R"({"pad": 3})"));
}

TEST(Report, SaysHowGraspsEnded) {
  TrialRecord held = sample_grasp(0);
  held.params = R"({"detector.type": "truth", "detector.ratio": null})";
  held.outcome.grasp = GraspOutcome{
      .slip_translation = 1e-3, .slip_rotation = 0.25, .max_grip_force = 6.0, .final_grip_force = 5.0, .ideal_grip_force = 4.0};
  held.control->detector = "";
  held.control->controller = "hold_preset";
  TrialRecord dropped = sample_grasp(1);
  dropped.params = R"({"detector.type": "force_ratio", "detector.ratio": 0.3})";
  dropped.outcome.grasp = GraspOutcome{.dropped = true, .drop_time = 3e-3};
  const Json rows = reported("report_grasps", scene, {held, dropped}).at("trials");
  EXPECT_EQ(rows.at(0).at("grasp"),
            Json::parse(
                R"({"dropped": false, "not_lifted": false, "lift_m": null, "drop_s": null, "slip_m": 0.001, "rotation_rad": 0.25,
    "max_force_N": 6.0, "final_force_N": 5.0, "ideal_force_N": 4.0, "reaction_s": null})"));
  EXPECT_EQ(rows.at(0).at("controller"), "hold_preset");
  EXPECT_FALSE(rows.at(0).contains("detector")) << "the scene has none";
  EXPECT_FALSE(rows.at(0).at("params").contains("detector.ratio")) << "the oracle has no ratio";
  EXPECT_TRUE(rows.at(1).at("grasp").at("dropped").get<bool>());
  EXPECT_TRUE(rows.at(1).at("grasp").at("slip_m").is_null());
  EXPECT_EQ(rows.at(1).at("params").at("detector.ratio").at("value"), 0.3);
}

TEST(Report, IsMadeOfOutcomesAlone) {
  TrialRecord trial = sample_trial(0, "{}");
  trial.sensors.clear();
  trial.bodies.clear();
  trial.body_time.clear();
  trial.outcome.grasp.emplace();
  trial.control.emplace();
  trial.control->detector = "ratio";
  trial.control->sensor = "pad";
  trial.control->confusion = {{{5, 1, 0, 0}, {0, 4, 2, 0}, {0, 0, 3, 0}, {0, 1, 0, 7}}};
  const std::string dataset = write_dataset("report_outcomes.h5", scene, {trial});
  write_report(dataset, page_path("report_outcomes.html"));
  const Json data = data_of(page_path("report_outcomes.html"));
  EXPECT_TRUE(data.at("curves").empty());
  const Json& row = data.at("trials").at(0);
  EXPECT_EQ(row.at("samples"), 0);
  EXPECT_TRUE(row.at("sensors").empty());
  EXPECT_EQ(row.at("detector").at("confusion"), Json::parse("[[5,1,0,0],[0,4,2,0],[0,0,3,0],[0,1,0,7]]"));
  EXPECT_THAT(refusal(dataset, page_path("report_outcomes.html"), {.trial = 0}),
              mentions({"/data/demo_0", "recording", "--record outcome"}));
}

TEST(Report, EmbedsTheTrialAskedFor) {
  const std::string dataset = write_dataset("report_ask.h5", scene, trials(11));
  write_report(dataset, page_path("report_ask.html"), {.trial = 7, .max_trials = 3});
  const Json data = data_of(page_path("report_ask.html"));
  EXPECT_EQ(data.at("open"), 7);
  EXPECT_THAT(embedded(data), ElementsAre("0", "7", "10"));  // 7 in place of 5, the one nearest to 0, 5 and 10
}

TEST(Report, OfManyTrialsShowsSomeAndSaysSo) {
  const std::string dataset = write_dataset("report_many.h5", scene, trials(11));
  write_report(dataset, page_path("report_many.html"), {.trial = {}, .max_trials = 2, .max_rows = 4});
  const Json data = data_of(page_path("report_many.html"));
  std::vector<int> shown;
  for (const Json& row : data.at("trials")) shown.push_back(row.at("index").get<int>());
  EXPECT_THAT(shown, ElementsAre(0, 2, 5, 8, 10));  // every 11/4th, plus 0 and 10, which have curves
  EXPECT_THAT(data.at("warnings").dump(), HasSubstr("this page uses 5 of the 11 trials of the dataset"));
  write_report(dataset, page_path("report_many.html"), {.trial = {}, .max_trials = 2, .max_rows = 11});
  EXPECT_EQ(data_of(page_path("report_many.html")).at("trials").size(), 11U);
  EXPECT_THAT(data_of(page_path("report_many.html")).at("warnings").dump(), Not(HasSubstr("this page")));
}

TEST(Report, SameDatasetGivesSameBytes) {
  const std::string dataset = write_dataset("report_same.h5", scene, trials(3));
  write_report(dataset, page_path("report_same_1.html"));
  write_report(dataset, page_path("report_same_2.html"));
  EXPECT_EQ(bytes_of(page_path("report_same_1.html")), bytes_of(page_path("report_same_2.html")));
}

TEST(Report, RefusesATrialThatIsNotThere) {
  const std::string dataset = write_dataset("report_none.h5", scene, trials(3));
  EXPECT_THAT(refusal(dataset, page_path("report_none.html"), {.trial = 3}), mentions({"trial 3", "0", "2"}));
  EXPECT_FALSE(std::filesystem::exists(page_path("report_none.html")));
}

TEST(Report, RefusesWhatIsNoDataset) {
  EXPECT_THAT(refusal(page_path("absent.h5"), page_path("x.html")), HasSubstr("absent.h5"));
  write_text(page_path("text.h5"), "not HDF5");
  EXPECT_THAT(refusal(page_path("text.h5"), page_path("x.html")), HasSubstr("text.h5"));
  const std::string whole = bytes_of(write_dataset("report_whole.h5", scene, trials(2)));
  write_text(page_path("cut.h5"), whole.substr(0, whole.size() / 2));
  EXPECT_THAT(refusal(page_path("cut.h5"), page_path("x.html")), HasSubstr("cut.h5"));
  EXPECT_FALSE(std::filesystem::exists(page_path("x.html")));
}

TEST(Report, RefusesBrokenContent) {
  TrialRecord broken = sample_trial(0, "{}");
  broken.sensors[0].labels.unit_state[2] = 7;
  EXPECT_THAT(refusal(write_dataset("report_state.h5", scene, {broken}), page_path("x.html")),
              mentions({"/data/demo_0", "labels/pad", "state 7", "3"}));
  EXPECT_THAT(refusal(write_dataset("report_params.h5", scene, {sample_trial(0, "speed 4")}), page_path("x.html")),
              mentions({"params", "JSON"}));
  const std::string file = write_dataset("report_outcome.h5", scene, trials(1));
  std::string bytes = bytes_of(file);
  bytes.replace(bytes.find("{\"dropped"), 1, "[");
  write_text(file, bytes);
  EXPECT_THAT(refusal(file, page_path("x.html")), mentions({file, "/data/demo_0", "damaged"}));
  EXPECT_THAT(refusal(write_dataset("report_scene.h5", "a: [b", trials(1)), page_path("x.html")), mentions({"attribute scene"}));
}

TEST(Report, RefusesATimeThatIsNotFinite) {
  TrialRecord broken = sample_trial(0, "{}");
  broken.sensors[0].time[3] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal(write_dataset("report_time.h5", scene, {broken}), page_path("x.html")),
              mentions({"report_time.h5", "/data/demo_0", "sensors/pad", "time"}));
}

TEST(Report, RefusesATargetThatCannotBeWritten) {
  const std::string dataset = write_dataset("report_target.h5", scene, trials(1));
  EXPECT_THAT(refusal(dataset, page_path("no_such_folder/x.html")),
              mentions({page_path("no_such_folder/x.html"), "folder " + page_path("no_such_folder")}));
}

TEST(Report, NeverReplacesADataset) {
  const std::string dataset = write_dataset("report_input.h5", scene, trials(1));
  const std::string before = bytes_of(dataset);
  EXPECT_THAT(refusal(dataset, dataset), mentions({"input"}));
  EXPECT_THAT(refusal(dataset, page_path("./report_input.h5")), mentions({"input"}));
  const std::string other = write_dataset("report_other.h5", scene, trials(1));
  EXPECT_THAT(refusal(dataset, other), mentions({"report_other.h5", "report"}));
  EXPECT_EQ(bytes_of(dataset), before);
  EXPECT_EQ(bytes_of(other), before);  // the same trials give the same bytes
  // The page's temporary name equals that of a killed run's dataset.
  const std::string killed = page_path("report_killed.h5.partial");
  std::filesystem::copy_file(dataset, killed, std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(refusal(killed, page_path("report_killed.h5")), mentions({"report_killed.h5.partial", "input"}));
  EXPECT_EQ(bytes_of(killed), before);
}

TEST(Report, ReplacesReportsAndNothingElse) {
  const std::string dataset = write_dataset("report_kept.h5", scene, trials(1));
  for (const char* text : {"slipbench: 1\n", "<!DOCTYPE html>\n<html><head><title>mine</title></head></html>\n"}) {
    for (const char* name : {"report_kept.yaml", "report_kept.yaml.partial"}) {
      write_text(page_path(name), text);
      EXPECT_THAT(refusal(dataset, page_path("report_kept.yaml")),
                  mentions({page_path("report_kept.yaml"), page_path(name), "report"}));
      EXPECT_EQ(bytes_of(page_path(name)), text);
      std::filesystem::remove(page_path(name));
    }
  }
  write_report(dataset, page_path("report_kept.html"));
  std::filesystem::copy_file(page_path("report_kept.html"), page_path("report_kept.html.partial"));
  EXPECT_EQ(refusal(dataset, page_path("report_kept.html")), "accepted");
}

// The page shows what was written, or nothing.
TEST(Report, RefusesArraysOfAnotherDigest) {
  EncodedTrial changed = TrialEncoder().encode(sample_trial(0, "{}"));
  changed.digest[0] ^= 1U;
  DatasetWriter writer(page_path("report_changed.h5"), {"0.1.0", scene, "{}", 7, "slipbench run scene.yaml"});
  writer.append(changed);
  writer.commit();
  EXPECT_THAT(refusal(page_path("report_changed.h5"), page_path("x.html")), mentions({"report_changed.h5", "SHA-256"}));
}

// A damaged file gives a report or an error, never a signal.
TEST(Report, SurvivesDamagedDatasets) {
  const std::string whole = bytes_of(write_dataset("report_damage.h5", scene, trials(2)));
  const std::string damaged = page_path("report_damaged.h5");
  std::size_t refused = 0;
  for (std::size_t step = 0; step < 300; ++step) {
    std::string bytes = whole;
    // Two primes spread the changes over the file and the bits.
    bytes[(step * 7919) % whole.size()] ^= static_cast<char>(1 + (step * 31) % 255);
    write_text(damaged, bytes);
    refused += refusal(damaged, page_path("report_damaged.html")) == "accepted" ? 0 : 1;
  }
  EXPECT_GE(refused, 30U);
}

}  // namespace
}  // namespace slipbench::report
