#pragma once
// Mistakes of users: a sound case with one thing wrong, and what is to be said of it, where.
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace silt::coupler::testing {

struct Mistake {
  std::string name;                // of the test: what is wrong
  std::string from, to;            // what of the sound case becomes what
  std::string at;                  // text on the line that is to be named; empty: `to`; or "the file"
  std::vector<std::string> parts;  // of the line that names it: what was found, what is allowed, what to do
};

/// Glass and plastic balls sink in oil: SI, every kind of section.
std::string sound_wet_case();
/// Balls fall into a drum; no fluid.
std::string sound_dry_case();

/// Expects that the case with the mistake is refused, or warned of, in one line of a diagnostic that begins
/// with file, line and column and has all the parts.
void expect_named(const std::string& sound, const Mistake&);

void PrintTo(const Mistake&, std::ostream*);

inline std::string name_of(const ::testing::TestParamInfo<Mistake>& info) {
  return info.param.name;
}

}  // namespace silt::coupler::testing
