#include <unistd.h>

#include <chrono>

#include <fmt/chrono.h>

#include "coupler/results/build_info.hpp"
#include "lbm/isa.hpp"

namespace silt::coupler {

std::string instruction_set() {
  switch (lbm::chosen_isa()) {
    case lbm::Isa::avx512:
      return "avx512";
    case lbm::Isa::avx2:
      return "avx2";
    default:
      return "portable";
  }
}

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
