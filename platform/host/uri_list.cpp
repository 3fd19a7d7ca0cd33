#include "host/uri_list.h"

#include <unistd.h>

#include <array>
#include <charconv>

namespace thimble::host {
namespace {

bool is_this_machine(std::string_view name) {
  std::array<char, 256> own{};
  return name.empty() || name == "localhost" ||
         (::gethostname(own.data(), own.size() - 1) == 0 && name == own.data());
}

// None for a % without two hexadecimal digits, and for a byte of 0, which no path has.
std::optional<std::string> decoded(std::string_view text) {
  std::string path;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char character = text[i];
    if (character == '%') {
      unsigned value = 0;
      const std::string_view digits = text.substr(i + 1, 2);
      const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
      if (digits.size() != 2 || read.ptr != digits.data() + 2) {
        return std::nullopt;
      }
      character = static_cast<char>(value);
      i += 2;
    }
    if (character == '\0') {
      return std::nullopt;
    }
    path += character;
  }
  return path;
}

std::optional<std::string> file_of(std::string_view uri) {
  constexpr std::string_view kScheme = "file:";
  if (!uri.starts_with(kScheme)) {
    return std::nullopt;
  }
  uri.remove_prefix(kScheme.size());
  if (uri.starts_with("//")) {
    uri.remove_prefix(2);
    const std::size_t path = uri.find('/');
    if (path == std::string_view::npos || !is_this_machine(uri.substr(0, path))) {
      return std::nullopt;
    }
    uri.remove_prefix(path);
  }
  return uri.starts_with('/') ? decoded(uri) : std::nullopt;
}

}  // namespace

std::optional<std::string> first_file_of(std::string_view uri_list) {
  while (!uri_list.empty()) {
    const std::size_t end = uri_list.find_first_of("\r\n");
    if (auto file = file_of(uri_list.substr(0, end))) {
      return file;
    }
    uri_list.remove_prefix(end == std::string_view::npos ? uri_list.size() : end + 1);
  }
  return std::nullopt;
}

}  // namespace thimble::host
