// What a file manager hands over -> the path of the first file of this machine, or none.
#include <doctest/doctest.h>
#include <unistd.h>

#include <array>
#include <string>

#include "host/uri_list.h"

using thimble::host::first_file_of;

TEST_CASE("uri list: files of this machine -> the first one's path, decoded") {
  std::array<char, 256> own{};
  REQUIRE(::gethostname(own.data(), own.size() - 1) == 0);
  CHECK(first_file_of("file:///tmp/castle.vox") == "/tmp/castle.vox");
  CHECK(first_file_of("file:/tmp/castle.vox\r\n") == "/tmp/castle.vox");
  CHECK(first_file_of("file://localhost/a%20b%C3%a4.vox\r\n") == "/a b\xC3\xA4.vox");
  CHECK(first_file_of("file://" + std::string(own.data()) + "/a") == "/a");
  CHECK(first_file_of("# file:///no\r\nhttp://x/y\r\nfile:///one\r\nfile:///two\r\n") == "/one");
  CHECK(first_file_of("file:///100%25\nfile:///b") == "/100%");
}

TEST_CASE("uri list: no file of this machine, or none that can be -> nothing") {
  for (const std::string list :
       {"", "\r\n", "# file:///a", "http://host/a", "file:", "file://", "file://host",
        "file://elsewhere.invalid/a", "file:relative", "/plain/path", "file:///a%2", "file:///a%",
        "file:///a%zz", "file:///a%00b", "file:///a%+1"}) {
    CAPTURE(list);
    CHECK_FALSE(first_file_of(list));
  }
  CHECK_FALSE(first_file_of(std::string("file:///a\0b", 11)));
}
