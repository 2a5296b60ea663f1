#include "coupler/case/case_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "coupler/case/case_error.hpp"
#include "parallel/collectives.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

// Directories with a case.toml beside the one asked for, or below the place it was asked from.
std::vector<std::string> cases_near(const fs::path& directory) {
  std::vector<std::string> names;
  std::error_code ignored;
  const fs::path parent = directory.has_parent_path() ? directory.parent_path() : fs::path(".");
  for (const auto& entry : fs::directory_iterator(parent, ignored))
    if (fs::exists(entry.path() / "case.toml", ignored)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string text_of(const fs::path& directory, const fs::path& file) {
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored))  // to open anything else could wait forever
    if (std::ifstream stream(file, std::ios::binary); stream)
      return {std::istreambuf_iterator<char>(stream), {}};
  const auto names = cases_near(directory);
  throw CaseError(
      Place{file.string()},
      fmt::format("there is no such file, or it cannot be read; a case is a directory with a case.toml{}",
                  names.empty() ? "" : suggestion(directory.filename().string(), names)));
}

}  // namespace

const AttachedFile& CaseSource::file_named(const std::string& name) {
  const auto found = attached.find(name);
  if (found != attached.end()) return found->second;
  return attached.emplace(name, read_attached(directory(), name)).first->second;
}

const AttachedFile& CaseSource::positions_named(const std::string& name) {
  const auto found = attached.find(name);
  if (found != attached.end()) return found->second;
  return attached.emplace(name, look_at_positions(directory(), name)).first->second;
}

CaseSource read_source(const fs::path& directory) {
  const bool is_file = directory.extension() == ".toml";
  const fs::path folder = is_file                    ? directory
                          : directory.has_filename() ? directory
                                                     : directory.parent_path();
  const fs::path file = is_file ? directory : folder / "case.toml";
  return {file.string(), text_of(folder, file), {}};
}

void broadcast(MPI_Comm comm, CaseSource& source) {
  using parallel::broadcast;
  broadcast(comm, source.file);
  broadcast(comm, source.text);
  std::uint64_t files = source.attached.size();
  broadcast(comm, files);
  auto next = source.attached.begin();
  const int rank = parallel::rank_of(comm);
  for (std::uint64_t i = 0; i < files; ++i) {
    std::string name;
    AttachedFile file;
    if (rank == 0) std::tie(name, file) = *next++;
    broadcast(comm, name);
    broadcast(comm, file.bytes);
    broadcast(comm, file.fingerprint);
    broadcast(comm, file.positions);
    if (rank != 0) source.attached[name] = std::move(file);
  }
}

}  // namespace silt::coupler
