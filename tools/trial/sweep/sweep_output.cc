#include "tools/trial/sweep/sweep_output.h"

#include <chrono>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/finished_dataset.h"
#include "tools/trial/sweep/finished_trial.h"

namespace slipbench {
namespace {

// Keeps the finished trials of a failed run and returns a message with their folder; empty if there
// are none.
std::string keep_finished(SweepWriter& writer, std::size_t planned) {
  try {
    writer.keep();
  } catch (const InputError&) {
    // The disk may still be full. Batches finished earlier exist.
  }
  if (writer.finished() == 0) return "";
  return fmt::format("; {} contains {} of {}; continue by the same command with --resume", writer.folder(), writer.finished(),
                     counted(planned, "trial"));
}

// Summary of a trial that an earlier run finished. A dataset does not contain the outcome of each
// unit.
std::string summary_of_stored(const TrialRecord& record) {
  TrialResult result;
  result.record = record;
  result.units.resize(record.sensors.size());
  FinishedTrial finished;
  finished.summary = summary_of(result);
  finished.summary.resumed = true;
  return to_message(finished);
}

}  // namespace

SweepOutput::SweepOutput(const SweepOptions& options, const DatasetHeader& header)
    : options_(options),
      header_(header),
      writer_(options.output.empty() ? nullptr : std::make_unique<SweepWriter>(options.output, header, options.shard_limit)) {}

bool SweepOutput::open(SweepQueue& queue, SweepSummary& summary) {
  if (!writer_) return true;
  if (!options_.resume) {
    writer_->refuse_left();
    return true;
  }
  if (std::optional<FinishedDataset> whole = finished_dataset(options_.output, header_)) {
    writer_->drop_batches();  // left by a run that was killed after finishing its dataset
    summary.was_complete = true;
    summary.resumed = whole->trials;
    summary.failed = std::move(whole->failed);
    summary.files = std::move(whole->files);
    return false;
  }
  try {
    queue.resume(writer_->resume(&summary_of_stored));
  } catch (const Interrupted&) {
    throw Interrupted("all batches in " + writer_->folder() + " are kept");
  }
  summary.damaged = writer_->damaged();
  return true;
}

void SweepOutput::finish_due_batch(TrialWorkers& workers) {
  if (!writer_) return;
  const auto due = writer_->due();
  if (due && (std::chrono::steady_clock::now() >= *due || !workers.ready_until(*due))) writer_->finish_batch();
}

void SweepOutput::append(const FinishedTrial& trial) {
  if (writer_) writer_->append(*trial.encoded);
}

void SweepOutput::add_failed(const FailedTrial& failed) {
  if (writer_) writer_->add_failed(failed);
}

void SweepOutput::finish(bool whole, SweepSummary& summary) {
  if (!writer_) return;
  summary.files = whole ? writer_->commit() : writer_->keep();
  summary.kept = whole ? summary.trials.size() : writer_->finished();
}

void SweepOutput::fail(const std::exception& error, std::size_t planned) {
  if (!writer_) throw;
  const std::string left = keep_finished(*writer_, planned);
  if (dynamic_cast<const InputError*>(&error) != nullptr) throw InputError(error.what() + left);
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) throw InputError("out of memory" + left);
  throw std::runtime_error(error.what() + left);
}

}  // namespace slipbench
