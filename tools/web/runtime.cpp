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

namespace {

// The end of the number that stands at `at`, as the standard's std::from_chars reads it; `at` where there is
// none.
const char* end_of_number(const char* at, const char* last) {
  const char* here = at;
  const auto digits = [&] {
    const char* const from = here;
    while (here != last && std::isdigit(static_cast<unsigned char>(*here)) != 0) {
      ++here;
    }
    return here - from;
  };
  const auto word = [&](const char* text) {
    const auto size = static_cast<std::ptrdiff_t>(std::strlen(text));
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      if (last - here <= i || std::tolower(static_cast<unsigned char>(here[i])) != text[i]) {
        return false;
      }
    }
    here += size;
    return true;
  };
  if (here != last && *here == '-') {
    ++here;
  }
  if (word("infinity") || word("inf") || word("nan")) {
    return here;
  }
  std::ptrdiff_t count = digits();
  if (here != last && *here == '.') {
    ++here;
    const std::ptrdiff_t behind = digits();
    count += behind;
    if (count == 0) {
      return at;
    }
  }
  if (count == 0) {
    return at;
  }
  if (here != last && (*here == 'e' || *here == 'E')) {
    const char* const mantissa = here++;
    if (here != last && (*here == '+' || *here == '-')) {
      ++here;
    }
    if (digits() == 0) {
      here = mantissa;
    }
  }
  return here;
}

}  // namespace

namespace std {

from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* const end = end_of_number(first, last);
  if (end == first) {
    return {first, errc::invalid_argument};
  }
  const std::string text(first, static_cast<std::size_t>(end - first));
  const double parsed = std::strtod(text.c_str(), nullptr);
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
