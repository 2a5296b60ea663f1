#pragma once
// A checkpoint holds all that a run needs to go on, bitwise, on any number of ranks:
//   /              format, format_version, complete
//   /state         the caller's named numbers and texts
//   /cells/NAME    [z][y][x] or [q][z][y][x] of float, double or bytes, or a list [q][entry], with a checksum
//   /bodies/...    the columns of BodyRecord, sorted by id, and those of its HolderState; impulse_count
//   /impulses/...  the columns of StoredImpulse, body after body
//   /provenance
// HDF5 guards its own metadata with checksums in this file; each dataset carries one of its content. The file
// has the same bytes from any number of ranks that are given the same provenance.
#include <mpi.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapters/hdf5/result_file.hpp"
#include "rigid/bodies/body_set.hpp"

namespace silt::adapters {

inline constexpr std::int64_t checkpoint_format_version = 16;

// ---- the checkpoints of a folder: checkpoint_000000005000.h5, the number being the step ----

/// Returns the step in a checkpoint's name, if the name is one.
std::optional<std::int64_t> checkpoint_step(const std::filesystem::path&);

/// Lists the checkpoints of a folder by name, newest (largest step) first; none if there is no folder.
std::vector<StepFile> list_checkpoints(const std::filesystem::path& folder);

/// Returns the newest checkpoint in the same folder whose step is smaller than that of `path`.
std::optional<std::filesystem::path> previous_checkpoint(const std::filesystem::path& path);

/// Deletes all but the `keep` newest of those up to and including the step of `path`, and unfinished ones
/// that a killed run left. keep < 1 keeps all. Errors are ignored: an old checkpoint too many harms nobody.
void drop_old_checkpoints(const std::filesystem::path& path, int keep);

// ---- one of them ----

/// The bodies that a rank owns, in any order. Rows are made when they are asked for, more than once.
struct OwnedRows {
  std::size_t n;
  std::function<rigid::BodyRecord(std::size_t)> record;
  std::function<const std::vector<rigid::StoredImpulse>&(std::size_t)> impulses;
};

/// A column of what the holder of bodies keeps with them: `count` numbers from a byte of HolderState on.
struct HolderColumn {
  const char* name;
  enum Type { float64, int64 } type;
  std::size_t offset;
  int count;
};

/// CheckpointWriter writes one checkpoint under a temporary name (PATH.part) and gives it its name once it
/// has been verified. Every call is collective. Errors are std::runtime_error on every rank, naming the file
/// and the reason; the temporary file is then removed and earlier checkpoints are untouched.
class CheckpointWriter {
 public:
  CheckpointWriter(MPI_Comm, const std::filesystem::path&, const Provenance&);
  /// Leaves nothing behind unless commit was called.
  ~CheckpointWriter();

  /// Writes an attribute; rank 0's value counts.
  void set(const std::string& name, std::int64_t);
  void set(const std::string& name, double);
  void set(const std::string& name, const std::string&);

  /// Writes cell data of a lattice: this rank's boxes, `components` populations a cell (1: the dataset is
  /// [z][y][x]). fill(q, box, out) writes population q of all cells of one box, x fastest, as they are
  /// stored; it is called for one q after the other. Cells no rank holds read as zero.
  void cells(const std::string& name, Storage, std::array<int, 3> lattice, int components,
             const std::vector<CellBox>& boxes,
             const std::function<void(int q, std::size_t box, void* out)>& fill);

  /// Writes a list of cells, `components` populations each, by tiles of a lattice in the order z, y, x. This
  /// rank's tiles are a box and have so many entries each. fill(q, out) writes population q of all of them,
  /// tile after tile; it is called for one q after the other.
  void list(const std::string& name, Storage, std::array<int, 3> tiles, int components, const CellBox& box,
            std::span<const std::uint32_t> counts, const std::function<void(int q, void* out)>& fill);

  /// Writes the bodies of all ranks and their stored impulses; of their holder state what the columns name.
  /// Each rank sorts and writes a slice of them, a column at a time.
  void bodies(const OwnedRows&, std::span<const HolderColumn> = {});

  /// Flushes, reads everything back against the checksums, renames, and deletes all but the `keep` newest (0:
  /// keeps all) of those with a step up to this one's. What a run has written to the files of `before`, where
  /// they are, is on the disk first: the checkpoint stands for it.
  void commit(int keep, const std::vector<std::filesystem::path>& before = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// CheckpointReader opens a checkpoint and verifies all of it before anything is handed out. Every call is
/// collective. Errors are std::runtime_error on every rank: which file, what is wrong with it, and which
/// earlier checkpoint to use.
class CheckpointReader {
 public:
  CheckpointReader(MPI_Comm, const std::filesystem::path&);
  ~CheckpointReader();

  /// Throws what the file cannot be used for, and which one can be.
  [[noreturn]] void refuse(const std::string& what) const;
  /// Throws why another case than the one it is of cannot begin with it, nor with another one of that run.
  [[noreturn]] void refuse_case(const std::string& what) const;
  const std::filesystem::path& path() const;
  MPI_Comm comm() const;

  bool has(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double number(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::string provenance(const std::string& name) const;
  std::string case_text() const;

  /// Returns the lattice and the number of populations a cell of a dataset.
  std::array<int, 3> lattice(const std::string& name) const;
  int components(const std::string& name) const;
  bool is_stored_as(const std::string& name, Storage) const;
  /// Reads this rank's boxes, whatever rank wrote them; take(q, box, in) mirrors fill of
  /// CheckpointWriter::cells. It must be stored so.
  void cells(const std::string& name, Storage, const std::vector<CellBox>& boxes,
             const std::function<void(int q, std::size_t box, const void* in)>& take) const;

  /// Reads a list, mirroring CheckpointWriter::list. It must be stored so, with as many entries in all.
  void list(const std::string& name, Storage, std::array<int, 3> tiles, int components, const CellBox& box,
            std::span<const std::uint32_t> counts,
            const std::function<void(int q, const void* in)>& take) const;
  bool has_cells(const std::string& name) const;

  struct Bodies {
    std::uint64_t first_body = 0, first_impulse = 0;  // rows of /bodies and /impulses
    std::vector<rigid::BodyRecord> records;           // sorted by id
    std::vector<std::vector<rigid::StoredImpulse>> impulses;
  };
  /// Returns this rank's slice of the bodies, n r / ranks on. The rest of the holder state is zero.
  Bodies bodies(std::span<const HolderColumn> = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace silt::adapters
