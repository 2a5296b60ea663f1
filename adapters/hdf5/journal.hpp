#pragma once
// Private to adapters/hdf5: changes of a file that come all at once or not at all, whenever the process is
// killed. A file driver of HDF5 (H5FDpublic.h) keeps in memory whatever HDF5 writes to a place the file
// already has; what is new goes behind the old end, where nothing refers to it yet. A commit writes the
// changed pages to FILE.journal, under another name first, then to the file, and removes the journal: killed
// before the journal has its name, the file is the old one; afterwards whoever opens it takes the pages from
// the journal. A journal is the eight bytes of `journal_mark`, and for each page its number in the file
// (uint64, little endian) and its content.
#include <hdf5.h>

#include <cstddef>
#include <filesystem>
#include <memory>

namespace silt::adapters::hdf5 {

inline constexpr char journal_mark[9] = "SILTJNL1";
inline constexpr std::size_t journal_page = 4096;  // bytes

std::filesystem::path journal_of(const std::filesystem::path&);

/// An open file that is written through a driver of these. HDF5 is told of no error: it would leave an id
/// behind that it closes once more, and crashes, in MPI_Finalize. Whoever flushes or closes looks here.
struct OutputFile {
  int file = -1;
  int error = 0;  // of the first call that failed, errno; nothing is written any more

  ~OutputFile();
  /// Closes the file. Returns 0, or errno.
  int close();
};

/// Returns the output of a file that HDF5 has open; it stays open as long as anybody holds it.
std::shared_ptr<OutputFile> output_of(hid_t file);

/// Returns the driver, for H5Pset_driver, of files that are written in place.
hid_t in_place_driver();

/// Returns the driver for changes that come all at once; it opens existing files. One to be read is seen with
/// the pages of its journal; to be written, it must have none.
hid_t journaled_driver();

/// Writes the pages of a journal that a killed process left to their file, and removes it. Throws Error.
void finish_journal(const std::filesystem::path&);

/// Writes what has been changed since the file was opened, or since the last commit; HDF5 must have flushed
/// it. Throws Error; unless the journal is then there, whose pages the next one to open the file takes, the
/// file is as it was.
void commit_journaled(hid_t file, const std::filesystem::path&);

}  // namespace silt::adapters::hdf5
