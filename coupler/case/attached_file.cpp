#include "coupler/case/attached_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace silt::coupler {

namespace fs = std::filesystem;

AttachedFile read_attached(const fs::path& directory, const std::string& name) {
  const fs::path relative = name;
  if (relative.is_absolute() || std::count(relative.begin(), relative.end(), fs::path("..")))
    throw std::invalid_argument(
        "it must lie in the directory of the case, which holds all that a run needs: copy it there");
  std::ifstream stream(directory / relative, std::ios::binary);
  if (!stream || !fs::is_regular_file(directory / relative))
    throw std::invalid_argument("there is no such file in the directory of the case, or it cannot be read");
  AttachedFile file{{std::istreambuf_iterator<char>(stream), {}}, ""};
  file.fingerprint = fmt::format("{}: {} bytes, XXH3 {:016x}", name, file.bytes.size(),
                                 XXH3_64bits(file.bytes.data(), file.bytes.size()));
  return file;
}

}  // namespace silt::coupler
