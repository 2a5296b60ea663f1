#include "adapters/automatic/broad_phase_factory.hpp"

#include <stdexcept>
#include <string>

#include "adapters/automatic/engines.hpp"
#include "rigid/collision/uniform_grid.hpp"

namespace silt::adapters {

namespace {

using Made = std::unique_ptr<rigid::BroadPhase>;
struct Entry {
  std::string_view name;
  engines::MakeBroadPhase make;  // nullptr: left out of this build
};

/// A new broad phase is one line here; the tests of rigid/collision/broad_phase then run on it by name.
constexpr Entry broad_phases[] = {
    {"grid", [] { return Made(new rigid::UniformGrid); }},
    {"bullet", engines::bullet_broad_phase},
    {"fcl", engines::fcl_broad_phase},
};

const Entry* entry_of(std::string_view name) {
  for (const Entry& entry : broad_phases)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace

std::vector<std::string_view> broad_phase_names() {
  std::vector<std::string_view> names = {"auto"};
  for (const Entry& entry : broad_phases)
    if (entry.make) names.push_back(entry.name);
  return names;
}

Made make_broad_phase(std::string_view name, std::string_view backend) {
  if (name == "auto") name = entry_of(backend) ? backend : "grid";
  if (const Entry* entry = entry_of(name)) {
    if (!entry->make) throw std::invalid_argument(engines::left_out_text(name));
    return entry->make();
  }
  std::string known;
  for (const std::string_view n : broad_phase_names()) known += (known.empty() ? "" : ", ") + std::string(n);
  throw std::invalid_argument("unknown broad phase \"" + std::string(name) + "\"; known: " + known);
}

}  // namespace silt::adapters
