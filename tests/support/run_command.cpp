#include "support/run_command.h"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace thimble::tests {
namespace {

void limit(int resource, std::uint64_t bytes) {
  if (bytes != 0) {
    const rlimit value{bytes, bytes};
    ::setrlimit(static_cast<__rlimit_resource>(resource), &value);
  }
}

// What the system asks at each call of the command.
std::vector<sock_filter> filter_of(const std::vector<RefusedCall>& refused) {
  std::vector<sock_filter> steps;
  const auto load = [&](std::size_t offset) {
    steps.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  };
  for (const RefusedCall& call : refused) {
    const bool is_some = call.argument >= 0;
    const std::uint8_t steps_of_it = is_some ? 3 : 1;
    load(offsetof(seccomp_data, nr));
    steps.push_back(
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call.number), 0, steps_of_it));
    if (is_some) {
      constexpr std::size_t kLow = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? 4 : 0;
      load(offsetof(seccomp_data, args) + 8 * static_cast<std::size_t>(call.argument) + kLow);
      steps.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, call.bits, 0, 1));
    }
    steps.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(call.error)));
  }
  steps.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  return steps;
}

// In the child, between vfork and exec, with the parent's memory: only what a signal handler may do, and
// nothing of the parent's is written to.
[[noreturn]] void become(const CommandLimits& limits, const std::vector<char*>& arguments,
                         const sock_fprog& filter, int out, int err) {
  const int in = ::open("/dev/null", O_RDONLY);
  const int to = limits.output_path.empty()
                     ? out
                     : ::open(limits.output_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (in < 0 || to < 0 || ::dup2(in, 0) < 0 || ::dup2(to, 1) < 0 || ::dup2(err, 2) < 0 ||
      (!limits.directory.empty() && ::chdir(limits.directory.c_str()) != 0)) {
    ::_exit(126);
  }
#ifndef __SANITIZE_ADDRESS__
  limit(RLIMIT_AS, limits.address_space_bytes);
#endif
  limit(RLIMIT_FSIZE, limits.file_size_bytes);
  limit(RLIMIT_NOFILE, limits.descriptors);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  // Whoever started the tests may ignore some (nohup does); the command must not begin so.
  for (const int number : {SIGHUP, SIGINT, SIGTERM}) {
    ::signal(number, SIG_DFL);
  }
  if (!limits.refused.empty() && (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
                                  ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) != 0)) {
    ::_exit(126);
  }
  ::execv(arguments.front(), arguments.data());
  ::_exit(127);
}

}  // namespace

std::string CommandResult::describe() const {
  return "status " + std::to_string(status) + ", signal " + std::to_string(signal) +
         (timed_out ? ", out of time" : "") + ", stderr: " + err.substr(0, 2000);
}

CommandResult run_command(const std::vector<std::string>& arguments, const CommandLimits& limits) {
  std::vector<std::string> words{limits.program.empty() ? THIMBLE_COMMAND_PATH : limits.program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);

  std::vector<sock_filter> steps = filter_of(limits.refused);
  const sock_fprog filter{static_cast<unsigned short>(steps.size()), steps.data()};
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (::pipe2(out.data(), O_CLOEXEC) != 0 || ::pipe2(err.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  std::ofstream("/proc/self/clear_refs") << 5;  // forgets our own peak, with which the child begins
  // Sanitized, these tests are so large that copying their page tables, thousands of times, took a fifth of
  // the time.
  const pid_t child = ::vfork();
  if (child < 0) {
    throw std::runtime_error("no process");
  }
  if (child == 0) {
    become(limits, pointers, filter, out[1], err[1]);
  }
  ::close(out[1]);
  ::close(err[1]);

  CommandResult result;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limits.seconds);
  std::array<pollfd, 2> streams{{{out[0], POLLIN, 0}, {err[0], POLLIN, 0}}};
  const std::array<std::string*, 2> texts{&result.out, &result.err};
  std::array<char, 65536> buffer{};
  for (int open = 2; open > 0;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) {
      result.timed_out = true;
      ::kill(child, SIGKILL);
      break;
    }
    ::poll(streams.data(), streams.size(), static_cast<int>(left.count()));
    for (std::size_t i = 0; i < streams.size(); ++i) {
      if (streams[i].fd >= 0 && streams[i].revents != 0) {
        const ssize_t count = ::read(streams[i].fd, buffer.data(), buffer.size());
        if (count > 0) {
          texts[i]->append(buffer.data(), static_cast<std::size_t>(count));
        } else {
          streams[i].fd = -1;  // poll skips it
          --open;
        }
      }
    }
  }
  ::close(out[0]);
  ::close(err[0]);
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  result.peak_kib = usage.ru_maxrss;
  if (WIFEXITED(status)) {
    result.status = WEXITSTATUS(status);
  } else if (WIFSIGNALED(status)) {
    result.signal = WTERMSIG(status);
  }
  return result;
}

bool is_one_sentence(std::string_view text) {
  constexpr std::string_view kStart = "thimble: ";
  return text.starts_with(kStart) && text.size() > kStart.size() + 1 && text.back() == '\n' &&
         std::none_of(text.begin(), text.end() - 1,
                      [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "thimble-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("no temporary folder");
  }
  folder_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string TemporaryFolder::write(std::string_view name, std::string_view text) const {
  std::ofstream file(folder_ / name, std::ios::binary);
  file << text;
  if (!file.flush()) {
    throw std::runtime_error("cannot write a test's file");
  }
  return path(name);
}

std::vector<std::string> TemporaryFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) {
    throw std::runtime_error("cannot read " + path);
  }
  return text.str();
}

std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> columns;
  while (true) {
    const std::size_t end = line.find(separator);
    columns.emplace_back(line.substr(0, end));
    if (end == std::string_view::npos) {
      return columns;
    }
    line.remove_prefix(end + 1);
  }
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines = split(text, '\n');
  if (lines.back().empty()) {
    lines.pop_back();
  }
  return lines;
}

}  // namespace thimble::tests
