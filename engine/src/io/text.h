// Small text helpers of the readers: quoting for messages, strict numbers, lists of numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluxfarm {

// Whether the bytes are well-formed UTF-8, without overlong forms and surrogates.
bool is_utf8(std::string_view bytes);

// The text with control characters and bytes that are no UTF-8 as question marks: messages travel as UTF-8.
std::string printable(std::string_view bytes);

// The printable text in double quotes, cut if long, fit for one line of a message.
std::string in_quotes(std::string_view text);

// "a, b, c"
std::string joined(const std::vector<std::string>& words);

// Shortest form that reads back as the same float: 0.3, 1e+06.
std::string number_text(double value);

// The whole text as a number, or nothing. Leading and trailing blanks are ignored; NaN and infinity are numbers here.
std::optional<double> parse_number(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);

// "true" or "false" in any case.
std::optional<bool> parse_boolean(std::string_view text);

// Numbers separated by blanks or commas, or nothing if one of them is not a number.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

}  // namespace fluxfarm
