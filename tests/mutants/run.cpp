// Runs single tests of a program whose core holds mutants (mutant.h), each in a child, as lines of standard input ask:
//
//   cover<TAB>CPU_MS<TAB>TEST                  which places it comes by -> ok|failed|crashed|endless MS CRC
//                                             NUMBER...
//   try<TAB>MUTANT<TAB>CPU_MS...<TAB>TEST...   the tests, until one fails -> killed INDEX failed|crashed|endless MS,
//                                             or survived MS
//
// MS: of the processor, whose time is the same on a busy machine.
// A TEST is d:FILE:NAME, cases of doctest, or p:GROUP:INDEX[:CRC], a portable case, which also fails when what it
// computes has another CRC-32. Without --serve the program is the one that it was linked as.
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "portable/runner.h"
#include "tests/mutants/mutant.h"

extern "C" {
int thimble_mutant = 0;
alignas(4096) unsigned char thimble_mutant_reached[size_t{1} << 16];
// NOLINTNEXTLINE(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the linker's names (--wrap=main)
int __real_main(int argc, char** argv);
// NOLINTNEXTLINE(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
int __wrap_main(int argc, char** argv);
}

namespace {

using namespace thimble;

// What a child that ran a portable case tells its parent.
struct Told {
  uint32_t crc = 0;
};
Told* told = nullptr;

std::vector<std::string> split(const std::string& text, char by) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, by);) {
    parts.push_back(part);
  }
  return parts;
}

std::vector<portable::Case> portable_cases(int group) {
  std::vector<const portable::Group*> groups;
  const auto append = [&](Span<const portable::Group* const> some) {
    for (const portable::Group* one : some) {
      groups.push_back(one);
    }
  };
  append(portable::kCoreGroups);
  append(portable::kGoldenGroups);
  append(portable::kPanelGroups);
  append(portable::kLitGroups);
  append(portable::kWorldGroups);
  append(portable::kBrickGroups);
  append(portable::kMapLightGroups);
  std::vector<portable::Case> cases;
  if (static_cast<size_t>(group) < groups.size()) {
    for (int i = 0; i < groups[static_cast<size_t>(group)]->count; ++i) {
      cases.push_back(groups[static_cast<size_t>(group)]->at(i));
    }
  }
  return cases;
}

// In a child. -> its exit status
int run_test(const std::string& test) {
  const std::vector<std::string> parts = split(test, ':');
  if (parts[0] == "p") {
    alignas(8) static uint8_t memory[size_t{512} << 10];
    portable::Runner* runner = portable::Runner::make(Bytes(memory));
    const bool passed =
        runner->run(portable_cases(std::stoi(parts[1])).at(static_cast<size_t>(std::stoi(parts[2])))) ==
        nullptr;
    told->crc = runner->crc32();
    return passed && (parts.size() < 4 || std::stoul(parts[3]) == told->crc) ? 0 : 1;
  }
  const std::string file = "--source-file=*/" + parts[1];
  const std::string name = "--test-case=" + test.substr(parts[1].size() + 3);
  std::vector<std::string> words{"thimble_mutants", file, name, "--abort-after=1"};
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) {
    argv.push_back(word.data());
  }
  return __real_main(static_cast<int>(argv.size()), argv.data());
}

// -> ok, failed, crashed or endless; adds what it took
const char* in_child(const std::string& test, long cpu_ms, long* took_ms) {
  fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3; ++stream) {
      dup2(nowhere, stream);
    }
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    const rlimit memory{rlim_t{4} << 30, rlim_t{4} << 30};
    setrlimit(RLIMIT_AS, &memory);
    signal(SIGPROF, SIG_DFL);
    signal(SIGALRM, SIG_DFL);
    const itimerval limit{{0, 0}, {cpu_ms / 1000, cpu_ms % 1000 * 1000}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    alarm(static_cast<unsigned>(cpu_ms / 100 + 20));  // who waits for nothing takes no time of the processor
    const int status = run_test(test);
    fflush(nullptr);
    _exit(status);
  }
  int status = 0;
  rusage took{};
  wait4(child, &status, 0, &took);
  for (const timeval& part : {took.ru_utime, took.ru_stime}) {
    *took_ms += 1000 * part.tv_sec + part.tv_usec / 1000;
  }
  if (WIFEXITED(status)) {
    return WEXITSTATUS(status) == 0 ? "ok" : "failed";
  }
  // doctest turns a signal into a failed case, but for these.
  return WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGALRM ? "endless" : "crashed";
}

void cover(const std::string& test, long cpu_ms) {
  memset(thimble_mutant_reached, 0, sizeof thimble_mutant_reached);
  told->crc = 0;
  long ms = 0;
  const char* result = in_child(test, cpu_ms, &ms);
  std::cout << result << ' ' << ms << ' ' << told->crc;
  for (size_t number = 0; number < sizeof thimble_mutant_reached; ++number) {
    if (thimble_mutant_reached[number] != 0) {
      std::cout << ' ' << number;
    }
  }
  std::cout << std::endl;
}

void try_mutant(const std::vector<std::string>& words) {
  thimble_mutant = std::stoi(words[1]);
  long ms = 0;
  for (size_t i = 2; i + 1 < words.size(); i += 2) {
    const char* result = in_child(words[i + 1], std::stol(words[i]), &ms);
    if (strcmp(result, "ok") != 0) {
      std::cout << "killed " << i / 2 - 1 << ' ' << result << ' ' << ms << std::endl;
      return;
    }
  }
  std::cout << "survived " << ms << std::endl;
}

int serve() {
  void* shared = mmap(thimble_mutant_reached, sizeof thimble_mutant_reached, PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
  void* page = mmap(nullptr, sizeof(Told), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED || page == MAP_FAILED) {
    return 1;
  }
  told = new (page) Told;
  for (int group = 0; !portable_cases(group).empty(); ++group) {
    std::cout << ' ' << portable_cases(group).size();
  }
  std::cout << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const std::vector<std::string> words = split(line, '\t');
    if (words[0] == "cover") {
      thimble_mutant = 0;
      cover(words[2], std::stol(words[1]));
    } else {
      try_mutant(words);
    }
  }
  return 0;
}

}  // namespace

int __wrap_main(int argc, char** argv) {
  return argc == 2 && strcmp(argv[1], "--serve") == 0 ? serve() : __real_main(argc, argv);
}
