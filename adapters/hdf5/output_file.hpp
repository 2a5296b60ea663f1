#pragma once
// Private to adapters/hdf5: the HDF5 file driver (H5FDpublic.h) for all files.
#include <hdf5.h>

#include <memory>

namespace silt::adapters::hdf5 {

/// The system's file under an open HDF5 file. HDF5 is never told of write errors: it would leave an id that
/// it closes again, and crashes, in MPI_Finalize. Instead, calls that flush or close check `error`.
struct OutputFile {
  int file = -1;
  int error = 0;  // errno of the first failure, after which nothing is written

  ~OutputFile();
  /// Closes the file. Returns 0 or errno.
  int close();

  /// Returns the OutputFile of an open HDF5 file; it stays open while the pointer exists.
  static std::shared_ptr<OutputFile> of(hid_t file);
  /// Returns the driver, for H5Pset_driver.
  static hid_t driver();
};

}  // namespace silt::adapters::hdf5
