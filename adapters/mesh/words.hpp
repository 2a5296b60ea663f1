#pragma once
// The words and numbers of the texts that programs of all kinds write, and what such a file is if it holds no
// surface at all.
#include <optional>
#include <string>
#include <string_view>

namespace silt::adapters {

/// Takes the next word, which ends at white space, off a text; "" at its end.
std::string_view next_word(std::string_view& text);

/// Reads the number that a word is: decimal, with an exponent after E or D (Fortran), or hexadecimal with 0x.
/// What stands for no number, as "nan" or "-1.#IND", gives NaN, what stands for infinity that. Nothing for
/// any other word.
std::optional<double> number_in(std::string_view word);

/// Returns what to say of a word that is no finite number: "'1,5' (a decimal comma: write a point)".
std::string shown_word(std::string_view word);

/// Takes the byte order mark of UTF-8 off.
std::string_view without_mark(std::string_view bytes);

/// Throws std::invalid_argument for bytes that are none of a surface: none at all, a page of the web, a
/// pointer of Git LFS, an archive, text in UTF-16. It says what they are and what to do.
void refuse_foreign(std::string_view bytes);

}  // namespace silt::adapters
