#pragma once
// Where a file came from. Written to every file, in the group /provenance.
#include <cstdint>
#include <string>

namespace silt::adapters {

/// Provenance says where a file came from. Each member becomes an attribute of /provenance, except case_text,
/// which may be long and becomes the scalar string dataset /provenance/case_text. Only rank 0's values are
/// used.
struct Provenance {
  std::string version, commit;   // of silt
  std::string title, case_text;  // case.toml as read, with overrides applied
  std::int64_t ranks = 1;
  std::string backend;  // of the collision detection
  std::string compiler, flags, libraries;
  std::string host, processor, created;  // created: ISO 8601
};

}  // namespace silt::adapters
