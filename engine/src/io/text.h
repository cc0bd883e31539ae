// Small text helpers of the readers: quoting for messages, strict numbers, lists of numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluxfarm {

// The text in double quotes, control characters replaced and long texts cut, fit for one line of a message.
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
