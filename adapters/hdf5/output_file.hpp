#pragma once
// Private to adapters/hdf5: the file driver of HDF5 (H5FDpublic.h) by which all files are read and written.
#include <hdf5.h>

#include <memory>

namespace silt::adapters::hdf5 {

/// OutputFile is the system's file under one that HDF5 has open. HDF5 never sees an error in writing: it
/// would leave an id that it closes again, and crashes, in MPI_Finalize. Calls that flush or close look here.
struct OutputFile {
  int file = -1;
  int error = 0;  // of the first call that failed, errno; nothing is written any more

  ~OutputFile();
  /// Closes the file. Returns 0, or errno.
  int close();

  /// Returns the OutputFile of a file that HDF5 has open; it stays open as long as anybody holds it.
  static std::shared_ptr<OutputFile> of(hid_t file);
  /// Returns the driver, for H5Pset_driver.
  static hid_t driver();
};

}  // namespace silt::adapters::hdf5
