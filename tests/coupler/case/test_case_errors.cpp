// Bad input: every file of bad_cases/ is refused with exactly the messages its "# expect: " lines give, each
// the rest of a line after the file's name. Adding a file adds a test.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/coupler/case/case_text.hpp"

namespace silt::coupler::testing {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  return fs::path(SILT_SOURCE_DIR) / "tests/coupler/case/bad_cases";
}

std::vector<std::string> bad_cases() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder()))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string expected(const std::string& text) {
  const std::string mark = "# expect: ";
  std::istringstream lines(text);
  std::string all;
  for (std::string line; std::getline(lines, line) && line.starts_with(mark);) {
    if (!all.empty()) all += '\n';
    all.append("case.toml:").append(line, mark.size());
  }
  return all;
}

class BadCase : public ::testing::TestWithParam<std::string> {};

TEST_P(BadCase, GivesItsMessage) {
  const std::string text = file_text(folder() / (GetParam() + ".toml"));
  ASSERT_FALSE(expected(text).empty()) << "the file must begin with '# expect: ' lines";
  EXPECT_EQ(error_of([&] { require_runnable(read_case_text(text, "case.toml")); }), expected(text));
}

INSTANTIATE_TEST_SUITE_P(CaseErrors, BadCase, ::testing::ValuesIn(bad_cases()),
                         [](const auto& info) { return info.param; });

TEST(CaseErrors, ThereAreManyAndNoTwoAlike) {
  std::vector<std::string> messages;
  for (const std::string& name : bad_cases())
    messages.push_back(expected(file_text(folder() / (name + ".toml"))));
  EXPECT_GE(messages.size(), 50u);
  std::sort(messages.begin(), messages.end());
  EXPECT_EQ(std::adjacent_find(messages.begin(), messages.end()), messages.end());
}

TEST(CaseErrors, AMissingDirectoryNamesItsNeighbours) {
  const fs::path cases = fs::path(SILT_SOURCE_DIR) / "cases";
  const std::string text = error_of([&] { read_case(cases / "segregatoin"); });
  EXPECT_TRUE(text.starts_with((cases / "segregatoin/case.toml").string() + ": there is no such file"))
      << text;
  EXPECT_NE(text.find("did you mean 'segregation'?"), text.npos) << text;
}

TEST(CaseErrors, NearestNames) {
  const std::vector<std::string> names = {"density", "kinematic_viscosity", "relaxation_time", "magic"};
  EXPECT_EQ(nearest_name("denisty", names), "density");
  EXPECT_EQ(nearest_name("viscocity", names), "kinematic_viscosity");
  EXPECT_EQ(nearest_name("viscosity", names), "kinematic_viscosity");
  EXPECT_EQ(nearest_name("relaxationtime", names), "relaxation_time");
  EXPECT_EQ(nearest_name("colour", names), "");
}

TEST(CaseErrors, OverridesAreNamedInMessages) {
  const CaseText c;
  EXPECT_EQ(error_of([&] { c.read({"fluid.relaxation_time=0.4"}); }),
            "--set fluid.relaxation_time=0.4: fluid.relaxation_time is 0.4; it must be above 0.5, where the "
            "viscosity is 0");
  EXPECT_EQ(error_of([&] { c.read({"contacts.backend=bulet"}); }),
            "--set contacts.backend=bulet: contacts.backend is the string \"bulet\"; it must be one of auto, "
            "analytic, "
            "bullet, fcl; did you mean 'bullet'?");
  EXPECT_EQ(error_of([&] { c.read({"fluid.density"}); }),
            "--set fluid.density: must have the form key.path=value, as in fluid.density=960");
  EXPECT_EQ(error_of([&] { c.read({"fluid.relaxation_time="}); }),
            "--set fluid.relaxation_time=: must have the form key.path=value, as in fluid.density=960");
  EXPECT_EQ(error_of([&] { c.read({"bodies[1].density=2"}); }),
            "--set bodies[1].density=2: there is no entry 1: the list has 1");
  EXPECT_EQ(
      error_of([&] { c.read({"bodies.density=2"}); }),
      "--set bodies.density=2: 'density' must be the number of an entry, from 0, as in bodies[0].density");
  EXPECT_EQ(error_of([&] { c.read({"run.steps.x=2"}); }),
            "--set run.steps.x=2: 'x' lies below a value that is an integer");
  EXPECT_NE(error_of([&] { c.read({"fluid.visc=0.1"}); }).find("did you mean 'kinematic_viscosity'?"),
            std::string::npos);
  EXPECT_NE(error_of([&] { c.read({"domain.size=[1, 2"}); }).find("'[1, 2' is not a TOML value"),
            std::string::npos);
}

}  // namespace
}  // namespace silt::coupler::testing
