#include "rigid/response/contact_resolver.hpp"

#include <stdexcept>
#include <string>

#include "rigid/response/ffd_resolver.hpp"
#include "rigid/response/impact_phase.hpp"
#include "rigid/response/sffd_resolver.hpp"

namespace silt::rigid {
namespace {

using Made = std::unique_ptr<ContactResolver>;

Made make_sffd(const ResolverSettings& settings) {
  auto sffd = std::make_unique<SffdResolver>(settings);
  if (settings.impact_sweeps == 0) return sffd;
  return std::make_unique<ImpactThenContact>(
      ImpactPhase(settings.impact_sweeps, settings.least_impact_restitution), std::move(sffd));
}

constexpr ResolverModel models[] = {
    {.name = "sffd",
     .lubricates = true,
     .has_impact_phase = true,
     .resists_rolling_and_pulls = true,
     .sweeps = true,
     .make = make_sffd},
    {.name = "ffd",
     .makes_energy = true,
     .make = [](const ResolverSettings& s) -> Made { return std::make_unique<FfdResolver>(s); }},
};

}  // namespace

std::span<const ResolverModel> resolver_models() {
  return models;
}

const ResolverModel& resolver_model(std::string_view name) {
  std::string known;
  for (const ResolverModel& model : models) {
    if (model.name == name) return model;
    known += (known.empty() ? "" : ", ") + std::string(model.name);
  }
  throw std::invalid_argument("no resolver \"" + std::string(name) + "\"; known: " + known);
}

std::unique_ptr<ContactResolver> make_resolver(std::string_view name, const ResolverSettings& settings) {
  return resolver_model(name).make(settings);
}

}  // namespace silt::rigid
