// Several outputs of one run, and signals that end it while they take their names.
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "output/held_signals.h"
#include "output/output_file.h"
#include "readers/file_bytes.h"
#include "support/run_command.h"

using namespace thimble::tools;
using namespace thimble::tests;

TEST_CASE(
    "outputs: a signal at any moment of their naming -> all of them are new, or all old; nothing hidden") {
  const TemporaryFolder folder;
  constexpr int kFiles = 48;
  std::vector<std::string> names;
  for (int i = 0; i < kFiles; ++i) {
    names.push_back("f" + std::to_string(100 + i));
  }
  int all_new = 0;
  int all_old = 0;
  const int rounds = kSanitized ? 30 : 100;
  // Signals come later and later. A slow machine needs more rounds until one comes after the last name.
  for (int round = 0; round < rounds || (all_new == 0 && round < 100 * rounds); ++round) {
    // Every third one is not there before.
    std::vector<std::string> before;
    std::vector<std::string> paths;
    for (int i = 0; i < kFiles; ++i) {
      paths.push_back(folder.path(names[static_cast<std::size_t>(i)]));
      ::unlink(paths.back().c_str());
      if (i % 3 != 0) {
        folder.write(names[static_cast<std::size_t>(i)], "old");
        before.push_back(names[static_cast<std::size_t>(i)]);
      }
    }
    std::array<int, 2> ready{};
    REQUIRE(::pipe(ready.data()) == 0);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      std::signal(SIGTERM, SIG_DFL);
      clean_up_on_signals();
      {
        OutputSet outputs(paths, {});
        for (int i = 0; i < kFiles; ++i) {
          outputs[static_cast<std::size_t>(i)]->write("new");
        }
        static_cast<void>(::write(ready[1], "x", 1) == 1);
        outputs.commit();
      }
      ::_exit(0);
    }
    char one = 0;
    REQUIRE(::read(ready[0], &one, 1) == 1);
    ::close(ready[0]);
    ::close(ready[1]);
    std::this_thread::sleep_for(std::chrono::microseconds(10 * round * 400 / rounds));
    ::kill(child, SIGTERM);
    int status = 0;
    ::waitpid(child, &status, 0);
    CAPTURE(round);
    CAPTURE(status);
    const std::vector<std::string> after = folder.names();
    bool any_old = false;
    bool any_new = false;
    for (const std::string& name : after) {
      any_new = any_new || read_text(folder.path(name)) == "new";
      any_old = any_old || read_text(folder.path(name)) == "old";
    }
    REQUIRE(any_old != any_new);
    REQUIRE((after == names || after == before));
    all_new += any_new ? 1 : 0;
    all_old += any_old ? 1 : 0;
  }
  CHECK(all_new != 0);
  CHECK(all_old != 0);
}

TEST_CASE("outputs: a mapped input that is cut off while it is read -> exit status 1, and nothing is left") {
  const TemporaryFolder folder;
  const std::string input = folder.write("input", "");
  std::filesystem::resize_file(input, kMappedBytes);
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    clean_up_on_signals();
    OutputSet outputs({folder.path("output")}, {input});
    outputs[0]->write("new");
    const SharedBytes mapped = load_shared(input, {});
    std::filesystem::resize_file(input, 0);
    ::_exit(2 + *static_cast<const volatile std::uint8_t*>(mapped.bytes.data()));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 1);
  CHECK(folder.names() == std::vector<std::string>{"input"});
}
