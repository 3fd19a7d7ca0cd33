// Whole files, gzip, and the cursor that all binary readers use.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <lzma.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "readers/file_bytes.h"
#include "support/counts.h"
#include "support/file_bytes.h"
#include "support/reader_inputs.h"
#include "support/run_command.h"

using namespace thimble::tools;
using test::contains;
using thimble::tests::deflated;
using thimble::tests::TemporaryFolder;

namespace {

using Bytes = std::vector<std::uint8_t>;

std::string noise(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::string bytes(count, 'x');  // the first stays: never a gzip signature by chance
  for (std::size_t i = 1; i < count; ++i) {
    bytes[i] = static_cast<char>(random() >> 24);
  }
  return bytes;
}

std::string gzip(const std::string& bytes) {
  return deflated(bytes, thimble::tests::kGzip);
}

std::string zstd(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  // Checked, so that any damage is seen.
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
  packed.resize(ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size()));
  return packed;
}

std::string xz(const std::string& bytes) {
  Bytes packed(lzma_stream_buffer_bound(bytes.size()));
  std::size_t size = 0;
  REQUIRE(lzma_easy_buffer_encode(1, LZMA_CHECK_CRC32, nullptr,
                                  reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(),
                                  packed.data(), &size, packed.size()) == LZMA_OK);
  return {packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// The ways in which whole files are packed.
struct Packer {
  const char* name;
  std::string (*pack)(const std::string& bytes);
  const char* ending;
};
constexpr Packer kPackers[] = {{"gzip", gzip, ".gz"}, {"zstd", zstd, ".zst"}, {"xz", xz, ".xz"}};

std::string loaded(const std::string& path, std::uint64_t limit_bytes = kFileLimitBytes) {
  return std::string(load_file(path, limit_bytes).text());
}

std::string refusal(const std::string& path, std::uint64_t limit_bytes = kFileLimitBytes) {
  try {
    load_file(path, limit_bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// What `load_file` makes of `bytes` that come through a pipe.
std::string loaded_from_pipe(const std::string& bytes) {
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
  std::string result;
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
  const TemporaryFolder folder;
  for (const std::size_t size : {1u, 2u, 65535u, 65536u, 65537u, 131072u, 300000u}) {
    CAPTURE(size);
    const std::string bytes = noise(size, 1);
    CHECK(loaded(folder.write("plain", bytes)) == bytes);
  }
}

TEST_CASE("load_file: packed by name or only by signature -> what it holds") {
  const TemporaryFolder folder;
  for (const Packer& packer : kPackers) {
    CAPTURE(packer.name);
    const auto name = [&](const char* stem) { return std::string(stem) + packer.ending; };
    for (const std::size_t size : {1u, 65536u, 300000u}) {
      CAPTURE(size);
      const std::string bytes = noise(size, 2);
      CHECK(loaded(folder.write(name("named"), packer.pack(bytes))) == bytes);
      CHECK(loaded(folder.write("unnamed", packer.pack(bytes))) == bytes);
    }
    const std::string zeros(3'000'000, '\0');  // far more comes out than goes in
    CHECK(loaded(folder.write(name("zeros"), packer.pack(zeros))) == zeros);
    CHECK(contains(refusal(folder.write(name("plain"), noise(100, 7))),
                   std::string(packer.name) + " signature"));
    CHECK(refusal(folder.write(name("nothing"), packer.pack(""))) ==
          std::string(packer.name) + " data holds no bytes");
  }
  CHECK(loaded(folder.write("other.gz", zstd(noise(100, 3)))) == noise(100, 3));
}

TEST_CASE("load_file: beyond 256 MiB, more than a hundred to one -> refused; less of either -> read") {
  const TemporaryFolder folder;
  const std::string zeros(std::size_t{65} << 20, '\0');
  for (const Packer& packer : kPackers) {
    CAPTURE(packer.name);
    if (thimble::tests::takes_few() && packer.pack == xz) {
      continue;  // it takes five seconds
    }
    const std::string part = packer.pack(zeros);
    REQUIRE(part.size() < zeros.size() / 100);
    const std::string three = part + part + part;
    CHECK(contains(refusal(folder.write("four", three + part)), "inflates to more than 256 MiB"));
    if (packer.pack == gzip) {
      CHECK(load_file(folder.write("three", three)).bytes.size() == 3 * zeros.size());
      const std::string hard = gzip(noise(std::size_t{3} << 20, 11));
      CHECK(load_file(folder.write("hard", hard + three + part)).bytes.size() > 4 * zeros.size());
    }
  }
}

TEST_CASE("load_file: several members and zero padding -> all members in order") {
  const TemporaryFolder folder;
  const std::string a = noise(70000, 3), b = noise(5, 4);
  for (const auto& [each_name, pack, ending] : kPackers) {
    const auto& name = each_name;
    CAPTURE(name);
    CHECK(loaded(folder.write("two", pack(a) + pack(b))) == a + b);
    CHECK(loaded(folder.write("padded", pack(a) + std::string(100000, '\0'))) == a);
    CHECK(loaded(folder.write("gap", pack(a) + std::string(512, '\0') + pack(b))) == a + b);
    CHECK(loaded(folder.write("empty_member", pack("") + pack(b))) == b);
  }
  for (int kind = 0x50; kind <= 0x5f; ++kind) {  // for those who seek
    const std::string table{static_cast<char>(kind), 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 1, 2, 3};
    CHECK(loaded(folder.write("table", zstd(a) + table)) == a);
  }
}

TEST_CASE("load_file: a pipe, plain or gzip -> read to its end") {
  const std::string bytes = noise(300000, 5);
  CHECK(loaded_from_pipe(bytes) == bytes);
  CHECK(loaded_from_pipe(gzip(bytes)) == bytes);
}

TEST_CASE("load_file: exactly the limit -> read, one byte more -> refused with the limit") {
  const TemporaryFolder folder;
  for (const std::size_t size : {1u, 1000u, 65536u, 200000u}) {
    CAPTURE(size);
    const std::string bytes = noise(size + 1, 6);
    const std::string fits = bytes.substr(0, size);
    CHECK(loaded(folder.write("fits", fits), size) == fits);
    CHECK(loaded(folder.write("fits.gz", gzip(fits)), size) == fits);
    const std::string sentence = "holds more than the limit of " + std::to_string(size) + " bytes";
    CHECK(refusal(folder.write("over", bytes), size) == sentence);
    CHECK(refusal(folder.write("over.gz", gzip(bytes)), size) == sentence);
  }
}

TEST_CASE("load_file: a sparse file over the limit -> refused before it is read") {
  const TemporaryFolder folder;
  const std::string path = folder.write("sparse", "a");
  REQUIRE(::truncate(path.c_str(), off_t{1} << 40) == 0);
  CHECK(contains(refusal(path), "limit of 4294967296 bytes"));
}

TEST_CASE("load_file: what cannot be read -> a sentence with the reason") {
  const TemporaryFolder folder;
  CHECK(refusal(folder.path("missing")) == "cannot be opened: No such file or directory");
  CHECK(refusal(folder.path("")) == "is a directory, not a file");
  CHECK(refusal(folder.write("empty", "")) == "is empty");
  CHECK(refusal("/dev/null") == "is empty");

  const std::string secret = folder.write("secret", "a");
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

TEST_CASE("load_file: packed data cut off anywhere -> refused") {
  const TemporaryFolder folder;
  for (const Packer& packer : kPackers) {
    const std::string whole = packer.pack(noise(150, 8));
    for (std::size_t length = 6; length < whole.size(); ++length) {
      CAPTURE(length);
      const std::string path = folder.write("cut", whole.substr(0, length));
      CHECK(contains(refusal(path), std::string(packer.name) + " data is truncated"));
    }
  }
}

TEST_CASE(
    "load_file: packed data with any one bit flipped -> refused, or the same bytes where it was decoration") {
  const TemporaryFolder folder;
  const std::string bytes = noise(40, 9);
  for (const Packer& packer : kPackers) {
    CAPTURE(packer.name);
    std::string damaged = packer.pack(bytes);
    int refused = 0;
    for (std::size_t bit = 48; bit < damaged.size() * 8; ++bit) {  // behind the signature
      CAPTURE(bit);
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
      const std::string path = folder.write("flipped", damaged);
      try {
        const std::string read = loaded(path);
        CHECK(read == bytes);
      } catch (const InputError& error) {
        CHECK(contains(error.what(), std::string(packer.name) + " data"));
        ++refused;
      }
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    }
    CHECK(refused > 300);
  }
}

TEST_CASE("load_file: something else behind packed data -> refused with the offset") {
  const TemporaryFolder folder;
  for (const Packer& packer : kPackers) {
    const std::string member = packer.pack(noise(50, 10));
    const std::string sentence = refusal(folder.write("tail", member + std::string("\0\0x", 3)));
    CHECK(contains(sentence, "byte offset " + std::to_string(member.size() + 2)));
  }
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
  CHECK(again.u16() == 0xfd02);
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
