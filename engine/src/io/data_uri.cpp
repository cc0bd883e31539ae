#include "io/data_uri.h"

#include <array>
#include <cstdint>

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr int kNoDigit = -1;

constexpr std::array<int, 256> base64_digits() {
  std::array<int, 256> digits{};
  digits.fill(kNoDigit);
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<int>(i);
  return digits;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return kNoDigit;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::string data_uri_bytes(std::string_view uri, const std::string& place) {
  static constexpr std::array<int, 256> kDigits = base64_digits();
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
    throw SceneError(place, "is the data URI " + in_quotes(uri) + ", expected one with ;base64 and a comma before the data");
  std::string_view text = uri.substr(comma + 1);
  for (int i = 0; i < 2 && text.ends_with('='); ++i) text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t group = 0;
  int bits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int digit = kDigits[static_cast<unsigned char>(text[i])];
    if (digit == kNoDigit)
      throw SceneError(place,
                       "character " + std::to_string(i) + " of the data is " + in_quotes(text.substr(i, 1)) + ", expected base64");
    group = group << 6 | static_cast<std::uint32_t>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<char>(group >> bits & 0xff));
  }
  if (bits == 6) throw SceneError(place, "the base64 data is cut off");
  return bytes;
}

std::string file_of_uri(std::string_view uri, const std::string& place) {
  const std::size_t colon = uri.find(':');
  if (colon != std::string_view::npos && uri.find('/') > colon)
    throw SceneError(place, "is " + in_quotes(uri) + ", expected the name of a file beside this one, or a data URI");
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      name.push_back(uri[i]);
      continue;
    }
    const int high = i + 2 < uri.size() ? hex_digit(uri[i + 1]) : kNoDigit;
    const int low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : kNoDigit;
    if (high == kNoDigit || low == kNoDigit)
      throw SceneError(place, "is " + in_quotes(uri) + ", expected two hexadecimal digits after each %");
    name.push_back(static_cast<char>(16 * high + low));
    i += 2;
  }
  return name;
}

}  // namespace fluxfarm
