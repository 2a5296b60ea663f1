#include <unistd.h>

#include <fstream>

#include <fmt/chrono.h>

#include "silt/case/case.hpp"
#include "silt/results/build_info.hpp"

namespace silt {

namespace {

/// Returns the CPU name given by Linux, or "".
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.find(": "), line.size() - 2) + 2);
  return "";
}

}  // namespace

adapters::Provenance provenance_of(const Case& setup, int ranks, const std::string& backend) {
  adapters::Provenance p = build_info();
  p.processor = processor_name();
  p.title = setup.title;
  p.case_text = setup.text;
  p.ranks = ranks;
  p.backend = backend;
  char host[256] = "";
  if (gethostname(host, sizeof host - 1) == 0) p.host = host;
  p.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return p;
}

}  // namespace silt
