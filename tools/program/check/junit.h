// What a check found, as continuous integration reads it.
#pragma once

#include <string>
#include <vector>

#include "tools/program/check/check.h"

namespace slipbench {

// JUnit XML as Jenkins and GitLab read it: a suite a scene, a case an expectation, one more for its negative control. What failed says why and
// with which command the trial is repeated; a scene that expects nothing has one case, skipped. No clock times: the same check, the
// same bytes.
std::string junit_xml(const std::vector<SceneCheck>& checks);

}  // namespace slipbench
