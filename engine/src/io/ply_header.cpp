#include "io/ply_header.h"

#include <optional>
#include <sstream>

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

std::optional<PlyType> type_of(const std::string& name) {
  if (name == "char" || name == "int8") return PlyType::kInt8;
  if (name == "uchar" || name == "uint8") return PlyType::kUint8;
  if (name == "short" || name == "int16") return PlyType::kInt16;
  if (name == "ushort" || name == "uint16") return PlyType::kUint16;
  if (name == "int" || name == "int32") return PlyType::kInt32;
  if (name == "uint" || name == "uint32") return PlyType::kUint32;
  if (name == "float" || name == "float32") return PlyType::kFloat32;
  if (name == "double" || name == "float64") return PlyType::kFloat64;
  return std::nullopt;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// Reads the header line by line.
class HeaderParser {
 public:
  HeaderParser(const std::string& file, const std::string& name) : file_(file), name_(name) {}

  PlyHeader parse() {
    if (next_line() != std::vector<std::string>{"ply"}) fail("expected \"ply\"");
    bool has_format = false;
    for (std::vector<std::string> words = next_line(); words != std::vector<std::string>{"end_header"}; words = next_line()) {
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "format") {
        read_format(words);
        has_format = true;
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        fail("unknown header line " + in_quotes(words[0]) + ", expected format, element, property, comment or end_header");
      }
    }
    if (!has_format) fail("the header has no format");
    header_.size = position_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(name_ + ":" + std::to_string(line_), "bad PLY header: " + what);
  }

  std::vector<std::string> next_line() {
    ++line_;
    if (position_ >= file_.size()) fail("the file ends before end_header");
    const std::size_t end = std::min(file_.find('\n', position_), file_.size());
    const std::string line = file_.substr(position_, std::min(end - position_, std::size_t{1024}));
    position_ = std::min(end + 1, file_.size());
    return words_of(line);
  }

  void read_format(const std::vector<std::string>& words) {
    if (words.size() != 3 || words[2] != "1.0") fail("expected a format of version 1.0");
    if (words[1] == "ascii") {
      header_.encoding = PlyEncoding::kAscii;
    } else if (words[1] == "binary_little_endian") {
      header_.encoding = PlyEncoding::kBinaryLittleEndian;
    } else if (words[1] == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBinaryBigEndian;
    } else {
      fail("format " + in_quotes(words[1]) + ", expected ascii, binary_little_endian or binary_big_endian");
    }
  }

  void read_element(const std::vector<std::string>& words) {
    const std::optional<std::int64_t> count = words.size() == 3 ? parse_integer(words[2]) : std::nullopt;
    if (!count || *count < 0) fail("expected \"element NAME COUNT\" with a count of at least 0");
    header_.elements.push_back({words[1], static_cast<std::uint64_t>(*count), {}});
  }

  void read_property(const std::vector<std::string>& words) {
    if (header_.elements.empty()) fail("a property stands before the first element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) fail("expected \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
    const std::optional<PlyType> type = type_of(words[words.size() - 2]);
    const std::optional<PlyType> count_type = list ? type_of(words[2]) : PlyType::kUint8;
    if (!type || !count_type) fail("unknown type in " + in_quotes(joined(words)));
    if (list && (*count_type == PlyType::kFloat32 || *count_type == PlyType::kFloat64))
      fail("the length of a list must have an integer type");
    PlyElement& element = header_.elements.back();
    if (element.find(words.back()) >= 0) fail("property " + in_quotes(words.back()) + " occurs twice");
    element.properties.push_back({words.back(), *type, list, *count_type});
  }

  const std::string& file_;
  const std::string& name_;
  PlyHeader header_;
  std::size_t position_ = 0, line_ = 0;
};

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8: return 1;
    case PlyType::kInt16:
    case PlyType::kUint16: return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32: return 4;
    case PlyType::kFloat64: return 8;
  }
  return 0;
}

int PlyElement::find(const std::string& property) const {
  for (std::size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property) return static_cast<int>(i);
  }
  return -1;
}

std::uint64_t PlyElement::smallest_row(PlyEncoding encoding) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) {
    if (encoding == PlyEncoding::kAscii) {
      bytes += 2;  // a digit and a blank
    } else {
      bytes += size_of(property.list ? property.count_type : property.type);
    }
  }
  return bytes;
}

PlyHeader parse_ply_header(const std::string& file, const std::string& name) { return HeaderParser(file, name).parse(); }

}  // namespace fluxfarm
