#include "adapters/automatic/collision_factory.hpp"

#include <stdexcept>
#include <string>

#include "adapters/automatic/automatic_backend.hpp"
#include "adapters/bullet/bullet_backend.hpp"
#include "adapters/fcl/fcl_backend.hpp"
#include "rigid/collision/analytic_backend.hpp"

namespace silt::adapters {

namespace {

using Make = std::unique_ptr<rigid::CollisionBackend> (*)();
struct Entry {
  std::string_view name;
  Make make;
};

/// A new backend is one line here and one in the conformance suite.
constexpr Entry backends[] = {
    {"auto", [] { return std::unique_ptr<rigid::CollisionBackend>(new AutomaticBackend); }},
    {"analytic", [] { return std::unique_ptr<rigid::CollisionBackend>(new rigid::AnalyticBackend); }},
    {"bullet", make_bullet_backend},
    {"fcl", make_fcl_backend},
};

}  // namespace

std::vector<std::string_view> backend_names() {
  std::vector<std::string_view> names;
  for (const Entry& entry : backends) names.push_back(entry.name);
  return names;
}

std::unique_ptr<rigid::CollisionBackend> make_backend(std::string_view name) {
  std::string known;
  for (const Entry& entry : backends) {
    if (entry.name == name) return entry.make();
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown collision backend \"" + std::string(name) + "\"; known: " + known);
}

}  // namespace silt::adapters
