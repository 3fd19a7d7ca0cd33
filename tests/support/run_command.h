/// Runs the `thimble` command as a user does, and a folder of its own for the files of one test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace thimble::tests {

// Sanitized, the command takes ten times as long, and the optimised build tries all.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

struct CommandResult {
  int status = -1;  ///< exit status; -1 when a signal ended it
  int signal = 0;   ///< the signal that ended it, 0 for none
  bool timed_out = false;
  std::string out;    ///< standard output
  std::string err;    ///< standard error
  long peak_kib = 0;  ///< the most memory that it had, or what the test had when it began

  /// For failure messages.
  std::string describe() const;
};

/// A call of the system that fails for the command with an errno of one's choice (x86-64 and other machines whose
/// calls have numbers; by seccomp, so that nobody need be root).
struct RefusedCall {
  long number = 0;         ///< SYS_...
  int error = 0;           ///< errno
  int argument = -1;       ///< only where this argument, from 0, ...
  std::uint32_t bits = 0;  ///< ... has one of these bits
};

struct CommandLimits {
  double seconds = 60;
  /// Limit on the child's address space; 0 for none. Not set under AddressSanitizer, whose shadow memory
  /// needs terabytes of it.
  std::uint64_t address_space_bytes = 0;
  std::uint64_t file_size_bytes = 0;  ///< limit on what the child may write to one file; 0 for none
  std::uint64_t descriptors = 0;      ///< limit on open files; 0 for none
  std::vector<RefusedCall> refused;
  std::string directory;    ///< where it runs; empty for here
  std::string program;      ///< what runs; empty for the `thimble` command
  std::string output_path;  ///< where standard output goes; empty: into `CommandResult::out`
};

/// Runs the command with `arguments`, standard input empty. Throws `std::runtime_error` when it cannot be
/// started.
CommandResult run_command(const std::vector<std::string>& arguments, const CommandLimits& limits = {});

/// Whether `text` is one line "thimble: ...", ended by a line feed, without control characters.
bool is_one_sentence(std::string_view text);

/// A new folder that goes, with all in it, when this does.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// The path of `name` in it.
  std::string path(std::string_view name) const { return (folder_ / name).string(); }
  std::string path() const { return folder_.string(); }
  /// Writes a file and returns its path.
  std::string write(std::string_view name, std::string_view text) const;
  /// Names of all in it, sorted.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path folder_;
};

/// All bytes of a file; throws when it cannot be read.
std::string read_text(const std::string& path);

/// A line's columns.
std::vector<std::string> split(std::string_view line, char separator = ',');
/// A text's lines, without their ends.
std::vector<std::string> lines_of(std::string_view text);

}  // namespace thimble::tests
