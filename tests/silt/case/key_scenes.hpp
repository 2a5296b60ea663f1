#pragma once
// Scenes in which keys of a case act, each with a value: for tests of what switches keys off.
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/silt/case/case_text.hpp"
#include "tests/silt/case/mesh_case.hpp"

namespace silt::testing {

inline Overrides operator+(Overrides a, const Overrides& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// A key with a value by which it acts in a scene that has what it needs. Where it must be given: another
/// value, to compare with.
struct Sample {
  std::string key;  // with the numbers of entries
  std::string value;
  Overrides needs = {};
  std::string other = {};

  std::string given() const { return key + "=" + value; }
};

struct SceneOfKeys {
  std::string text;
  std::vector<Sample> samples;
  Overrides switches;  // what may switch a key off, besides the samples
  /// A key, and another that makes the scene one where its values come to the same by chance.
  std::set<std::pair<std::string, std::string>> coincide = {};
  Files files = {};
};

/// Balls near each other and near a wall, in a fluid that another wall drags along.
SceneOfKeys in_fluid();
/// Bodies that fall, collide and slide, without a fluid.
SceneOfKeys dry();
/// Bodies that find their places by themselves.
SceneOfKeys filled();
/// Bodies in a fluid with a temperature.
SceneOfKeys warm();
/// A fluid of cells of two widths.
SceneOfKeys of_levels();
/// Bodies and a mesh that moves in a tube full of fluid, which is open at one end.
SceneOfKeys between_walls();

}  // namespace silt::testing
