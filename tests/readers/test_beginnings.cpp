// Files are looked at before they are loaded, and what is loaded takes memory in proportion.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "readers/file_bytes.h"
#include "readers/read_any.h"
#include "support/counts.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

using namespace thimble::tools;
using thimble::tests::CommandLimits;
using thimble::tests::CommandResult;
using thimble::tests::run_command;
using thimble::tests::TemporaryFolder;

namespace {

/// Writes `count` times `text`, compressed.
std::string write_gzip(const TemporaryFolder& folder, const std::string& name, const std::string& text,
                       int count) {
  return folder.write(name,
                      thimble::tests::repeated(thimble::tests::deflated(text, thimble::tests::kGzip), count));
}

std::string refusal(std::string_view path, const std::string& first) {
  try {
    check_beginning(path, SharedBytes::own(first).bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Holds a command to memory and time: address space, of which the program and its threads take some.
CommandResult limited(const std::vector<std::string>& words, std::uint64_t megabytes) {
  CommandLimits limits;
  limits.address_space_bytes = megabytes << 20;
  limits.seconds = 60;
  return run_command(words, limits);
}

}  // namespace

TEST_CASE("load_file: a look at the first bytes, once -> all that is read where it objects") {
  const TemporaryFolder folder;
  const std::string plain = folder.write("plain", std::string(100000, 'x'));
  const std::string packed = write_gzip(folder, "packed.gz", std::string(1000000, 'y'), 1);
  const std::string small = folder.write("small", "abc");
  for (const std::string& path : {plain, packed, small}) {
    int looks = 0;
    load_file(path, kFileLimitBytes, [&](std::span<const std::uint8_t> first) {
      ++looks;
      CHECK(first.size() == (path == small ? 3 : kFirstLookBytes));
    });
    CHECK(looks == 1);
    CHECK_THROWS_AS(
        load_file(path, kFileLimitBytes, [](std::span<const std::uint8_t>) { throw InputError("no"); }),
        InputError);
  }
}

TEST_CASE("check_beginning: first bytes that no reader takes -> a sentence") {
  CHECK(test::contains(refusal("zero", std::string(4096, '\0')), "neither the name nor the contents"));
  CHECK(test::contains(refusal("a.vox", std::string(4096, '\0')), "VOX"));
  CHECK(test::contains(refusal("a.vox.gz", std::string(4096, '\0')), "VOX"));
  CHECK(test::contains(refusal("a.ply", std::string(4096, ' ')), "'ply'"));
  CHECK(test::contains(refusal("a.obj", "v 1 2 3" + std::string(1, '\0')), "byte offset 7"));
  CHECK(test::contains(refusal("a.csv", std::string(4096, '\n')), "blanks"));
  CHECK(refusal("a.csv", "1 2 3\n").empty());
  CHECK(refusal("a.off", "# a comment\n" + std::string(5000, '#')).empty());
  CHECK(refusal("a.obj", "ply\n").empty());
  for (const ReaderRow& row : reader_rows()) {
    INFO(row.name);
    const std::string endings = row.endings;
    const std::string sentence =
        refusal("a" + endings.substr(0, endings.find(' ')), std::string(4096, '\x07'));
    CHECK((row.beginning != Beginning::kMagic || !sentence.empty()));
  }
}

TEST_CASE("info: endless and bloated files -> refused at once, in little memory, as are rays and bodies") {
  const TemporaryFolder folder;
  const std::string zeros(1 << 20, '\0');
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"info", "/dev/zero"},
           {"info", write_gzip(folder, "zeros.vox.gz", zeros, 256)},
           {"info", write_gzip(folder, "zeros.obj.gz", zeros, 256)},
           {"info", write_gzip(folder, "lines.xyz.gz", std::string(1 << 20, '\n'), 256)},
           {"trace", "spheres", "--threads", "1", "--rays", "/dev/zero"},
           {"particles", "--steps", "1", "--display", "none", "--bodies", "/dev/zero"}}) {
    CAPTURE(words.back());
    const CommandResult result = limited(words, 250);
    CAPTURE(result.describe());
    CHECK(result.status == 1);
    CHECK(thimble::tests::is_one_sentence(result.err));
    CHECK_FALSE(test::contains(result.err, "memory"));
  }
}

TEST_CASE("info: a mesh and a cloud of text -> three times their bytes and 64 MB suffice to read them") {
  const TemporaryFolder folder;
  std::string mesh;
  std::string cloud;
  for (int i = 0; i < 400000; ++i) {
    const std::string numbers = std::to_string(i * 0.731) + " " + std::to_string(i % 977 * 1.13) + " " +
                                std::to_string(i % 1013 * 0.37) + "\n";
    mesh += "v " + numbers;
    cloud += numbers;
  }
  for (int i = 3; i < 400000; ++i) {
    mesh += "f " + std::to_string(i - 2) + " " + std::to_string(i - 1) + " " + std::to_string(i) + "\n";
  }
  // Beside the reader: the program itself, and a tree of depth 4, which needs next to nothing.
  constexpr std::uint64_t kProgramMegabytes = 60;
  for (const auto& [name, text] : {std::pair{"a.obj", &mesh}, std::pair{"a.xyz", &cloud}}) {
    const std::string path = folder.write(name, *text);
    const std::uint64_t megabytes = 3 * (text->size() >> 20) + 64 + kProgramMegabytes;
    const CommandResult result = limited({"info", path, "--depth", "4"}, megabytes);
    CAPTURE(result.describe());
    CAPTURE(megabytes);
    CHECK(result.status == 0);
  }
}

TEST_CASE(
    "info: small files that name much -> what they hold and 64 MB, each file beside them counted once") {
  const TemporaryFolder folder;
  write_gzip(folder, "b.bin.gz", std::string(1 << 20, '\0'), 20);
  std::string gltf = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}])";
  const auto list = [&](const std::string& name, const std::string& begin, const std::string& end) {
    gltf += ",\"" + name + "\":[";
    for (int i = 0; i < 100; ++i) {
      gltf += (i == 0 ? "" : ",") + begin + (end.empty() ? "" : std::to_string(i)) + end;
    }
    gltf += "]";
  };
  list("buffers", R"({"byteLength":20971520,"uri":"b.bin.gz"})", "");
  list("bufferViews", R"({"byteLength":36,"buffer":)", "}");
  list("accessors", R"({"componentType":5126,"count":3,"type":"VEC3","bufferView":)", "}");
  gltf += R"(,"meshes":[{"name":"m")";
  list("primitives", R"({"attributes":{"POSITION":)", "}}");
  const CommandResult many = limited({"info", folder.write("a.gltf", gltf + "}]}"), "--depth", "5"}, 250);
  CAPTURE(many.describe());
  CHECK(many.status == 0);
}

#ifndef __SANITIZE_ADDRESS__
TEST_CASE("info: a hundred million points in 4,096 places -> memory for the places") {
  const bool is_few = thimble::tests::takes_few();
  const char* const points = is_few ? "points:4e7,depth=4" : "points:1e8,depth=4";
  // No limit here: within one, a list of points was cut where it ended before, too.
  CommandLimits limits;
  limits.seconds = 300;
  const CommandResult result = run_command({"info", "--quiet", points}, limits);
  CHECK_MESSAGE(result.status == 0, result.describe());
  CHECK(result.peak_kib < (is_few ? 110 : 250) * 1024);  // the points would take 160, 400 MB
}
#endif
