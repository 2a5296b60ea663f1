#include "adapters/automatic/collision_factory.hpp"

#include <cctype>
#include <stdexcept>

#include "adapters/automatic/automatic_backend.hpp"
#include "rigid/collision/uniform_grid.hpp"
#ifdef SILT_WITH_BULLET
#include "adapters/bullet/bullet.hpp"
#endif
#ifdef SILT_WITH_FCL
#include "adapters/fcl/fcl.hpp"
#endif

namespace silt::adapters {

namespace {

template <class Made>
using Maker = std::unique_ptr<Made> (*)();
using MakeBackend = Maker<rigid::CollisionBackend>;
using MakeBroadPhase = Maker<rigid::BroadPhase>;

#ifndef SILT_WITH_BULLET
constexpr MakeBackend make_bullet_backend = nullptr;
constexpr MakeBroadPhase make_bullet_broad_phase = nullptr;
#endif
#ifndef SILT_WITH_FCL
constexpr MakeBackend make_fcl_backend = nullptr;
constexpr MakeBroadPhase make_fcl_broad_phase = nullptr;
#endif

std::unique_ptr<rigid::CollisionBackend> make_automatic_backend() {
  std::vector<std::unique_ptr<rigid::CollisionBackend>> engines;
  for (const MakeBackend make : {MakeBackend(make_bullet_backend), MakeBackend(make_fcl_backend)})
    if (make) engines.push_back(make());
  return std::make_unique<AutomaticBackend>(std::move(engines));
}

template <class Made>
struct Entry {
  std::string_view name;
  Maker<Made> make;  // nullptr: left out of this build
};

/// A new backend is one line here; the conformance suite then runs on it by name.
constexpr Entry<rigid::CollisionBackend> backends[] = {
    {"auto", make_automatic_backend},
    {"analytic", [] { return std::unique_ptr<rigid::CollisionBackend>(new rigid::AnalyticBackend); }},
    {"bullet", make_bullet_backend},
    {"fcl", make_fcl_backend},
};

/// A new broad phase is one line here; the tests of rigid/collision/broad_phase then run on it by name.
constexpr Entry<rigid::BroadPhase> broad_phases[] = {
    {"grid", [] { return std::unique_ptr<rigid::BroadPhase>(new rigid::UniformGrid); }},
    {"bullet", make_bullet_broad_phase},
    {"fcl", make_fcl_broad_phase},
};

template <class Made, std::size_t count>
const Entry<Made>* entry_of(const Entry<Made> (&entries)[count], std::string_view name) {
  for (const Entry<Made>& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

template <class Made, std::size_t count>
void add_names(const Entry<Made> (&entries)[count], std::vector<std::string_view>& names) {
  for (const Entry<Made>& entry : entries)
    if (entry.make) names.push_back(entry.name);
}

/// `what` is said of a name that is none of those known.
template <class Made>
std::unique_ptr<Made> made(const Entry<Made>* entry, std::string_view name, const char* what,
                           const std::vector<std::string_view>& known) {
  if (entry && entry->make) return entry->make();
  if (entry) throw std::invalid_argument(left_out_of_this_build(name));
  std::string list;
  for (const std::string_view n : known) list += (list.empty() ? "" : ", ") + std::string(n);
  throw std::invalid_argument("unknown " + std::string(what) + " \"" + std::string(name) +
                              "\"; known: " + list);
}

}  // namespace

std::vector<std::string_view> backend_names() {
  std::vector<std::string_view> names;
  add_names(backends, names);
  return names;
}

std::vector<std::string_view> broad_phase_names() {
  std::vector<std::string_view> names = {"auto"};
  add_names(broad_phases, names);
  return names;
}

std::string left_out_of_this_build(std::string_view name) {
  const auto* entry = entry_of(backends, name);
  if (!entry || entry->make) return "";
  std::string option(name);
  for (char& c : option) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return "this build of silt has no " + option + ": use \"auto\", or configure it with -D SILT_WITH_" +
         option + "=ON";
}

std::unique_ptr<rigid::CollisionBackend> make_backend(std::string_view name) {
  return made(entry_of(backends, name), name, "collision backend", backend_names());
}

std::unique_ptr<rigid::BroadPhase> make_broad_phase(std::string_view name, std::string_view backend) {
  if (name == "auto") name = entry_of(broad_phases, backend) ? backend : "grid";
  return made(entry_of(broad_phases, name), name, "broad phase", broad_phase_names());
}

}  // namespace silt::adapters
