#include "web/runtime.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <typeinfo>

#include "readers/gltf_file.h"
#include "web/files.h"

// ---- exceptions
//
// Debian's C++ library for WebAssembly knows none, and clang leaves out what would catch one
// (-fignore-exceptions). So whatever is thrown ends the instance: its sentence goes to the page.

extern "C" {

[[clang::import_module("env"), clang::import_name("fail"), noreturn]] void page_fail(const char* sentence,
                                                                                     std::size_t size);

void* __cxa_allocate_exception(std::size_t size) noexcept {
  return std::malloc(size);
}
void __cxa_free_exception(void* thrown) noexcept {
  std::free(thrown);
}

[[noreturn]] void __cxa_throw(void* thrown, std::type_info* type, void (* /*destroy*/)(void*)) {
  // What these sources throw is derived from std::exception and begins with it.
  const auto is_of = [&](const char* name) { return std::strstr(type->name(), name) != nullptr; };
  const std::string what =
      is_of("Shortage")   ? "does not fit the memory that the browser gives"
      : is_of("nlohmann") ? thimble::tools::json_fault(*static_cast<const nlohmann::json::exception*>(thrown))
                          : static_cast<const std::exception*>(thrown)->what();
  const std::string sentence = thimble::tools::model_at_fault() + what;
  page_fail(sentence.data(), sentence.size());
}
[[noreturn]] void __cxa_rethrow() {
  std::abort();
}
void* __cxa_begin_catch(void* /*thrown*/) noexcept {
  std::abort();
}
void __cxa_end_catch() {}
}

// ---- numbers

namespace std {

from_chars_result from_chars(const char* first, const char* last, double& value) {
  // What may belong to it; strtod would read a plus and hexadecimal digits, too.
  const char* end = first;
  while (end != last &&
         (std::isalnum(static_cast<unsigned char>(*end)) != 0 ||
          std::string_view("+-.").find(*end) != std::string_view::npos) &&
         *end != 'x' && *end != 'X') {
    ++end;
  }
  std::string text(first, end);
  char* rest = nullptr;
  const double parsed = std::strtod(text.c_str(), &rest);
  text.resize(static_cast<std::size_t>(rest - text.c_str()));
  if (text.empty() || text[0] == '+') {
    return {first, errc::invalid_argument};
  }
  end = first + text.size();
  // Beyond the range, and below it: the value stays as it was.
  const bool is_word = std::isalpha(static_cast<unsigned char>(text[text[0] == '-' ? 1 : 0])) != 0;
  const bool is_zero =
      text.substr(0, text.find_first_of("eE")).find_first_of("123456789") == std::string::npos;
  if (!is_word && (parsed > numeric_limits<double>::max() || parsed < -numeric_limits<double>::max() ||
                   (parsed == 0 && !is_zero))) {
    return {end, errc::result_out_of_range};
  }
  value = parsed;
  return {end, errc()};
}

}  // namespace std

// In place of the C++ library's, whose tables take 130 KB: as few digits as give the number back. Only
// sentences hold such numbers; where the standard's would write 100000 this may write 1e+05. The linker puts
// it in the place of std::to_chars(char*, char*, double).
extern "C" std::to_chars_result __wrap__ZNSt3__28to_charsEPcS0_d(char* first, char* last, double value) {
  char text[40];
  int size = 0;
  for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    size = std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) {
      break;
    }
  }
  if (last - first < size) {
    return {last, std::errc::value_too_large};
  }
  return {std::copy_n(text, size, first), std::errc()};
}
