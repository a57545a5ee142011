// What every test expects with: GoogleTest, GoogleMock's matchers by their own names, the errors, and what a refused call is answered.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "sim/core/error.h"

namespace slipbench {

using ::testing::AllOf, ::testing::AnyOf, ::testing::Contains, ::testing::DoubleNear, ::testing::Each, ::testing::ElementsAre,
    ::testing::EndsWith, ::testing::HasSubstr, ::testing::IsEmpty, ::testing::Not, ::testing::Pair, ::testing::SizeIs,
    ::testing::StartsWith;

// The message of the Error that `call` throws, "accepted" where it throws none.
template <class Error = InputError, class Call>
std::string refusal_of(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

// Where the SceneValueError that `call` throws points, and its message: "path | message".
template <class Call>
std::string scene_refusal_of(Call&& call) {
  try {
    call();
  } catch (const SceneValueError& error) {
    return error.path() + " | " + error.what();
  }
  return "accepted";
}

}  // namespace slipbench
