#include "tools/dataset/finished_dataset.h"

#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"

namespace slipbench {

std::optional<FinishedDataset> finished_dataset(const std::string& path, const DatasetHeader& header) {
  try {
    const DatasetReader reader = dataset_header_at(path);
    if (!reader.complete() || !header_difference(reader.header(), header).empty()) return std::nullopt;
    return FinishedDataset{reader.trials().size(), reader.failed(), reader.files()};
  } catch (const NotChecked&) {
    throw;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace slipbench
