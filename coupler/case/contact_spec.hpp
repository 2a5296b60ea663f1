#pragma once
// How bodies collide: the table [contacts] of a case.
#include <optional>
#include <string>

#include "rigid/response/contact_resolver.hpp"

namespace silt::coupler {

struct ContactSpec {
  std::string backend = "auto", broad_phase = "auto", resolver = "sffd";
  rigid::ResolverSettings resolver_settings;
  int substeps = 1;
  double margin = 1.0;
  std::optional<double> sleep_speed, sleep_time;  // of bodies at rest; no speed: none sleeps
};

}  // namespace silt::coupler
