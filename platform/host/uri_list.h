/// What a file manager hands over when files are dragged onto a window: text/uri-list (RFC 2483), a URI a line.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace thimble::host {

/// The path of the first file of this machine in the list: "file:" with no host, "localhost" or this machine's
/// name, %XX decoded (RFC 8089). Lines that begin with # are comments. None where there is no such file, or
/// its path has a byte of 0.
std::optional<std::string> first_file_of(std::string_view uri_list);

}  // namespace thimble::host
