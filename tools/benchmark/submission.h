// Submissions: boards as files, read back and compared with recomputed ones.
#pragma once

#include <string>

#include "tools/benchmark/benchmark.h"
#include "tools/dataset/record/json.h"

namespace slipbench::benchmark {

Json request_json(const BoardRequest& asked);
// The inverse. Throws InputError with `file` and the key.
BoardRequest parse_request(const Json& json, const std::string& file);

// Returns the bytes of a submission.
std::string submission_text(const Json& result);
// Throws InputError if the text is not a submission of a protocol of this program (name and
// digest). No trial is computed for this.
Json parse_submission(const std::string& text, const std::string& name);

// Returns the first difference between a submission and the recomputed board, such as
// "/sets/0/rows/2/credit: 0.41 in the file, 0.43 here"; empty if both are equal. Leaves out
// `machine`. Numbers that are not whole are equal within 1e-9, since MuJoCo, FFTW and networks round
// differently by processor; everything else must be identical.
std::string difference(const std::string& text, const Json& submitted, Json recomputed);

}  // namespace slipbench::benchmark
