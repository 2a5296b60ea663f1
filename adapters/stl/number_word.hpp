#pragma once
// Numbers in the texts that programs of all kinds write.
#include <optional>
#include <string>
#include <string_view>

namespace silt::adapters {

/// Reads the number that a word is: decimal, with an exponent after E or D (Fortran), or hexadecimal with 0x.
/// What stands for no number, as "nan" or "-1.#IND", gives NaN, what stands for infinity that. Nothing for
/// any other word.
std::optional<double> number_in(std::string_view word);

/// Returns what to say of a word that is no finite number: "'1,5' (a decimal comma: write a point)".
std::string shown_word(std::string_view word);

}  // namespace silt::adapters
