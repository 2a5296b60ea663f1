#pragma once
// Checkpoints: the complete state of a run, from which it continues bitwise on any number of ranks:
//   /              format, format_version, complete
//   /state         named numbers and texts of the caller
//   /cells/NAME    [z][y][x] or [q][z][y][x] of float, double or bytes, or a list [q][entry], with a checksum
//   /bodies/...    the columns of BodyRecord and of its AttachedState, sorted by id; impulse_count
//   /impulses/...  the columns of StoredImpulse, in the order of the bodies
//   /provenance
// HDF5's metadata have checksums in this file, and so has the content of each dataset. The bytes of the file
// do not depend on the number of ranks, given the same provenance.
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

inline constexpr std::int64_t checkpoint_format_version = 17;

// ---- the checkpoints of a folder: checkpoint_000000005000.h5, numbered by step ----

/// Returns the step in the name of a checkpoint; nothing for other names.
std::optional<std::int64_t> checkpoint_step(const std::filesystem::path&);

/// Lists the checkpoints of a folder, the newest (largest step) first; none if there is no folder.
std::vector<StepFile> list_checkpoints(const std::filesystem::path& folder);

/// Returns the newest checkpoint of the same folder with a smaller step than `path`.
std::optional<std::filesystem::path> previous_checkpoint(const std::filesystem::path& path);

/// Deletes all but the `keep` newest checkpoints with a step up to that of `path`, and incomplete files of
/// killed runs. keep < 1 keeps all. Errors are ignored, since an additional checkpoint does no harm.
void drop_old_checkpoints(const std::filesystem::path& path, int keep);

// ---- one checkpoint ----

/// The bodies that a rank owns, in any order. Both functions may be called more than once for a row.
struct OwnedRows {
  std::size_t n;
  std::function<rigid::BodyRecord(std::size_t)> record;
  std::function<const std::vector<rigid::StoredImpulse>&(std::size_t)> impulses;
};

/// A column of the attached state: `count` numbers from a byte of AttachedState on.
struct AttachedColumn {
  const char* name;
  enum Type { float64, int64 } type;
  std::size_t offset;
  int count;
};

/// Writes a checkpoint under a temporary name (PATH.part), which becomes PATH after verification. All calls
/// are collective. Errors are std::runtime_error on every rank, with file and reason; then the temporary file
/// is removed, and earlier checkpoints are unchanged.
class CheckpointWriter {
 public:
  CheckpointWriter(MPI_Comm, const std::filesystem::path&, const Provenance&);
  /// Removes the temporary file unless commit succeeded.
  ~CheckpointWriter();

  /// Writes an attribute with rank 0's value.
  void set(const std::string& name, std::int64_t);
  void set(const std::string& name, double);
  void set(const std::string& name, const std::string&);

  /// Writes cell data of a lattice from this rank's boxes, with `components` populations per cell (for 1 the
  /// dataset is [z][y][x]). fill(q, box, out) writes population q of all cells of a box, x fastest, in the
  /// storage format; q is the outer loop. Cells of no rank read as zero.
  void cells(const std::string& name, Storage, std::array<int, 3> lattice, int components,
             const std::vector<CellBox>& boxes,
             const std::function<void(int q, std::size_t box, void* out)>& fill);

  /// Writes a list of cells with `components` populations each, by tiles of a lattice in the order z, y, x.
  /// fill(q, out) writes population q, tile by tile.
  void list(const std::string& name, Storage, const ListedTiles&, int components,
            const std::function<void(int q, void* out)>& fill);

  /// Writes the bodies of all ranks with stored impulses and the named columns of attached state. Each rank
  /// sorts and writes a slice, column by column.
  void bodies(const OwnedRows&, std::span<const AttachedColumn> = {});

  /// Flushes, verifies everything against the checksums, renames, and deletes all but the `keep` newest
  /// checkpoints (0: keeps all) of steps up to this one's. Before, the files of `before` that exist are
  /// synchronised to disk, since the checkpoint relies on them.
  void commit(int keep, const std::vector<std::filesystem::path>& before = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Opens and verifies a checkpoint before anything is read from it. All calls are collective. Errors are
/// std::runtime_error on every rank, with the file, the fault, and the earlier checkpoint to use instead.
class CheckpointReader {
 public:
  CheckpointReader(MPI_Comm, const std::filesystem::path&);
  ~CheckpointReader();

  /// Throws an error that says why the file cannot be used, and which one can.
  [[noreturn]] void refuse(const std::string& what) const;
  /// Throws an error that says why a different case cannot start from this run's checkpoints.
  [[noreturn]] void refuse_case(const std::string& what) const;
  const std::filesystem::path& path() const;
  MPI_Comm comm() const;

  bool has(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double number(const std::string& name) const;
  std::string text(const std::string& name) const;
  std::string provenance(const std::string& name) const;
  std::string case_text() const;

  /// Returns the lattice of a field, and the number of populations per cell of a field or list.
  std::array<int, 3> lattice(const std::string& name) const;
  int components(const std::string& name) const;
  bool is_stored_as(const std::string& name, Storage) const;
  /// Reads this rank's boxes, whichever rank wrote them; take(q, box, in) is the counterpart of fill in
  /// CheckpointWriter::cells. The storage format must agree.
  void cells(const std::string& name, Storage, const std::vector<CellBox>& boxes,
             const std::function<void(int q, std::size_t box, const void* in)>& take) const;

  /// Reads a list, the counterpart of CheckpointWriter::list. Storage format and total length must agree.
  void list(const std::string& name, Storage, const ListedTiles&, int components,
            const std::function<void(int q, const void* in)>& take) const;
  bool has_cells(const std::string& name) const;

  struct Bodies {
    std::uint64_t first_body = 0, first_impulse = 0;  // rows of /bodies and /impulses
    std::vector<rigid::BodyRecord> records;           // sorted by id
    std::vector<std::vector<rigid::StoredImpulse>> impulses;
  };
  /// Returns this rank's slice of the bodies, from n r / ranks on. Other attached bytes are zero.
  Bodies bodies(std::span<const AttachedColumn> = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace silt::adapters
