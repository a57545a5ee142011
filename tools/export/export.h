// Datasets in the file formats that others read.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace slipbench {

enum class ExportFormat {
  vendor_csv,    // the log of the vendor's visualisation software
  training_csv,  // the 73 columns of the published training code
};

// When a pillar counts as slipping.
enum class SlipRule {
  strict,       // all of it slips
  micro,        // a part of it slips
  paper,        // its tip slides faster than `label_speed`, as a camera would see it
  has_slipped,  // from the first such sample on until it loses contact: "no pillar has slipped", as the paper words its classes
};

inline constexpr double default_label_speed = 1e-4;  // m/s

struct ExportOptions {
  ExportFormat format = ExportFormat::vendor_csv;
  SlipRule slip_rule = SlipRule::strict;
  std::optional<double> label_speed;  // m/s, only with paper and has_slipped; empty: default_label_speed
  std::string sensor;                 // training_csv: which; empty: the only PapillArray of the dataset
  std::optional<std::size_t> trial;   // empty: all
};

// The formats' and rules' names on the command line: "vendor-csv", "strict". The parsers throw InputError with the nearest name.
ExportFormat parse_export_format(const std::string& name);
SlipRule parse_slip_rule(const std::string& name);
std::vector<std::string> export_format_names();
std::vector<std::string> slip_rule_names();
std::string slip_rule_name(SlipRule rule);

// Writes the trials of a dataset to `out_dir`, which is made if it is missing (its parent is not), and returns the files written.
// Each file appears under its name only when it is whole. Throws InputError when the options contradict each other, the dataset
// is damaged or does not fit the format, or a file cannot be written; files that were finished before stay. Reads in a child
// process (tools/dataset/guarded.h).
std::vector<std::string> export_dataset(const std::string& dataset_path, const std::string& out_dir,
                                        const ExportOptions& options);

}  // namespace slipbench
