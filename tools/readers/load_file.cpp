// Files and what is packed in them, as bytes: what of file_bytes.h needs a system, zlib, liblzma and libzstd.
#include "readers/file_bytes.h"

#include <fcntl.h>
#include <lzma.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>

#include "output/file_place.h"
#include "readers/text.h"

namespace thimble::tools {

namespace {

constexpr std::size_t kStepBytes = 64 * 1024;
// Scenes of mostly air are packed well, too; past this many bytes they are not believed more than that many to one.
constexpr std::uint64_t kBelievedBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kBelievedRatio = 100;

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// An open file, closed on every way out.
class Descriptor {
 public:
  explicit Descriptor(const std::string& path) {
    claim_input(path);
    do {
      fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    } while (fd_ < 0 && errno == EINTR);
    if (fd_ < 0 && (errno == EMFILE || errno == ENFILE || errno == ENOMEM)) {
      throw ShortageError("cannot be opened: " + reason(errno));
    }
    fail_if(fd_ < 0, "cannot be opened: ", reason(errno));
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { ::close(fd_); }

  /// Size of a regular file, 0 where only reading to the end tells.
  std::uint64_t size_hint_bytes() const {
    struct stat status {};
    const bool is_known = ::fstat(fd_, &status) == 0;
    fail_if(!is_known, "cannot be examined: ", reason(errno));
    fail_if(S_ISDIR(status.st_mode), "is a directory, not a file");
    return S_ISREG(status.st_mode) && status.st_size > 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  }

  /// All `size` bytes of a regular file, to be read where they lie; none where the system does not map it.
  SharedBytes map(std::size_t size) const {
    void* const address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd_, 0);
    if (address == MAP_FAILED) {
      return {};
    }
    const std::shared_ptr<const void> owner(address, [size](void* first) { ::munmap(first, size); });
    return {{static_cast<const std::uint8_t*>(address), size}, owner};
  }

  /// Reads until `count` bytes are there or the file ends: a pipe may hand out fewer.
  std::size_t read(std::uint8_t* to, std::size_t count) const {
    std::size_t done = 0;
    while (done < count) {
      // Linux transfers at most 2^31 - 4096 bytes a call; asking for less keeps every system happy.
      const ssize_t got = ::read(fd_, to + done, std::min(count - done, std::size_t{1} << 30));
      if (got < 0 && errno == EINTR) {
        continue;
      }
      if (got < 0) {
        throw InputError("cannot be read: ", reason(errno));
      }
      if (got == 0) {
        break;
      }
      done += static_cast<std::size_t>(got);
    }
    return done;
  }

 private:
  int fd_ = -1;
};

}  // namespace

/// Bytes that arrive in unknown number. `realloc` lets large blocks grow without a second copy in memory, and
/// room that nothing was written to yet costs no physical memory.
class FileBuffer {
 public:
  explicit FileBuffer(std::uint64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Room for at least one more byte and at most one byte past the limit, which is how an excess shows.
  std::span<std::uint8_t> room() {
    if (size_ == capacity_) {
      grow();
    }
    return {data_.get() + size_, capacity_ - size_};
  }
  void reserve(std::uint64_t capacity) {
    capacity = std::min(capacity, limit_bytes_ + 1);
    check_memory(capacity <= capacity_ || resize(capacity));
  }
  /// `count` bytes of `room()` were written.
  void grew(std::size_t count) {
    size_ += count;
    check_size(size_, limit_bytes_);
  }
  /// They were inflated, and all so far from `packed_bytes`.
  void grew_from(std::uint64_t packed_bytes, std::size_t count) {
    grew(count);
    fail_if(size_ > kBelievedBytes && size_ / kBelievedRatio > packed_bytes,
            "inflates to more than 256 MiB, more than ", kBelievedRatio, " times what it takes packed");
  }
  std::size_t size() const { return size_; }
  std::span<const std::uint8_t> bytes() const { return {data_.get(), size_}; }
  SharedBytes finish() {
    if (size_ != 0 && size_ < capacity_) {
      static_cast<void>(resize(size_));  // what stays larger is as good
    }
    return {bytes(), std::shared_ptr<const void>(std::move(data_))};
  }
  static void check_size(std::uint64_t size_bytes, std::uint64_t limit_bytes) {
    fail_if(size_bytes > limit_bytes, "holds more than the limit of ", limit_bytes, " bytes");
  }

 private:
  /// Twice the room; where this machine does not have that, half as much more, and so on.
  void grow() {
    bool has_room = false;
    for (std::uint64_t more = std::max<std::uint64_t>(kStepBytes, capacity_); !has_room && more >= kStepBytes;
         more /= 2) {
      has_room = resize(std::min(capacity_ + more, limit_bytes_ + 1));
    }
    check_memory(has_room);
  }
  void check_memory(bool has_room) const {
    fail_if(!has_room, "does not fit the memory that is left on this machine: ", size_, " bytes of it did");
  }
  bool resize(std::uint64_t capacity) {
    void* moved =
        capacity > SIZE_MAX ? nullptr : std::realloc(data_.get(), static_cast<std::size_t>(capacity));
    if (moved == nullptr) {
      return false;
    }
    static_cast<void>(data_.release());
    data_.reset(static_cast<std::uint8_t*>(moved));
    capacity_ = static_cast<std::size_t>(capacity);
    return true;
  }

  struct Free {
    void operator()(std::uint8_t* data) const { std::free(data); }
  };
  std::unique_ptr<std::uint8_t, Free> data_;
  std::size_t size_ = 0, capacity_ = 0;
  std::uint64_t limit_bytes_;
};

namespace {

/// Asks `look` once, as soon as there is enough to look at.
class Looker {
 public:
  explicit Looker(const FirstLook& look) : look_(look) {}
  void at(std::span<const std::uint8_t> bytes, bool is_all) {
    if (!asked_ && (is_all || bytes.size() >= kFirstLookBytes)) {
      asked_ = true;
      if (look_ && !bytes.empty()) {
        look_(bytes.first(std::min(bytes.size(), kFirstLookBytes)));
      }
    }
  }

 private:
  const FirstLook& look_;
  bool asked_ = false;
};

/// What takes packed bytes apart, one member of a file after another.
class Unpacker {
 public:
  struct Step {
    std::size_t taken = 0, made = 0;  ///< bytes
    bool is_end = false;              ///< of the member
    const char* fault = nullptr;      ///< what is wrong with the bytes
  };
  virtual ~Unpacker() = default;
  /// Takes some of `packed` and writes to `room`.
  virtual Step step(std::span<const std::uint8_t> packed, std::span<std::uint8_t> room) = 0;
};

class ZlibUnpacker final : public Unpacker {
 public:
  explicit ZlibUnpacker(int window) {
    fail_if(inflateInit2(&stream_, window) != Z_OK, "zlib does not start");
  }
  ZlibUnpacker(const ZlibUnpacker&) = delete;
  ZlibUnpacker& operator=(const ZlibUnpacker&) = delete;
  ~ZlibUnpacker() override { inflateEnd(&stream_); }

  Step step(std::span<const std::uint8_t> packed, std::span<std::uint8_t> room) override {
    constexpr std::size_t kMost = std::size_t{1} << 30;  // what zlib's counters hold
    stream_.next_in = const_cast<Bytef*>(packed.data());
    stream_.avail_in = static_cast<uInt>(std::min(packed.size(), kMost));
    stream_.next_out = room.data();
    stream_.avail_out = static_cast<uInt>(std::min(room.size(), kMost));
    const int result = inflate(&stream_, Z_NO_FLUSH);
    const bool is_good = result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR;
    const char* const reason = stream_.msg != nullptr ? stream_.msg : "zlib refuses it";
    return {static_cast<std::size_t>(stream_.next_in - packed.data()),
            static_cast<std::size_t>(stream_.next_out - room.data()), result == Z_STREAM_END,
            is_good ? nullptr : reason};
  }

 private:
  z_stream stream_{};
};

class ZstdUnpacker final : public Unpacker {
 public:
  Step step(std::span<const std::uint8_t> packed, std::span<std::uint8_t> room) override {
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{room.data(), room.size(), 0};
    const std::size_t result = ZSTD_decompressStream(stream_.get(), &out, &in);
    return {in.pos, out.pos, result == 0, ZSTD_isError(result) != 0 ? ZSTD_getErrorName(result) : nullptr};
  }

 private:
  std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream_{ZSTD_createDStream(),
                                                                        ZSTD_freeDStream};
};

class XzUnpacker final : public Unpacker {
 public:
  XzUnpacker() {
    constexpr std::uint64_t kMostBytes = std::uint64_t{128} << 20;  // xz -9 has dictionaries of 64 MiB
    fail_if(lzma_stream_decoder(&stream_, kMostBytes, 0) != LZMA_OK, "liblzma does not start");
  }
  XzUnpacker(const XzUnpacker&) = delete;
  XzUnpacker& operator=(const XzUnpacker&) = delete;
  ~XzUnpacker() override { lzma_end(&stream_); }

  Step step(std::span<const std::uint8_t> packed, std::span<std::uint8_t> room) override {
    stream_.next_in = packed.data();
    stream_.avail_in = packed.size();
    stream_.next_out = room.data();
    stream_.avail_out = room.size();
    const lzma_ret result = lzma_code(&stream_, LZMA_RUN);
    const bool is_good = result == LZMA_OK || result == LZMA_STREAM_END || result == LZMA_BUF_ERROR;
    const char* const reason =
        result == LZMA_MEMLIMIT_ERROR ? "it takes more than 128 MiB to unpack" : "liblzma refuses it";
    return {static_cast<std::size_t>(stream_.next_in - packed.data()),
            static_cast<std::size_t>(stream_.next_out - room.data()), result == LZMA_STREAM_END,
            is_good ? nullptr : reason};
  }

 private:
  lzma_stream stream_ = LZMA_STREAM_INIT;
};

/// How whole files are packed.
struct Packing {
  const char* name;
  std::string_view ending;
  std::string_view signature;  ///< of the first member
  std::string_view begins;     ///< the bytes one of which any other begins with
  std::unique_ptr<Unpacker> (*start)();
};
constexpr std::array<Packing, 3> kPackings{{
    {"gzip", ".gz", "\x1f\x8b", "\x1f",
     [] { return std::unique_ptr<Unpacker>(std::make_unique<ZlibUnpacker>(15 + 16)); }},
    // Members to be skipped, with tables for those who seek, begin with 50 to 5f.
    {"zstd", ".zst", "\x28\xb5\x2f\xfd", "\x28PQRSTUVWXYZ[\\]^_",
     [] { return std::unique_ptr<Unpacker>(std::make_unique<ZstdUnpacker>()); }},
    {"xz", ".xz",
     std::string_view("\xfd"
                      "7zXZ\0",
                      6),
     "\xfd", [] { return std::unique_ptr<Unpacker>(std::make_unique<XzUnpacker>()); }},
}};

/// Unpacks the members of a file as their bytes arrive.
class Members {
 public:
  Members(const Packing& packing, FileBuffer& out, Looker& looker)
      : packing_(packing), out_(out), looker_(looker) {}

  void feed(std::span<const std::uint8_t> packed) {
    bool has_more = false;  // that found no room
    while (!packed.empty() || has_more) {
      if (between_members_ && !begin_member(&packed)) {
        continue;
      }
      const std::span<std::uint8_t> room = out_.room();
      const Unpacker::Step step = unpacker_->step(packed, room);
      packed = packed.subspan(step.taken);
      taken_bytes_ += step.taken;
      fail_if(step.fault != nullptr, packing_.name, " data is damaged near byte offset ", taken_bytes_, ": ",
              step.fault);
      out_.grew_from(taken_bytes_, step.made);
      looker_.at(out_.bytes(), false);
      between_members_ = step.is_end;
      has_more = !step.is_end && step.made == room.size();
    }
  }
  void finish() const {
    fail_if(!between_members_, packing_.name, " data is truncated: the file ends at byte offset ",
            taken_bytes_, " within a member");
    fail_if(out_.size() == 0, packing_.name, " data holds no bytes");
  }

 private:
  /// Leaves out one zero byte, with which members are padded, or begins with what else there is.
  bool begin_member(std::span<const std::uint8_t>* packed) {
    if (packed->front() == 0) {
      *packed = packed->subspan(1);
      ++taken_bytes_;
      return false;
    }
    fail_if(packing_.begins.find(static_cast<char>(packed->front())) == std::string_view::npos, packing_.name,
            " data ends at byte offset ", taken_bytes_, " but something else follows it");
    unpacker_ = packing_.start();
    return true;
  }

  const Packing& packing_;
  std::unique_ptr<Unpacker> unpacker_;
  FileBuffer& out_;
  Looker& looker_;
  std::uint64_t taken_bytes_ = 0;
  bool between_members_ = true;
};

SharedBytes unpack(const Packing& packing, const Descriptor& file, std::span<std::uint8_t> step,
                   std::size_t got, std::uint64_t limit_bytes, Looker& looker) {
  FileBuffer out(limit_bytes);
  Members members(packing, out, looker);
  while (got > 0) {
    members.feed(step.first(got));
    got = file.read(step.data(), step.size());
  }
  members.finish();
  looker.at(out.bytes(), true);
  return out.finish();
}

/// Inflates `packed` into `out` until it ends, is damaged or ends too early, or `enough` bytes are there.
/// @return the last step
Unpacker::Step inflate_into(FileBuffer& out, std::span<const std::uint8_t> packed, Deflated frame,
                            std::uint64_t enough) {
  ZlibUnpacker unpacker(frame == Deflated::kZlib ? 15 : (frame == Deflated::kGzip ? 15 + 16 : -15));
  const std::size_t all = packed.size();
  for (;;) {
    const Unpacker::Step step = unpacker.step(packed, out.room());
    packed = packed.subspan(step.taken);
    out.grew_from(all - packed.size(), step.made);
    const bool is_stuck = step.taken == 0 && step.made == 0;
    if (step.is_end || step.fault != nullptr || is_stuck || out.size() >= enough) {
      return step;
    }
  }
}

}  // namespace

SharedBytes inflate_bytes(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t limit_bytes,
                          const std::string& place) {
  FileBuffer out(limit_bytes);
  const Unpacker::Step last = inflate_into(out, packed, frame, UINT64_MAX);
  fail_if(!last.is_end, place,
          last.fault == nullptr ? ": the deflated data is truncated" : ": the deflated data is damaged");
  return out.finish();
}

SharedBytes inflate_beginning(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t count) {
  FileBuffer out(std::max<std::uint64_t>(count, std::size_t{1} << 20));
  inflate_into(out, packed, frame, count);
  return out.finish();
}

namespace {

/// Of a directory opening it says what is wrong.
void check_regular(const std::string& path) {
  struct stat status {};
  fail_if(::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode),
          "is no regular file");
}

}  // namespace

std::string load_beside(const std::string& path, std::uint64_t limit_bytes, SharedBytes& file) {
  try {
    check_regular(path);
    file = load_file(path, limit_bytes);
    return {};
  } catch (const ShortageError& error) {
    throw ShortageError("the file " + tools::quoted(path) + " that it names " + error.what());
  } catch (const InputError& error) {
    return error.what();
  }
}

SharedBytes load_file(const std::string& path, std::uint64_t limit_bytes, const FirstLook& look) {
  limit_bytes = std::clamp<std::uint64_t>(limit_bytes, 1, SIZE_MAX - 1);
  const Descriptor file(path);
  const std::uint64_t size_hint_bytes = file.size_hint_bytes();
  const auto step_storage = std::make_unique<std::array<std::uint8_t, kStepBytes>>();
  const std::span<std::uint8_t> step(*step_storage);
  const std::size_t got = file.read(step.data(), step.size());
  fail_if(got == 0, "is empty");
  Looker looker(look);
  const std::string_view head(reinterpret_cast<const char*>(step.data()), got);
  for (const Packing& packing : kPackings) {
    if (head.starts_with(packing.signature)) {
      return unpack(packing, file, step, got, limit_bytes, looker);
    }
  }
  for (const Packing& packing : kPackings) {
    fail_if(path.ends_with(packing.ending), "its name ends in ", packing.ending,
            " but it does not begin with the ", packing.name, " signature");
  }
  looker.at(step.first(got), true);  // a pipe hands out less only at its end
  FileBuffer::check_size(size_hint_bytes, limit_bytes);
  FileBuffer buffer(limit_bytes);
  // One byte more than expected: the read that finds the end needs room too.
  buffer.reserve(std::max<std::uint64_t>(size_hint_bytes, got) + 1);
  const std::size_t kept = std::min(got, buffer.room().size());
  std::copy_n(step.begin(), kept, buffer.room().begin());
  buffer.grew(kept);
  for (;;) {
    const std::span<std::uint8_t> room = buffer.room();
    const std::size_t read = file.read(room.data(), room.size());
    buffer.grew(read);
    if (read < room.size()) {
      return buffer.finish();
    }
  }
}

SharedBytes load_shared(const std::string& path, const FirstLook& look, bool is_beside) {
  if (is_beside) {
    check_regular(path);
  }
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
      static_cast<std::uint64_t>(status.st_size) >= kMappedBytes) {
    const Descriptor file(path);
    SharedBytes mapped = file.map(static_cast<std::size_t>(file.size_hint_bytes()));
    const bool is_packed = std::any_of(kPackings.begin(), kPackings.end(), [&](const Packing& packing) {
      return path.ends_with(packing.ending) || mapped.text().starts_with(packing.signature);
    });
    if (mapped.owner != nullptr && !is_packed) {
      Looker(look).at(mapped.bytes, true);
      return mapped;
    }
  }
  return load_file(path, kFileLimitBytes, look);
}

}  // namespace thimble::tools
