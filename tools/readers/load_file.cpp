// Files and what is deflated in them, as bytes: what of file_bytes.h needs a system and zlib.
#include "readers/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "output/file_place.h"

namespace thimble::tools {

namespace {

constexpr std::size_t kStepBytes = 64 * 1024;
constexpr std::uint8_t kGzipSignature[2] = {0x1f, 0x8b};

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
    if (fd_ < 0) {
      throw InputError("cannot be opened: " + reason(errno));
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { ::close(fd_); }

  /// Size of a regular file, 0 where only reading to the end tells.
  std::uint64_t size_hint_bytes() const {
    struct stat status {};
    if (::fstat(fd_, &status) != 0) {
      throw InputError("cannot be examined: " + reason(errno));
    }
    if (S_ISDIR(status.st_mode)) {
      throw InputError("is a directory, not a file");
    }
    return S_ISREG(status.st_mode) && status.st_size > 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
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
        throw InputError("cannot be read: " + reason(errno));
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
    if (bytes_.size_ == capacity_) {
      grow();
    }
    return {bytes_.data_.get() + bytes_.size_, capacity_ - bytes_.size_};
  }
  void reserve(std::uint64_t capacity) {
    capacity = std::min(capacity, limit_bytes_ + 1);
    if (capacity > capacity_ && !resize(capacity)) {
      refuse_for_memory();
    }
  }
  /// `count` bytes of `room()` were written.
  void grew(std::size_t count) {
    bytes_.size_ += count;
    if (bytes_.size_ > limit_bytes_) {
      refuse(limit_bytes_);
    }
  }
  std::size_t size() const { return bytes_.size_; }
  std::span<const std::uint8_t> bytes() const { return bytes_.bytes(); }
  FileBytes finish() {
    if (bytes_.size_ != 0 && bytes_.size_ < capacity_) {
      static_cast<void>(resize(bytes_.size_));  // what stays larger is as good
    }
    return std::move(bytes_);
  }
  [[noreturn]] static void refuse(std::uint64_t limit_bytes) {
    throw InputError("holds more than the limit of " + std::to_string(limit_bytes) + " bytes");
  }

 private:
  /// Twice the room; where this machine does not have that, half as much more, and so on.
  void grow() {
    for (std::uint64_t more = std::max<std::uint64_t>(kStepBytes, capacity_); more >= kStepBytes; more /= 2) {
      if (resize(std::min(capacity_ + more, limit_bytes_ + 1))) {
        return;
      }
    }
    refuse_for_memory();
  }
  [[noreturn]] void refuse_for_memory() const {
    throw InputError("does not fit the memory that is left on this machine: " + std::to_string(bytes_.size_) +
                     " bytes of it did");
  }
  bool resize(std::uint64_t capacity) {
    void* moved =
        capacity > SIZE_MAX ? nullptr : std::realloc(bytes_.data_.get(), static_cast<std::size_t>(capacity));
    if (moved == nullptr) {
      return false;
    }
    static_cast<void>(bytes_.data_.release());
    bytes_.data_.reset(static_cast<std::uint8_t*>(moved));
    capacity_ = static_cast<std::size_t>(capacity);
    return true;
  }

  FileBytes bytes_;
  std::size_t capacity_ = 0;
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

/// Inflates gzip members as their bytes arrive.
class Inflater {
 public:
  Inflater(FileBuffer& out, Looker& looker) : out_(out), looker_(looker) {
    if (inflateInit2(&stream_, kGzipOnly) != Z_OK) {
      throw InputError("cannot be inflated: zlib does not start");
    }
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  void feed(std::span<std::uint8_t> input) {
    stream_.next_in = input.data();
    stream_.avail_in = static_cast<uInt>(input.size());
    fed_bytes_ += input.size();
    while (stream_.avail_in > 0) {
      if (between_members_) {
        skip_padding();
      } else {
        inflate_step();
      }
    }
  }
  void finish() const {
    if (!between_members_) {
      throw InputError("gzip data is truncated: the file ends at byte offset " + std::to_string(fed_bytes_) +
                       " within a member");
    }
  }

 private:
  static constexpr int kGzipOnly = 15 + 16;  // zlib: the largest window, gzip header and trailer required

  std::uint64_t offset() const { return fed_bytes_ - stream_.avail_in; }

  void skip_padding() {
    if (*stream_.next_in == 0) {
      ++stream_.next_in;
      --stream_.avail_in;
      return;
    }
    if (*stream_.next_in != kGzipSignature[0]) {
      throw InputError("gzip data ends at byte offset " + std::to_string(offset()) +
                       " but something else follows it");
    }
    inflateReset(&stream_);
    between_members_ = false;
  }

  /// One call of zlib. Output that finds no room waits for the next call, which comes: a member's trailer is
  /// input that zlib leaves alone until all output before it is out.
  void inflate_step() {
    const std::span<std::uint8_t> room = out_.room();
    const std::size_t offered = std::min(room.size(), std::size_t{1} << 30);
    stream_.next_out = room.data();
    stream_.avail_out = static_cast<uInt>(offered);
    const int result = inflate(&stream_, Z_NO_FLUSH);
    out_.grew(offered - stream_.avail_out);
    looker_.at(out_.bytes(), false);
    if (result == Z_STREAM_END) {
      between_members_ = true;
    } else if (result != Z_OK) {
      throw InputError("gzip data is damaged near byte offset " + std::to_string(offset()) + ": " +
                       (stream_.msg != nullptr ? stream_.msg : "zlib refuses it"));
    }
  }

  FileBuffer& out_;
  Looker& looker_;
  z_stream stream_{};
  std::uint64_t fed_bytes_ = 0;
  bool between_members_ = false;
};

FileBytes load_gzip(const Descriptor& file, std::span<std::uint8_t> step, std::size_t got,
                    std::uint64_t limit_bytes, Looker& looker) {
  FileBuffer out(limit_bytes);
  Inflater inflater(out, looker);
  while (got > 0) {
    inflater.feed(step.first(got));
    got = file.read(step.data(), step.size());
  }
  inflater.finish();
  if (out.size() == 0) {
    throw InputError("gzip data holds no bytes");
  }
  looker.at(out.bytes(), true);
  return out.finish();
}

}  // namespace

namespace {

/// Inflates `packed` into `out` until it ends, is damaged or `enough` bytes are there.
/// @return zlib's last answer
int inflate_into(FileBuffer& out, std::span<const std::uint8_t> packed, Deflated frame,
                 std::uint64_t enough) {
  z_stream stream{};
  const int window = frame == Deflated::kZlib ? 15 : (frame == Deflated::kGzip ? 15 + 16 : -15);
  if (inflateInit2(&stream, window) != Z_OK) {
    throw InputError("cannot be inflated: zlib does not start");
  }
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  int result = Z_OK;
  while (result == Z_OK && out.size() < enough) {
    if (stream.avail_in == 0) {
      const std::size_t step = std::min(packed.size(), std::size_t{1} << 30);
      stream.next_in = const_cast<Bytef*>(packed.data());
      stream.avail_in = static_cast<uInt>(step);
      packed = packed.subspan(step);
    }
    const std::span<std::uint8_t> room = out.room();
    const std::size_t offered = std::min(room.size(), std::size_t{1} << 30);
    stream.next_out = room.data();
    stream.avail_out = static_cast<uInt>(offered);
    result = inflate(&stream, Z_NO_FLUSH);
    out.grew(offered - stream.avail_out);
    if (result == Z_BUF_ERROR && !packed.empty()) {
      result = Z_OK;
    }
  }
  return result;
}

}  // namespace

FileBytes inflate_bytes(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t limit_bytes,
                        const std::string& place) {
  FileBuffer out(limit_bytes);
  const int result = inflate_into(out, packed, frame, UINT64_MAX);
  if (result != Z_STREAM_END) {
    throw InputError(place + (result == Z_BUF_ERROR ? ": the deflated data is truncated"
                                                    : ": the deflated data is damaged"));
  }
  return out.finish();
}

FileBytes inflate_beginning(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t count) {
  FileBuffer out(std::max<std::uint64_t>(count, std::size_t{1} << 20));
  inflate_into(out, packed, frame, count);
  return out.finish();
}

FileBytes FileBytes::copy_of(std::span<const std::uint8_t> bytes) {
  FileBuffer buffer(bytes.size());
  buffer.reserve(bytes.size());
  if (!bytes.empty()) {
    std::memcpy(buffer.room().data(), bytes.data(), bytes.size());
    buffer.grew(bytes.size());
  }
  return buffer.finish();
}

SharedBytes share(FileBytes bytes) {
  auto kept = std::make_shared<const FileBytes>(std::move(bytes));
  return {kept->bytes(), kept};
}

FileBytes load_regular_file(const std::string& path, std::uint64_t limit_bytes) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) {
    throw InputError("is no regular file");
  }
  return load_file(path, limit_bytes);
}

FileBytes load_file(const std::string& path, std::uint64_t limit_bytes, const FirstLook& look) {
  limit_bytes = std::clamp<std::uint64_t>(limit_bytes, 1, SIZE_MAX - 1);
  const Descriptor file(path);
  const std::uint64_t size_hint_bytes = file.size_hint_bytes();
  const auto step_storage = std::make_unique<std::array<std::uint8_t, kStepBytes>>();
  const std::span<std::uint8_t> step(*step_storage);
  const std::size_t got = file.read(step.data(), step.size());
  if (got == 0) {
    throw InputError("is empty");
  }
  Looker looker(look);
  if (got >= 2 && step[0] == kGzipSignature[0] && step[1] == kGzipSignature[1]) {
    return load_gzip(file, step, got, limit_bytes, looker);
  }
  if (path.ends_with(".gz")) {
    throw InputError("its name ends in .gz but it does not begin with the gzip signature 1f 8b");
  }
  looker.at(step.first(got), true);  // a pipe hands out less only at its end
  if (size_hint_bytes > limit_bytes) {
    FileBuffer::refuse(limit_bytes);
  }
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

}  // namespace thimble::tools
