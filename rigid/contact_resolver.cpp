#include "rigid/contact_resolver.hpp"

#include <stdexcept>
#include <string>

#include "rigid/ffd_resolver.hpp"
#include "rigid/sffd_resolver.hpp"

namespace silt::rigid {

std::unique_ptr<ContactResolver> make_resolver(std::string_view name, const ResolverSettings& settings) {
  if (name == "sffd") return std::make_unique<SffdResolver>(settings);
  if (name == "ffd") return std::make_unique<FfdResolver>(settings);
  throw std::invalid_argument("no resolver \"" + std::string(name) + "\"; known: sffd, ffd");
}

}  // namespace silt::rigid
