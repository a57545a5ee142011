#include "tools/dataset/checked_dataset.h"

#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"

namespace slipbench {

DatasetReader dataset_header_at(const std::string& path) {
  check_readable(FileKind::dataset_header, path);
  return DatasetReader(path);
}

DatasetReader checked_dataset(const std::string& path) {
  check_readable(FileKind::dataset, path);
  return DatasetReader(path);
}

DatasetReader whole_dataset(const std::string& path) {
  DatasetReader reader = checked_dataset(path);
  if (!reader.complete()) throw InputError(path + ": its run did not finish; expected a complete dataset");
  if (reader.trials().empty()) throw InputError(path + ": contains no trials");
  return reader;
}

void for_each_trial(const DatasetReader& reader, const std::function<void(const TrialRecord& record)>& use) {
  for (const std::size_t trial : reader.trials()) {
    reader.check_recorded(trial);
    use(reader.read_trial(trial));
  }
}

}  // namespace slipbench
