#pragma once
// The texts of errors.
#include <gtest/gtest.h>

#include <exception>
#include <string>
#include <string_view>

namespace silt::tests {

/// Returns the text of the Error that f() throws, or "".
template <class Error = std::exception, class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

inline ::testing::AssertionResult has_part(std::string_view whole, std::string_view part) {
  if (whole.find(part) != whole.npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "no \"" << part << "\" in: " << whole << '\n';
}

#define EXPECT_TEXT(whole, part) EXPECT_TRUE(::silt::tests::has_part(whole, part))

}  // namespace silt::tests
