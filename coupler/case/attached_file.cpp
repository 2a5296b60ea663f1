#include "coupler/case/attached_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <vector>

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

/// Opens a file beside the case.
std::ifstream opened(const fs::path& directory, const fs::path& relative) {
  if (relative.is_absolute() || std::count(relative.begin(), relative.end(), fs::path("..")))
    throw std::invalid_argument(
        "it must lie in the directory of the case, which holds all that a run needs: copy it there");
  const std::string name = relative.string();
  if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return std::iscntrl(c); }))
    throw std::invalid_argument("its name has a line break or another control character in it: rename it");
  std::ifstream stream;
  std::error_code ignored;
  if (fs::is_regular_file(directory / relative, ignored))  // to open anything else could wait forever
    stream.open(directory / relative, std::ios::binary);
  if (!stream.is_open())
    throw std::invalid_argument("there is no such file in the directory of the case, or it cannot be read");
  return stream;
}

std::string fingerprint_of(const std::string& name, std::uint64_t bytes, XXH64_hash_t hash) {
  return fmt::format("{}: {} bytes, XXH3 {:016x}", name, bytes, hash);
}

}  // namespace

AttachedFile read_attached(const fs::path& directory, const std::string& name) {
  std::ifstream stream = opened(directory, name);
  AttachedFile file{{std::istreambuf_iterator<char>(stream), {}}, "", {}};
  file.fingerprint =
      fingerprint_of(name, file.bytes.size(), XXH3_64bits(file.bytes.data(), file.bytes.size()));
  return file;
}

AttachedFile look_at_positions(const fs::path& directory, const std::string& name) {
  const PositionFile positions = position_file(name);
  std::ifstream stream = opened(directory, positions.file);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> piece(std::size_t{1} << 20);
  std::uint64_t bytes = 0;
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
    bytes += static_cast<std::uint64_t>(stream.gcount());
    XXH3_64bits_update(state.get(), piece.data(), static_cast<std::size_t>(stream.gcount()));
  }
  AttachedFile file;
  file.fingerprint = fingerprint_of(name, bytes, XXH3_64bits_digest(state.get()));
  try {
    file.positions = look_through(directory, positions);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
  if (file.positions.points == 0) throw std::invalid_argument("there is no point in it");
  return file;
}

}  // namespace silt::coupler
