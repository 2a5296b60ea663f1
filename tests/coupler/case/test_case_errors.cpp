// Bad input: every file of bad_cases/ is refused with exactly the messages its "# expect: " lines give, each
// the rest of a line after the file's name. Adding a file adds a test. A list of names that grows is written
// {backends}, {broad phases}, {collision models}, {quantity types}, {shape types} or {keys of SECTION}.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "adapters/automatic/collision_factory.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/case/quantity_spec.hpp"
#include "tests/coupler/case/case_text.hpp"
#include "tests/errors.hpp"

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

std::string joined_views(const std::vector<std::string_view>& names) {
  return joined(std::vector<std::string>(names.begin(), names.end()));
}

std::string quantity_type_names() {
  std::vector<std::string> names;
  for (const QuantityType& type : quantity_types) names.emplace_back(type.name);
  return joined(names);
}

/// Returns what a key may be, by the message of the reader.
std::string choices(const std::string& text) {
  const std::string mark = "must be one of ", message = error_of([&] { read_case_text(text); });
  const auto begin = message.find(mark) + mark.size();
  return message.substr(begin, message.find('\n', begin) - begin);
}

/// Returns a text with the lists of names in the place of what stands for them in braces.
std::string filled_in(std::string text) {
  const std::string shape = "[[shapes]]\nname = \"a\"\ntype = \"?\"\n";
  std::map<std::string, std::string> lists = {{"{backends}", joined_views(adapters::backend_names())},
                                              {"{quantity types}", quantity_type_names()},
                                              {"{collision models}", joined(collision_names.list())},
                                              {"{shape types}", choices(shape)}};
  for (const KeySection& section : case_keys()) {
    std::vector<std::string> keys;
    for (const KeyText& key : section.keys) keys.push_back(key.name);
    lists["{keys of " + (section.path.empty() ? "the file" : section.path) + "}"] = joined(keys);
  }
  for (const auto& [name, entries] : lists)
    for (auto at = text.find(name); at != text.npos; at = text.find(name))
      text.replace(at, name.size(), entries);
  return text;
}

std::string expected(const std::string& text) {
  const std::string mark = "# expect: ";
  std::istringstream lines(text);
  std::string all;
  for (std::string line; std::getline(lines, line) && line.starts_with(mark);) {
    if (!all.empty()) all += '\n';
    all.append("case.toml:").append(line, mark.size());
  }
  return filled_in(all);
}

/// Returns what is wrong with a case that has the other files of the folder beside it.
std::string fault_of_text(const std::string& text) {
  CaseSource source{"case.toml", text, {}};
  for (const auto& entry : fs::directory_iterator(folder()))
    if (const std::string name = entry.path().filename(); entry.path().extension() != ".toml")
      source.attached[name] = {file_text(entry.path()), name, 0};
  std::string found;
  const std::string unread = error_of([&] { found = fault_of(read_case(source)); });
  return unread + found;
}

class BadCase : public ::testing::TestWithParam<std::string> {};

TEST_P(BadCase, GivesItsMessage) {
  const std::string text = file_text(folder() / (GetParam() + ".toml"));
  ASSERT_FALSE(expected(text).empty()) << "the file must begin with '# expect: ' lines";
  EXPECT_EQ(fault_of_text(text), expected(text));
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
  EXPECT_TEXT(text, "did you mean 'segregation'?");
}

TEST(CaseErrors, NearestNames) {
  const std::vector<std::string> names = {"density", "kinematic_viscosity", "relaxation_time", "magic"};
  EXPECT_EQ(nearest_name("denisty", names), "density");
  EXPECT_EQ(nearest_name("viscocity", names), "kinematic_viscosity");
  EXPECT_EQ(nearest_name("viscosity", names), "kinematic_viscosity");
  EXPECT_EQ(nearest_name("relaxationtime", names), "relaxation_time");
  EXPECT_EQ(nearest_name("colour", names), "");
}

TEST(CaseErrors, SymbolsAreTheKeysThatTheyStandFor) {
  const CaseText c;
  const auto fluid = [&](const std::string& written) { return c.fault({"fluid." + written + "=0.8"}); };
  EXPECT_TEXT(fluid("tau"), "did you mean 'relaxation_time'?");
  EXPECT_TEXT(fluid("omega"), "did you mean 'relaxation_time' (1/omega)?");
  EXPECT_TEXT(fluid("nu"), "did you mean 'kinematic_viscosity'?");
  EXPECT_TEXT(fluid("mu"), "did you mean 'kinematic_viscosity' (mu/density)?");
  EXPECT_TEXT(c.fault({"contacts.e=0.5"}), "did you mean 'restitution'?");
  EXPECT_TEXT(c.fault({"contacts.restitution_coefficient=0.5"}), "did you mean 'restitution'?");
  EXPECT_TEXT(c.fault({"contacts.mu=0.5"}), "did you mean 'friction'?");
  EXPECT_TEXT(c.fault({"bodies[0].omega=[1, 0, 0]"}), "did you mean 'angular_velocity'?");
  EXPECT_TEXT(c.fault({"gravity=[0, 0, -1e-4]"}),
              "gravity is [0, 0, -1e-04]; it must be a table: write gravity.acceleration = [0, 0, -1e-04]");
}

TEST(CaseErrors, OverridesAreNamedInMessages) {
  const CaseText c;
  EXPECT_EQ(c.fault({"fluid.relaxation_time=0.4"}),
            "--set fluid.relaxation_time=0.4: fluid.relaxation_time is 0.4; it must be above 0.5, where the "
            "viscosity is 0");
  EXPECT_EQ(c.fault({"contacts.backend=bulet"}),
            "--set contacts.backend=bulet: contacts.backend is the string \"bulet\"; it must be one of " +
                joined_views(adapters::backend_names()) + "; did you mean 'bullet'?");
  EXPECT_EQ(c.fault({"fluid.density"}),
            "--set fluid.density: must have the form key.path=value, as in fluid.density=960");
  EXPECT_EQ(c.fault({"=1"}), "--set =1: must have the form key.path=value, as in fluid.density=960");
  EXPECT_EQ(c.fault({"bodies[1].density=2"}),
            "--set bodies[1].density=2: there is no entry 1: the list has 1");
  EXPECT_EQ(
      c.fault({"bodies.density=2"}),
      "--set bodies.density=2: 'density' must be the number of an entry, from 0, as in bodies[0].density");
  EXPECT_EQ(c.fault({"run.steps.x=2"}), "--set run.steps.x=2: 'x' lies below a value that is an integer");
  EXPECT_TEXT(c.fault({"fluid.visc=0.1"}), "did you mean 'kinematic_viscosity'?");
  EXPECT_TEXT(c.fault({"domain.size=[1, 2"}), "'[1, 2' is not a TOML value");
}

TEST(CaseErrors, WhatIsTakenAwayMustBeThere) {
  CaseText c;
  c.run += "balance = { every = 10 }\n";
  EXPECT_EQ(c.fault({"run.balance="}), "");
  EXPECT_EQ(c.read({"run.balance="}).balance_every, 0);
  EXPECT_EQ(c.read({"run.balance.every=20", "run.balance=", "run.balance.every=30"}).balance_every, 30);
  EXPECT_TRUE(c.read({"bodies[0]="}).bodies.empty());
  EXPECT_EQ(c.fault({"fluid.relaxation_time="}),
            "case.toml:6:2: [fluid] needs one of kinematic_viscosity, relaxation_time: how viscous the fluid "
            "is");
  EXPECT_EQ(
      c.fault({"run.balnce="}),
      "--unset run.balnce: the case has no such key: there is no 'balnce'; did you mean 'balance'? known: "
      "steps, balance");
  EXPECT_EQ(c.fault({"bodies[1]="}), "--unset bodies[1]: there is no entry 1: the list has 1");
  EXPECT_EQ(c.fault({"run.steps.x="}), "--unset run.steps.x: the case has no such key: there is no 'x'");
}

}  // namespace
}  // namespace silt::coupler::testing
