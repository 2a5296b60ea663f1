// Mistakes of users: what is said of each, in mistakes/mistakes.txt, and of those of the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include "adapters/automatic/collision_factory.hpp"
#include "silt/case/case_check.hpp"
#include "silt/case/case_file.hpp"
#include "silt/case/quantity_spec.hpp"
#include "tests/errors.hpp"
#include "tests/silt/case/case_text.hpp"

namespace silt::testing {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  return fs::path(SILT_SOURCE_DIR) / "tests/silt/case/mistakes";
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
                                              {"{collision models}", joined(coupler::collision_names.list())},
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

using Lines = std::vector<std::string>;

/// A mistake of mistakes/mistakes.txt: the lines of the scene, what changes, and what is to be said.
struct Mistake {
  std::string name;
  Lines scene, changes, said;
};

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Returns the parts of a text between marks.
Lines split(const std::string& text, const std::string& mark) {
  Lines parts;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find(mark, at), text.size());
    parts.push_back(text.substr(at, end - at));
    at = end + mark.size();
  }
  return parts;
}

/// Makes changes in the lines of a scene, in their order.
std::string changed(const Lines& scene, const Lines& changes) {
  Lines result;
  auto from = scene.begin();
  for (const std::string& change : changes) {
    const auto arrow = change.find(" =>");
    const Lines before = split(change.substr(0, arrow), " | ");
    const auto at = std::search(from, scene.end(), before.begin(), before.end());
    if (at == scene.end()) throw std::runtime_error("the scene has no lines '" + change + "'");
    result.insert(result.end(), from, at);
    for (const std::string& line : split(change.substr(std::min(arrow + 4, change.size())), " | "))
      if (line == "..")
        result.insert(result.end(), before.begin(), before.end());
      else
        result.push_back(line);
    from = at + std::ptrdiff_t(before.size());
  }
  result.insert(result.end(), from, scene.end());
  return joined(result, "\n") + "\n";
}

std::vector<Mistake> read_mistakes() {
  std::map<std::string, Lines> scenes;
  std::vector<Mistake> mistakes;
  std::string scene, sound;  // whose lines come, and whose mistakes
  for (const std::string& line : lines_of(file_text(folder() / "mistakes.txt"))) {
    const auto rest_after = [&](std::string_view word) {
      return line.starts_with(word) ? line.substr(word.size()) : "";
    };
    if (line.empty() || line[0] == '#')
      scene.clear();
    else if (!scene.empty())
      scenes[scene].push_back(line);
    else if (const std::string name = rest_after("scene "); !name.empty())
      scene = name;
    else if (const std::string of = rest_after("mistakes of "); !of.empty())
      sound = of;
    else if (const std::string of_one = rest_after("mistake "); !of_one.empty())
      mistakes.push_back({of_one, scenes.at(sound), {}, {}});
    else if (Lines& changes = mistakes.back().changes; line[0] != ' ')
      mistakes.back().said.push_back(line);
    else if (!changes.empty() && changes.back().ends_with(" |"))
      changes.back() += line.substr(3);
    else
      changes.push_back(line.substr(2));
  }
  return mistakes;
}

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.name;
}

/// Returns what is said of a case that has the other files of the folder beside it, a line each: of a case
/// that cannot be read, and of one that can its errors and warnings.
std::string said_of(const std::string& text, bool with_warnings) {
  CaseSource source{"case.toml", text, {}};
  for (const auto& entry : fs::directory_iterator(folder()))
    if (const std::string name = entry.path().filename(); entry.path().extension() != ".txt")
      source.attached[name] = {file_text(entry.path()), name, 0};
  std::string found;
  const std::string unread = error_of([&] {
    const Case setup = read_case(source);
    found = with_warnings ? silt::listed(judgement(setup)) : fault_of(setup);
  });
  return unread + found;
}

/// Says whether a line tells of a place and has all the parts that "~ LINE: PART … PART" asks for.
bool names(const std::string& said, const std::string& wanted) {
  const auto colon = wanted.find(": ");
  const std::string line = wanted.substr(2, colon - 2);
  if (!said.starts_with(line == "0" ? "case.toml: " : "case.toml:" + line + ":")) return false;
  return std::ranges::all_of(split(wanted.substr(colon + 2), " … "),
                             [&](const std::string& part) { return bool(tests::has_part(said, part)); });
}

class Mistakes : public ::testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, AreNamed) {
  const Mistake& mistake = GetParam();
  const std::string text = changed(mistake.scene, mistake.changes);
  ASSERT_FALSE(mistake.said.empty());
  if (mistake.said[0][0] == '=') {
    Lines expected;
    for (const std::string& line : mistake.said) expected.push_back("case.toml:" + line.substr(2));
    EXPECT_EQ(said_of(text, false), filled_in(joined(expected, "\n")));
    return;
  }
  const std::string said = said_of(text, true);
  const Lines lines = lines_of(said);
  for (const std::string& wanted : mistake.said)
    EXPECT_TRUE(std::ranges::any_of(lines, [&](const std::string& line) { return names(line, wanted); }))
        << wanted << "\nis not said, but:\n"
        << said;
}

INSTANTIATE_TEST_SUITE_P(OfUsers, Mistakes, ::testing::ValuesIn(read_mistakes()),
                         [](const auto& info) { return info.param.name; });

TEST(CaseErrors, MistakesAreManyAndNoTwoAlikeInSoundScenes) {
  std::vector<Lines> said;
  std::set<Lines> scenes;
  for (const Mistake& mistake : read_mistakes()) {
    said.push_back(mistake.said);
    scenes.insert(mistake.scene);
  }
  EXPECT_GE(said.size(), 200u);
  std::sort(said.begin(), said.end());
  EXPECT_EQ(std::adjacent_find(said.begin(), said.end()), said.end());
  for (const Lines& scene : scenes) EXPECT_EQ(said_of(changed(scene, {}), false), "");
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
  EXPECT_TEXT(fluid("mu"), "did you mean 'dynamic_viscosity'?");
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
  EXPECT_TEXT(c.fault({"fluid.relaxation_time=0,7"}), "'0,7' is not a TOML value, such as 0.7");
}

TEST(CaseErrors, WhatIsTakenAwayMustBeThere) {
  CaseText c;
  c.run += "balance = { every = 10 }\n";
  EXPECT_EQ(c.fault({"run.balance="}), "");
  EXPECT_EQ(c.read({"run.balance="}).balance_every, 0);
  EXPECT_EQ(c.read({"run.balance.every=20", "run.balance=", "run.balance.every=30"}).balance_every, 30);
  EXPECT_TRUE(c.read({"bodies[0]="}).bodies.empty());
  EXPECT_EQ(c.fault({"fluid.relaxation_time="}),
            "case.toml:6:2: [fluid] needs one of kinematic_viscosity, dynamic_viscosity, relaxation_time: "
            "the viscosity of the fluid");
  EXPECT_EQ(c.fault({"run.balnce="}),
            "--unset run.balnce: the case has no such key: there is no 'balnce'; did you mean 'balance'? "
            "known: steps, balance");
  EXPECT_EQ(c.fault({"bodies[1]="}), "--unset bodies[1]: there is no entry 1: the list has 1");
  EXPECT_EQ(c.fault({"run.steps.x="}), "--unset run.steps.x: the case has no such key: there is no 'x'");
}

}  // namespace
}  // namespace silt::testing
