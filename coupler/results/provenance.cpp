#include <unistd.h>

#include <chrono>

#include <fmt/chrono.h>

#include "coupler/case/case.hpp"
#include "coupler/results/build_info.hpp"

namespace silt::coupler {

adapters::Provenance provenance_of(const Case& scene, int ranks, const std::string& backend) {
  adapters::Provenance p;
  p.version = build_info().version;
  p.commit = build_info().commit;
  p.compiler = build_info().compiler;
  p.title = scene.title;
  p.case_text = scene.text;
  p.ranks = ranks;
  p.backend = backend;
  char host[256] = "";
  if (gethostname(host, sizeof host - 1) == 0) p.host = host;
  p.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return p;
}

}  // namespace silt::coupler
