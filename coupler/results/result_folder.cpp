#include "coupler/results/result_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace silt::coupler {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw FileError(fmt::format("{}: {}", path.string(), what));
}

fs::path first_free(const fs::path& folder) {
  for (int n = 1;; ++n) {
    const fs::path candidate = folder.string() + "." + std::to_string(n);
    if (!fs::exists(fs::symlink_status(candidate))) return candidate;
  }
}

/// Whether it is a file under the temporary name of one to come, or one that MPI keeps beside such.
bool is_unfinished(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".part") || name.find(".part.") != std::string::npos;
}

}  // namespace

bool is_result(const fs::path& path) {
  const std::string name = path.filename().string();
  const auto is = [&](std::string_view begin, std::string_view end) {
    return name.size() >= begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end);
  };
  static const std::vector<std::string> names = {
      "run.log",         "departures.csv", "report.json", "report.html", "bodies.h5",  "bodies.h5.journal",
      "mean_height.png", "velocity.png",   "bodies.png",  "slice.png",   "stages.png", "render.png",
      "film.mp4",        "bodies.pvd",     "scene.h5",    "walls.pvd",   "paraview.py"};
  return std::count(names.begin(), names.end(), name) > 0 || is("fields_", ".hdf") || is("slice_", ".hdf") ||
         is("slice_", ".hdf.series") || is("fields", ".hdf.series") || is("bodies_", ".hdf") ||
         is("bodies_", ".vtp") || is("walls_", ".vtp") || is("bodies", ".hdf.series") ||
         is("series", ".csv") || is("checkpoint_", ".h5") || is("stopped_", ".h5") || is_unfinished(path);
}

namespace {

/// Moves or deletes the results in a folder that is there. Returns what was done.
std::string make_room(const fs::path& folder, bool overwrite) {
  std::error_code error;
  std::vector<fs::path> results, others;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != ResultLock::name)
      (is_result(entry.path()) ? results : others).push_back(entry.path());
  if (results.empty()) return "";
  if (overwrite) {
    for (const fs::path& path : results)
      if (!fs::remove(path, error) && error) fail(path, "cannot be deleted: " + error.message());
    return fmt::format("the earlier results in {} are deleted", folder.string());
  }
  if (!others.empty())
    throw std::runtime_error(
        fmt::format("{}: holds results of an earlier run, and {} that is none; choose another folder with "
                    "--out, or delete the results with --overwrite",
                    folder.string(), others[0].filename().string()));
  const fs::path aside = first_free(folder);
  fs::rename(folder, aside, error);
  if (error)
    fail(folder, fmt::format("holds results of an earlier run and cannot be moved to {}: {}", aside.string(),
                             error.message()));
  fs::remove(aside / ResultLock::name, error);
  return fmt::format("the earlier results are now in {}", aside.string());
}

}  // namespace

ReadyFolder prepare_result_folder(const fs::path& given, bool overwrite) {
  const fs::path folder = given.has_filename() ? given : given.parent_path();
  std::error_code error;
  ReadyFolder ready;
  if (fs::exists(folder, error)) {
    if (!fs::is_directory(folder)) fail(folder, "is a file; the results need a folder");
    ready.lock = std::make_unique<ResultLock>(folder);
    ready.note = make_room(folder, overwrite);
    if (ready.lock->is_in_place()) return ready;
  }
  fs::create_directories(folder, error);
  if (error) fail(folder, "cannot be made: " + error.message());
  ready.lock = std::make_unique<ResultLock>(folder);
  return ready;
}

ReadyFolder return_to_result_folder(const fs::path& folder) {
  ReadyFolder ready;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail(folder, "cannot be made: " + error.message());
  ready.lock = std::make_unique<ResultLock>(folder);
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (is_unfinished(entry.path()) && is_result(name.substr(0, name.find(".part"))))
      fs::remove(entry.path(), error);
  }
  return ready;
}

void write_text(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  {
    std::ofstream file(part, std::ios::binary);
    file << text;
    file.close();
    if (!file) {
      const std::string reason = std::strerror(errno);
      std::error_code ignored;
      fs::remove(part, ignored);
      fail(path, "cannot be written: " + reason);
    }
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) fail(path, "cannot be written: " + error.message());
}

}  // namespace silt::coupler
