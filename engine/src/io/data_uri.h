// URIs as glTF uses them: "data:" with base64, or the name of a file with percent escapes.
//
// [RFC2397] L. Masinter, "The "data" URL scheme", 1998.   [RFC3986] T. Berners-Lee et al., "URI: Generic Syntax", 2005.
#pragma once

#include <string>
#include <string_view>

namespace fluxfarm {

bool is_data_uri(std::string_view uri);

// The bytes of a data URI. Throws SceneError at `place` unless it is base64.
std::string data_uri_bytes(std::string_view uri, const std::string& place);

// The name of a file relative to the one that has the URI. Throws SceneError at `place` for a scheme and for a wrong escape.
std::string file_of_uri(std::string_view uri, const std::string& place);

}  // namespace fluxfarm
