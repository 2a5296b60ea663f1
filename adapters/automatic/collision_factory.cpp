#include "adapters/automatic/collision_factory.hpp"

#include <cctype>
#include <stdexcept>
#include <string>

#include "adapters/automatic/automatic_backend.hpp"
#include "adapters/automatic/engines.hpp"
#include "rigid/collision/analytic_backend.hpp"

namespace silt::adapters {

namespace {

struct Entry {
  std::string_view name;
  engines::MakeBackend make;  // nullptr: left out of this build
};

/// A new backend is one line here and one in the conformance suite.
constexpr Entry backends[] = {
    {"auto", [] { return std::unique_ptr<rigid::CollisionBackend>(new AutomaticBackend); }},
    {"analytic", [] { return std::unique_ptr<rigid::CollisionBackend>(new rigid::AnalyticBackend); }},
    {"bullet", engines::bullet_backend},
    {"fcl", engines::fcl_backend},
};

}  // namespace

std::string engines::left_out_text(std::string_view name) {
  std::string option(name);
  for (char& c : option) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return "this build of silt has no " + option + ": use \"auto\", or configure it with -D SILT_WITH_" +
         option + "=ON";
}

std::vector<std::string_view> backend_names() {
  std::vector<std::string_view> names;
  for (const Entry& entry : backends)
    if (entry.make) names.push_back(entry.name);
  return names;
}

std::string left_out_of_this_build(std::string_view name) {
  for (const Entry& entry : backends)
    if (entry.name == name && !entry.make) return engines::left_out_text(name);
  return "";
}

std::unique_ptr<rigid::CollisionBackend> make_backend(std::string_view name) {
  std::string known;
  for (const Entry& entry : backends) {
    if (entry.name == name && entry.make) return entry.make();
    if (entry.name == name) throw std::invalid_argument(engines::left_out_text(name));
    if (entry.make) known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw std::invalid_argument("unknown collision backend \"" + std::string(name) + "\"; known: " + known);
}

}  // namespace silt::adapters
