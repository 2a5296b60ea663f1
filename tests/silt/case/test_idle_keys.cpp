// Keys that other keys switch off: each key of the table of keys is given beside every other one, and what a
// run then does is compared with what it does without. A key that changes nothing is refused or told of;
// nothing is said to have no effect that has one.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "silt/case/case_file.hpp"
#include "silt/guard.hpp"
#include "silt/simulation.hpp"
#include "tests/silt/case/key_scenes.hpp"

namespace silt::testing {
namespace {

/// What a run of a case comes to.
struct Outcome {
  bool refused = false;
  std::vector<std::string> said;
  std::string result;
};

Outcome outcome_of(const std::string& text, const Files& files, const Overrides& overrides) {
  Outcome outcome;
  std::unique_ptr<Simulation> simulation;
  try {
    CaseSource source{"case.toml", text, {}};
    for (const auto& [name, bytes] : files) source.attached[name] = {bytes, name, {}};
    Case setup = read_case(source, overrides);
    for (const Diagnostic& found : judgement(setup)) {
      outcome.refused |= found.severity == Diagnostic::Severity::error;
      outcome.said.push_back(found.text);
    }
    if (outcome.refused) return outcome;
    simulation = std::make_unique<Simulation>(std::move(setup), MPI_COMM_SELF);
    simulation->start_quietly();
    for (const double value : values_of(*simulation)) outcome.result += fmt::format("{} ", value);
  } catch (const CaseError& error) {
    outcome.refused = true;
    outcome.said = {error.what()};
  } catch (const GuardStop& stop) {
    outcome.result = stop.what();
  }
  if (simulation) outcome.result += fmt::format("{:x}", simulation->hash());
  return outcome;
}

/// A scene's outcomes, each found once.
class Runs {
 public:
  explicit Runs(const SceneOfKeys& scene) : scene_(scene) {}
  const Outcome& of(const Overrides& overrides) {
    const std::string key = joined(overrides, "\n");
    const auto found = known_.find(key);
    return found != known_.end()
               ? found->second
               : known_.emplace(key, outcome_of(scene_.text, scene_.files, overrides)).first->second;
  }

 private:
  const SceneOfKeys& scene_;
  std::map<std::string, Outcome> known_;
};

/// Says whether a text tells that a key, or a table that it is in, has no effect.
bool says_idle(const std::string& said, const std::string& key) {
  const auto end = said.find(" has no effect: ");
  return end != said.npos && key.starts_with(said.substr(0, end));
}

/// A run without a key, and with it.
struct Comparison {
  const Outcome &without, &with;
  bool can_be() const { return !without.refused && !with.refused; }
  bool acts() const { return with.result != without.result; }
};
Comparison compared(Runs& runs, const Sample& sample, const Overrides& beside) {
  const Overrides around = sample.needs + beside;
  const std::string other = sample.key + "=" + sample.other;
  return {runs.of(sample.other.empty() ? around : around + Overrides{other}),
          runs.of(around + Overrides{sample.given()})};
}

/// Looks at a key beside what may switch it off.
void expect_told_if_idle(Runs& runs, const Sample& sample, const Overrides& beside) {
  const Comparison found = compared(runs, sample, beside);
  if (!found.can_be()) return;
  const auto is_new = [&](const std::string& said) {
    return std::ranges::count(found.without.said, said) == 0;
  };
  const auto is_of_it = [&](const std::string& said) { return says_idle(said, sample.key); };
  const bool told_idle = std::ranges::any_of(found.with.said, is_of_it);
  EXPECT_TRUE(found.acts() || told_idle || std::ranges::any_of(found.with.said, is_new))
      << sample.given() << " does nothing beside " << joined(beside, " ") << ", and nobody says so";
  EXPECT_FALSE(found.acts() && told_idle)
      << sample.given() << " acts beside " << joined(beside, " ") << ", and is said to have no effect";
}

/// Says whether a key is another one, or in its table.
bool is_in(const std::string& key, const std::string& table) {
  return key == table || (key.starts_with(table) && (key[table.size()] == '.' || key[table.size()] == '['));
}

/// A sample is asked of where it acts beside what the other one needs: else that is not its doing.
void expect_all_told(const SceneOfKeys& scene) {
  Runs runs(scene);
  for (const Sample& sample : scene.samples) {
    const Comparison alone = compared(runs, sample, {});
    ASSERT_FALSE(alone.with.refused) << sample.given() << ": " << joined(alone.with.said, "\n");
    EXPECT_TRUE(alone.without.refused || alone.acts()) << sample.given() << " does nothing here";
    for (const Sample& other : scene.samples)
      if (!is_in(other.key, sample.key) && !is_in(sample.key, other.key) &&
          !scene.coincide.contains({sample.key, other.key}))
        if (const Comparison before = compared(runs, sample, other.needs); before.can_be() && before.acts())
          expect_told_if_idle(runs, sample, other.needs + Overrides{other.given()});
    for (const std::string& other : scene.switches)
      if (const std::string key = other.substr(0, other.find('='));
          !is_in(key, sample.key) && !scene.coincide.contains({sample.key, key}))
        expect_told_if_idle(runs, sample, {other});
  }
}

TEST(IdleKeys, OfAFluidWithBodiesAreRefusedOrTold) {
  expect_all_told(in_fluid());
}
TEST(IdleKeys, OfBodiesAloneAreRefusedOrTold) {
  expect_all_told(dry());
}
TEST(IdleKeys, OfFillsAreRefusedOrTold) {
  expect_all_told(filled());
}
TEST(IdleKeys, OfLevelsAreRefusedOrTold) {
  expect_all_told(of_levels());
}

TEST(IdleKeys, OfHeatAreRefusedOrTold) {
  expect_all_told(warm());
}

TEST(IdleKeys, OfWallsAreRefusedOrTold) {
  expect_all_told(between_walls());
}

/// "bodies[0].motion.axis" -> "bodies.motion.axis"
std::string without_numbers(const std::string& key) {
  std::string plain;
  for (std::size_t i = 0; i < key.size(); ++i)
    if (key[i] != '[')
      plain += key[i];
    else
      i = key.find(']', i);
  return plain;
}

/// The sections whose keys say what is written or looked at, how it is computed with the same result, or
/// which of several things is meant: they change no state.
const std::set<std::string> of_no_state = {"",
                                           "units",
                                           "run",
                                           "run.steady",
                                           "run.balance",
                                           "output",
                                           "output.fields",
                                           "output.slices",
                                           "output.series",
                                           "output.probes",
                                           "output.mean",
                                           "output.bodies",
                                           "output.checkpoint",
                                           "output.report",
                                           "quantities",
                                           "domain",
                                           "initial"};

TEST(IdleKeys, EveryKeyThatNeedNotBeGivenIsLookedAt) {
  std::set<std::string> sampled;
  for (const SceneOfKeys& scene : {in_fluid(), dry(), filled(), of_levels(), warm(), between_walls()})
    for (const Sample& sample : scene.samples) {
      std::string key = without_numbers(sample.key);
      for (const auto& [from, to] : {std::pair("bodies.motion.", "walls.motion."),
                                     std::pair("domain.boundary.z.", "domain.boundary.x.")})
        if (key.starts_with(from)) key.replace(0, std::string_view(from).size(), to);
      sampled.insert(key);
    }
  // a name, a choice of one way of several to say something, what has the same result by another way, and
  // what belongs to another key that the samples give as a table
  const std::set<std::string> not_alone = {"bodies.name",
                                           "fill.name",
                                           "walls.name",
                                           "contacts.backend",
                                           "walls.rpm",
                                           "walls.motion.rpm",
                                           "bodies.diameter",
                                           "bodies.positions.position",
                                           "bodies.positions.orientation"};
  std::string missing;
  for (const KeySection& section : case_keys())
    for (const KeyText& key : section.keys) {
      const std::string path = section.path + "." + key.name;
      const bool must_be = key.fallback.starts_with("–") || key.fallback.starts_with("one of");
      if (of_no_state.contains(section.path) || must_be || not_alone.contains(path)) continue;
      if (!sampled.contains(path)) missing += path + "\n";
    }
  EXPECT_EQ(missing, "");
}

}  // namespace
}  // namespace silt::testing
