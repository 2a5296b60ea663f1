#pragma once
// What a file is whose name says that it holds a surface, but that holds something else.
#include <string_view>

namespace silt::adapters {

/// Takes the byte order mark of UTF-8 off.
std::string_view without_mark(std::string_view bytes);

/// Throws std::invalid_argument for bytes that are none of a surface: none at all, a page of the web, a
/// pointer of Git LFS, an archive, text in UTF-16. It says what they are and what to do.
void refuse_foreign(std::string_view bytes);

}  // namespace silt::adapters
