#include "rigid/response/contact_resolver.hpp"

#include <stdexcept>
#include <string>

#include "rigid/response/ffd_resolver.hpp"
#include "rigid/response/impact_phase.hpp"
#include "rigid/response/sffd_resolver.hpp"

namespace silt::rigid {

std::unique_ptr<ContactResolver> make_resolver(std::string_view name, const ResolverSettings& settings) {
  if (name == "sffd") {
    auto sffd = std::make_unique<SffdResolver>(settings);
    if (settings.impact_sweeps == 0) return sffd;
    return std::make_unique<ImpactThenContact>(settings.impact_sweeps, std::move(sffd));
  }
  if (name == "ffd") return std::make_unique<FfdResolver>(settings);
  throw std::invalid_argument("no resolver \"" + std::string(name) + "\"; known: sffd, ffd");
}

}  // namespace silt::rigid
