#include "silt/results/result_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "adapters/hdf5/disk.hpp"

namespace silt {

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

/// Returns whether a file is temporary, of a run or of MPI.
bool is_unfinished(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".part") || name.find(".part.") != std::string::npos;
}

/// Throws the error for a lock that another run holds.
[[noreturn]] void refuse_lock(const fs::path& path) {
  std::ifstream in(path);
  std::string holder{std::istreambuf_iterator<char>(in), {}};
  while (!holder.empty() && holder.back() == '\n') holder.pop_back();
  throw std::runtime_error(fmt::format(
      "{}: a run is writing here: {}; wait for its end, stop it, or choose another folder with --out",
      path.parent_path().string(), holder.empty() ? "it has only just begun" : holder));
}

}  // namespace

ResultLock::ResultLock(const fs::path& folder) : path_(folder / name) {
  do {  // until it has the name: the last owner may have removed it
    if (file_ >= 0) close(file_);
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0) fail(path_, "cannot be made: " + adapters::system_reason(errno));
    if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(file_);
      refuse_lock(path_);
    }
  } while (!is_in_place());
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string text = fmt::format("process {} on {}\n", getpid(), host);
  if (ftruncate(file_, 0) != 0 || pwrite(file_, text.data(), text.size(), 0) < 0) {
    const std::string reason = adapters::system_reason(errno);
    close(file_);
    fail(path_, "cannot be written: " + reason);
  }
}

ResultLock::~ResultLock() {
  if (is_in_place()) unlink(path_.c_str());
  close(file_);
}

bool ResultLock::is_in_place() const {
  struct stat mine, there;
  return fstat(file_, &mine) == 0 && stat(path_.c_str(), &there) == 0 && mine.st_ino == there.st_ino &&
         mine.st_dev == there.st_dev;
}

bool is_result(const fs::path& path) {
  const std::string name = path.filename().string();
  const auto is = [&](std::string_view begin, std::string_view end) {
    return name.size() >= begin.size() + end.size() && name.starts_with(begin) && name.ends_with(end);
  };
  static const std::vector<std::string> names = {
      "run.log",      "departures.csv", "report.json", "report.html", "bodies.h5",  "mean_height.png",
      "velocity.png", "bodies.png",     "slice.png",   "stages.png",  "render.png", "film.mp4",
      "bodies.pvd",   "bodies.vtkhdf",  "scene.h5",    "walls.pvd",   "paraview.py"};
  return std::count(names.begin(), names.end(), name) > 0 || is("fields_", ".hdf") || is("mean_", ".hdf") ||
         is("mean", ".hdf.series") || is("slice_", ".hdf") || is("slice_", ".hdf.series") ||
         is("fields", ".hdf.series") || is("fields", ".vtkhdf") || is("slice_", ".vtkhdf") ||
         is("bodies_", ".h5") || is("bodies_", ".vtp") || is("walls_", ".vtp") || is("series", ".csv") ||
         is("probes_", ".csv") || is("checkpoint_", ".h5") || is("stopped_", ".h5") || is_unfinished(path);
}

namespace {

/// Returns whether a folder cannot be renamed: a link, or a mount point.
bool stays(const fs::path& folder) {
  struct stat own, parent;
  return fs::is_symlink(folder) ||
         (stat(folder.c_str(), &own) == 0 && stat((folder / "..").c_str(), &parent) == 0 &&
          own.st_dev != parent.st_dev);
}

/// Returns the name for earlier results beside a folder, or in it.
std::string name_of(const fs::path& folder) {
  return fs::absolute(folder / "").lexically_normal().parent_path().filename().string();
}

bool is_earlier(const fs::path& path, const fs::path& folder) {
  return path.filename().string().starts_with(name_of(folder) + ".") && fs::is_directory(path);
}

/// Moves results into a subfolder of their folder.
std::string move_inside(const fs::path& folder, const std::vector<fs::path>& results) {
  std::error_code error;
  const fs::path aside = first_free(folder / name_of(folder));
  fs::create_directory(aside, error);
  if (error) fail(aside, "cannot be made for the earlier results: " + error.message());
  for (const fs::path& path : results) {
    fs::rename(path, aside / path.filename(), error);
    if (error)
      fail(path, fmt::format("is of an earlier run and cannot be moved to {}: {}", aside.string(),
                             error.message()));
  }
  return fmt::format("the earlier results are now in {}", aside.string());
}

/// Moves or deletes the results in an existing folder; returns what was done.
std::string make_room(const fs::path& folder, bool overwrite) {
  std::error_code error;
  std::vector<fs::path> results, others;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != ResultLock::name && !is_earlier(entry.path(), folder))
      (is_result(entry.path()) ? results : others).push_back(entry.path());
  if (results.empty()) return "";
  if (overwrite) {
    for (const fs::path& path : results)
      if (!fs::remove(path, error) && error) fail(path, "cannot be deleted: " + error.message());
    return fmt::format("the earlier results in {} are deleted", folder.string());
  }
  if (stays(folder)) return move_inside(folder, results);
  if (!others.empty())
    throw std::runtime_error(
        fmt::format("{}: holds results of an earlier run, and {} that is none; choose another folder with "
                    "--out, or delete the results with --overwrite",
                    folder.string(), others[0].filename().string()));
  const fs::path aside = first_free(folder);
  fs::rename(folder, aside, error);
  if (error) return move_inside(folder, results);  // e.g. a mount point inside
  fs::remove(aside / ResultLock::name, error);
  return fmt::format("the earlier results are now in {}", aside.string());
}

}  // namespace

void require_folder(const fs::path& folder) {
  std::error_code error, ignored;
  const fs::file_status there = fs::status(folder, error);
  const bool is_link = fs::is_symlink(fs::symlink_status(folder, ignored));
  const std::string target = is_link ? fs::read_symlink(folder, ignored).string() : "";
  if (is_link && error.value() == ELOOP) fail(folder, "is a link that leads back to itself: remove it");
  if (is_link && there.type() == fs::file_type::not_found)
    fail(folder,
         fmt::format("is a link to {}, which is not there: make that folder, or remove the link", target));
  if (fs::exists(there) && !fs::is_directory(there))
    fail(folder, fmt::format("is {}; the results need a folder",
                             is_link ? fmt::format("a link to {}, a file", target) : "a file"));
}

ReadyFolder prepare_result_folder(const fs::path& given, bool overwrite) {
  const fs::path folder = given.has_filename() ? given : given.parent_path();
  require_folder(folder);
  std::error_code error;
  ReadyFolder ready;
  if (fs::exists(folder, error)) {
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
  require_folder(folder);
  ReadyFolder ready;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail(folder, "cannot be made: " + error.message());
  ready.lock = std::make_unique<ResultLock>(folder);
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (is_unfinished(entry.path()) && (name == last_words || is_result(name.substr(0, name.find(".part")))))
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
      const std::string reason = adapters::system_reason(errno);
      std::error_code ignored;
      fs::remove(part, ignored);
      fail(path, "cannot be written: " + reason);
    }
  }
  std::error_code error;
  fs::rename(part, path, error);
  if (error) fail(path, "cannot be written: " + error.message());
}

}  // namespace silt
