// Whole files, gzip, and the cursor that all binary readers use.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "readers/file_bytes.h"
#include "support/file_bytes.h"
#include "support/run_command.h"

using namespace thimble::tools;

namespace {

using Bytes = std::vector<std::uint8_t>;

/// A folder for files of bytes.
class BytesFolder : public thimble::tests::TemporaryFolder {
 public:
  std::string write(const std::string& name, const Bytes& bytes) const {
    return TemporaryFolder::write(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
};

Bytes noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Bytes bytes(count);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random() >> 24);
  }
  if (!bytes.empty()) {
    bytes[0] = 'x';  // never a gzip signature by chance
  }
  return bytes;
}

Bytes gzip(const Bytes& bytes) {
  const std::string packed = thimble::tests::deflated({bytes.begin(), bytes.end()}, thimble::tests::kGzip);
  return {packed.begin(), packed.end()};
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Bytes loaded(const std::string& path, std::uint64_t limit_bytes = kFileLimitBytes) {
  const FileBytes file = load_file(path, limit_bytes);
  return {file.bytes().begin(), file.bytes().end()};
}

std::string refusal(const std::string& path, std::uint64_t limit_bytes = kFileLimitBytes) {
  try {
    load_file(path, limit_bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// What `load_file` makes of `bytes` that come through a pipe.
Bytes loaded_from_pipe(const Bytes& bytes) {
  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  std::thread writer([&] {
    std::size_t done = 0;
    while (done < bytes.size()) {
      // Odd, small pieces: a reader must put up with short reads.
      const ssize_t wrote =
          ::write(ends[1], bytes.data() + done, std::min<std::size_t>(bytes.size() - done, 7777));
      if (wrote <= 0) {
        break;
      }
      done += static_cast<std::size_t>(wrote);
    }
    ::close(ends[1]);
  });
  Bytes result;
  try {
    result = loaded("/dev/fd/" + std::to_string(ends[0]));
  } catch (const InputError& error) {
    FAIL_CHECK(error.what());
  }
  ::close(ends[0]);
  writer.join();
  return result;
}

}  // namespace

TEST_CASE("load_file: plain files of any length -> their bytes") {
  const BytesFolder folder;
  for (const std::size_t size : {1u, 2u, 65535u, 65536u, 65537u, 131072u, 300000u}) {
    CAPTURE(size);
    const Bytes bytes = noise(size, 1);
    CHECK(loaded(folder.write("plain", bytes)) == bytes);
  }
}

TEST_CASE("load_file: gzip by name or only by signature -> what it holds") {
  const BytesFolder folder;
  for (const std::size_t size : {1u, 65536u, 300000u}) {
    CAPTURE(size);
    const Bytes bytes = noise(size, 2);
    CHECK(loaded(folder.write("named.gz", gzip(bytes))) == bytes);
    CHECK(loaded(folder.write("unnamed", gzip(bytes))) == bytes);
  }
  const Bytes zeros(3'000'000, 0);  // far more comes out than goes in
  CHECK(loaded(folder.write("zeros.gz", gzip(zeros))) == zeros);
}

TEST_CASE("load_file: gzip of several members and zero padding -> all members in order") {
  const BytesFolder folder;
  const Bytes a = noise(70000, 3), b = noise(5, 4);
  const Bytes none;
  CHECK(loaded(folder.write("two.gz", gzip(a) + gzip(b))) == a + b);
  CHECK(loaded(folder.write("padded.gz", gzip(a) + Bytes(100000, 0))) == a);
  CHECK(loaded(folder.write("gap.gz", gzip(a) + Bytes(512, 0) + gzip(b))) == a + b);
  CHECK(loaded(folder.write("empty_member.gz", gzip(none) + gzip(b))) == b);
}

TEST_CASE("load_file: a pipe, plain or gzip -> read to its end") {
  const Bytes bytes = noise(300000, 5);
  CHECK(loaded_from_pipe(bytes) == bytes);
  CHECK(loaded_from_pipe(gzip(bytes)) == bytes);
}

TEST_CASE("load_file: exactly the limit -> read, one byte more -> refused with the limit") {
  const BytesFolder folder;
  for (const std::size_t size : {1u, 1000u, 65536u, 200000u}) {
    CAPTURE(size);
    const Bytes bytes = noise(size + 1, 6);
    const Bytes fits(bytes.begin(), bytes.end() - 1);
    CHECK(loaded(folder.write("fits", fits), size) == fits);
    CHECK(loaded(folder.write("fits.gz", gzip(fits)), size) == fits);
    const std::string sentence = "holds more than the limit of " + std::to_string(size) + " bytes";
    CHECK(refusal(folder.write("over", bytes), size) == sentence);
    CHECK(refusal(folder.write("over.gz", gzip(bytes)), size) == sentence);
  }
}

TEST_CASE("load_file: a gzip bomb -> refused at the limit, without the memory it asks for") {
  const BytesFolder folder;
  const Bytes bomb = gzip(Bytes(32u << 20, 0));
  REQUIRE(bomb.size() < 64 * 1024);
  CHECK(contains(refusal(folder.write("bomb.gz", bomb), 1 << 20), "limit of 1048576 bytes"));
}

TEST_CASE("load_file: a sparse file over the limit -> refused before it is read") {
  const BytesFolder folder;
  const std::string path = folder.write("sparse", {'a'});
  REQUIRE(::truncate(path.c_str(), off_t{1} << 40) == 0);
  CHECK(contains(refusal(path), "limit of 4294967296 bytes"));
}

TEST_CASE("load_file: what cannot be read -> a sentence with the reason") {
  const BytesFolder folder;
  CHECK(refusal(folder.path("missing")) == "cannot be opened: No such file or directory");
  CHECK(refusal(folder.path("")) == "is a directory, not a file");
  CHECK(refusal(folder.write("empty", {})) == "is empty");
  CHECK(refusal("/dev/null") == "is empty");
  CHECK(contains(refusal(folder.write("plain.gz", noise(100, 7))), "gzip signature"));
  CHECK(refusal(folder.write("nothing.gz", gzip({}))) == "gzip data holds no bytes");

  const std::string secret = folder.write("secret", {'a'});
  REQUIRE(::chmod(secret.c_str(), 0) == 0);
  const bool root = ::geteuid() == 0;  // root reads everything
  if (root && ::seteuid(65534) != 0) {
    MESSAGE("skipped: cannot give up root to test permissions");
    return;
  }
  const std::string denied = refusal(secret);
  if (root) {
    REQUIRE(::seteuid(0) == 0);
  }
  CHECK(denied == "cannot be opened: Permission denied");
}

TEST_CASE("load_file: gzip cut off anywhere -> refused") {
  const BytesFolder folder;
  const Bytes whole = gzip(noise(500, 8));
  for (std::size_t length = 2; length < whole.size(); ++length) {
    CAPTURE(length);
    const std::string path =
        folder.write("cut.gz", Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    CHECK(contains(refusal(path), "gzip data is truncated"));
  }
}

TEST_CASE("load_file: gzip with any one bit flipped -> refused, or the same bytes where it was decoration") {
  const BytesFolder folder;
  const Bytes bytes = noise(40, 9);
  Bytes damaged = gzip(bytes);
  int refused = 0;
  for (std::size_t bit = 16; bit < damaged.size() * 8; ++bit) {
    CAPTURE(bit);
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    const std::string path = folder.write("flipped.gz", damaged);
    try {
      const Bytes read = loaded(path);
      CHECK(read == bytes);
    } catch (const InputError& error) {
      CHECK(contains(error.what(), "gzip data"));
      ++refused;
    }
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  }
  CHECK(refused > 300);
}

TEST_CASE("load_file: something else behind gzip data -> refused with the offset") {
  const BytesFolder folder;
  const Bytes member = gzip(noise(50, 10));
  const std::string sentence = refusal(folder.write("tail.gz", member + Bytes{0, 0, 'x'}));
  CHECK(contains(sentence, "byte offset " + std::to_string(member.size() + 2)));
}

TEST_CASE("FileBytes: moved -> the bytes stay in place and the old one is empty") {
  FileBytes first = FileBytes::copy_of(Bytes{1, 2, 3});
  const std::uint8_t* at = first.bytes().data();
  const FileBytes second = std::move(first);
  CHECK(second.bytes().data() == at);
  CHECK(second.size() == 3);
  CHECK(first.size() == 0);  // NOLINT: what a move leaves is promised
  CHECK(FileBytes::copy_of({}).size() == 0);
  CHECK(FileBytes::copy_of(Bytes{'o', 'k'}).text() == "ok");
}

TEST_CASE("ByteReader: numbers of each width and order -> their values") {
  const Bytes bytes{0x01, 0xff, 0xfe, 0x01, 0x02, 0xfd, 0xff, 0xff, 0xff, 0x01, 0x02,
                    0x03, 0x84, 1,    2,    3,    4,    5,    6,    7,    8};
  ByteReader reader(bytes);
  CHECK(reader.u8() == 1);
  CHECK(reader.i8() == -1);
  CHECK(reader.u16() == 0x01fe);
  CHECK(reader.u8() == 2);
  CHECK(reader.i32() == -3);
  CHECK(reader.u32() == 0x84030201u);
  CHECK(reader.u64() == 0x0807060504030201u);
  CHECK(reader.remaining() == 0);

  ByteReader again(bytes);
  CHECK(again.u16_be() == 0x01ff);
  CHECK(again.i16_be() == -511);
  CHECK(again.i16() == -766);
  CHECK(again.i32_be() == -255);
  CHECK(again.u8() == 2);
  CHECK(again.u16_be() == 0x0384);
  CHECK(again.u64_be() == 0x0102030405060708u);

  const Bytes reals{0,    0,    0xc0, 0x3f, 0, 0, 0, 0, 0,    0,    0xf8, 0xbf, 0x3f, 0xc0, 0, 0,
                    0xbf, 0xf8, 0,    0,    0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0x80, 0,    0, 0};
  ByteReader floats(reals);
  CHECK(floats.f32() == 1.5f);
  CHECK(floats.f64() == -1.5);
  CHECK(load_number(floats.take(4).data(), {'f', 4}, true) == 1.5);
  CHECK(load_number(floats.take(8).data(), {'f', 8}, true) == -1.5);
  CHECK(std::isnan(floats.f32()));
  CHECK(floats.u32_be() == 0x80000000u);
  CHECK(load_number(bytes.data(), {'i', 2}, true) == 511);
  CHECK(load_number(bytes.data() + 1, {'i', 1}, false) == -1);
  CHECK(load_number(bytes.data() + 1, {'u', 1}, false) == 255);
}

TEST_CASE("ByteReader: a read past the end -> an error with place and offset, and the cursor stays") {
  const Bytes bytes(10, 7);
  ByteReader reader(bytes, "header", 100);
  reader.skip(3);
  CHECK(reader.offset() == 103);
  CHECK_THROWS_WITH_AS(
      reader.f64(), "header: truncated at byte offset 103: 8 bytes are needed and 7 are there", InputError);
  CHECK(reader.remaining() == 7);
  CHECK_THROWS_AS(reader.skip(8), InputError);
  CHECK_THROWS_AS(reader.take(UINT64_MAX), InputError);
  CHECK_THROWS_AS(reader.sub(8, "x"), InputError);

  ByteReader part = reader.sub(4, "inner");
  CHECK(reader.offset() == 107);
  CHECK(part.offset() == 103);
  part.skip(2);
  CHECK_THROWS_WITH_AS(part.u32_be(),
                       "inner: truncated at byte offset 105: 4 bytes are needed and 2 are there", InputError);
  CHECK(part.u16() == 0x0707);
  CHECK_THROWS_AS(part.u8(), InputError);
  CHECK(reader.take(3).size() == 3);
  CHECK(reader.take(0).empty());
}
