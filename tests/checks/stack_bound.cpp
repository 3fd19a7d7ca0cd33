// The worst stack of every function of the core, from gcc's call graphs (-fcallgraph-info=su,da).
//
//   stack_bound TARGET STACK.csv GRAPH.ci...
//   stack_bound --image ROOT[,OTHER] INTERRUPT SYMBOLS GRAPH.ci...
//
// The second form prints one number, the bytes that a whole image can need: from the function ROOT on, with
// the handler INTERRUPT (and the frame that an exception pushes) on top wherever it strikes. SYMBOLS names
// the functions that the linker kept, one a line. A call through a pointer counts as the worst of all kept
// functions that nobody calls by name: those whose address somebody takes are among them. `ROOT,OTHER` names where
// another core begins, on a stack of its own: nobody calls that.
//
// A graph is a list of `node: { title: "id" label: "name\nplace\nN bytes (kind)\n..." }` and of
// `edge: { sourcename: "id" targetname: "id" ... }`. Functions local to a file have `file:` before their id.
// A node without a frame is somebody else's code. Calls of the compiler's own helpers (libgcc, memcpy) are
// not always in the graph, so every chain is given kHelperBytes for one at its end: they use at most ten
// registers' worth.
//
// Exit status 1 and a sentence for each of: recursion, a call through a pointer, a frame whose size is not known when
// compiling, a function that nobody calls (the public ones) without a row in STACK.csv, one above the limit of its row.
// The row `*` holds only what nobody calls: what an inner function needs counts in its callers.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

constexpr std::uint64_t kHelperBytes = 64;
// Cortex-M pushes eight words, and one more to align them to 8 bytes.
constexpr std::uint64_t kExceptionBytes = 36;
constexpr const char* kIndirectCall = "__indirect_call";

struct Function {
  std::string name;
  std::string place;
  bool defined = false;
  bool dynamic = false;
  std::uint64_t frame_bytes = 0;
  std::set<std::string> callees;
};

struct Limit {
  std::string pattern;
  std::string target;
  std::uint64_t bytes = 0;
};

// The quoted text after `key: ` in `line`, or nothing.
std::string field(const std::string& line, const std::string& key) {
  const std::size_t at = line.find(key + ": \"");
  if (at == std::string::npos) {
    return {};
  }
  const std::size_t first = at + key.size() + 3;
  std::size_t last = first;
  while (last < line.size() && line[last] != '"') {
    last += line[last] == '\\' ? 2U : 1U;
  }
  return line.substr(first, last - first);
}

std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t first = 0;
  for (std::size_t at = text.find(separator); at != std::string::npos; at = text.find(separator, first)) {
    parts.push_back(text.substr(first, at - first));
    first = at + separator.size();
  }
  parts.push_back(text.substr(first));
  return parts;
}

bool matches(const char* pattern, const char* text) {
  if (*pattern == '\0') {
    return *text == '\0';
  }
  if (*pattern == '*') {
    return matches(pattern + 1, text) || (*text != '\0' && matches(pattern, text + 1));
  }
  return *text != '\0' && (*pattern == '?' || *pattern == *text) && matches(pattern + 1, text + 1);
}

class Graph {
 public:
  bool read(const char* path) {
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line)) {
      if (line.starts_with("node:")) {
        add_node(line);
      } else if (line.starts_with("edge:")) {
        functions_[field(line, "sourcename")].callees.insert(field(line, "targetname"));
      }
    }
    return file.eof();
  }

  // A constructor or destructor of a whole object is often another name of the one for a part, which is the
  // only one that has a node: C1 of C2, D1 of D2.
  void join_constructors() {
    std::set<std::string> called;
    for (const auto& [id, function] : functions_) {
      called.insert(function.callees.begin(), function.callees.end());
    }
    for (const char* names : {"C1EC2E", "D1ED2E"}) {
      const std::string whole(names, 3);
      const std::string part(names + 3, 3);
      for (const std::string& id : called) {
        const std::size_t at = id.find(whole);
        if (at == std::string::npos || functions_[id].defined) {
          continue;
        }
        const auto found = functions_.find(std::string(id).replace(at, whole.size(), part));
        if (found != functions_.end() && found->second.defined) {
          joined_.insert(found->first);
          functions_[id] = found->second;
        }
      }
    }
  }

  // An instantiation of a template has its file before its id, though other files call it by the id alone.
  void join_instantiations() {
    std::map<std::string, std::string> places;
    std::set<std::string> called;
    for (const auto& [id, function] : functions_) {
      called.insert(function.callees.begin(), function.callees.end());
      if (function.defined && id.find(':') != std::string::npos) {
        std::string& place = places[symbol_of(id)];
        place = place.empty() || functions_[place].frame_bytes < function.frame_bytes ? id : place;
      }
    }
    for (const std::string& id : called) {
      const auto found = places.find(id);
      if (found != places.end() && !functions_[id].defined) {
        joined_.insert(found->second);
        functions_[id] = functions_[found->second];
      }
    }
  }

  // Prints every fault; the number of them.
  int judge(const std::string& target, const std::vector<Limit>& limits) {
    std::set<std::string> called;
    for (const auto& [id, function] : functions_) {
      called.insert(function.callees.begin(), function.callees.end());
      if (function.defined && function.dynamic) {
        complain(function, "has a frame whose size is not known when compiling");
      }
      if (function.callees.contains(kIndirectCall)) {
        complain(function, "calls through a pointer, so its stack has no known bound");
      }
    }
    std::printf("worst stack on %s, callees and %llu bytes for a compiler helper included:\n", target.c_str(),
                static_cast<unsigned long long>(kHelperBytes));
    for (const auto& [id, function] : functions_) {
      if (!function.defined) {
        continue;
      }
      const std::uint64_t bytes = worst(id) + kHelperBytes;
      const bool is_entry = id.find(':') == std::string::npos && !called.contains(id);
      const Limit* limit = find_limit(function.name, target, limits);
      if (limit == nullptr) {
        if (is_entry) {
          complain(function, "has no row in the table of stack limits");
        }
        continue;
      }
      if (limit->pattern == "*" && !is_entry) {
        continue;  // counts in what calls it
      }
      std::printf("%6llu of %6llu  %s\n", static_cast<unsigned long long>(bytes),
                  static_cast<unsigned long long>(limit->bytes), function.name.c_str());
      print_chain(id);
      if (bytes > limit->bytes) {
        complain(function, ("needs " + std::to_string(bytes) + " bytes of stack; the limit is " +
                            std::to_string(limit->bytes))
                               .c_str());
      }
    }
    return faults_;
  }

  // Prints what an image needs from `root` on; the number of faults.
  int judge_image(const std::string& roots, const std::string& interrupt, const std::set<std::string>& kept) {
    const std::vector<std::string> starts = split(roots, ",");
    const std::string& root = starts[0];
    std::set<std::string> called;
    for (const auto& [id, function] : functions_) {
      if (kept.contains(symbol_of(id))) {
        called.insert(function.callees.begin(), function.callees.end());
      }
    }
    Function& indirect = functions_[kIndirectCall];
    for (const auto& [id, function] : functions_) {
      if (function.defined && kept.contains(symbol_of(id)) && !called.contains(id) && !joined_.contains(id) &&
          std::find(starts.begin(), starts.end(), id) == starts.end() && id != interrupt) {
        indirect.callees.insert(id);
      }
    }
    if (!functions_[root].defined) {
      std::fprintf(stderr, "stack: there is no function %s\n", root.c_str());
      return 1;
    }
    std::uint64_t bytes = worst(root) + kHelperBytes;
    for (const auto& [id, function] : functions_) {
      if (worst_.contains(id) && function.dynamic) {
        complain(function, "has a frame whose size is not known when compiling");
      }
      // The compiler's helpers begin with two underscores and have kHelperBytes.
      if (worst_.contains(id) && !function.defined && id != kIndirectCall && !id.starts_with("__")) {
        std::fprintf(stderr, "stack: %s is called, and has no call graph\n", id.c_str());
        ++faults_;
      }
    }
    if (functions_[interrupt].defined && kept.contains(interrupt)) {
      bytes += kExceptionBytes + worst(interrupt);
    }
    std::printf("%llu\n", static_cast<unsigned long long>(bytes));
    print_chain(root);
    return faults_;
  }

  bool empty() const { return functions_.empty(); }

 private:
  // What the linker calls a function: its id without the file that it is local to.
  static std::string symbol_of(const std::string& id) { return id.substr(id.rfind(':') + 1); }

  void add_node(const std::string& line) {
    Function& function = functions_[field(line, "title")];
    const std::vector<std::string> label = split(field(line, "label"), "\\n");
    function.name = label[0];
    function.place = label.size() > 1 ? label[1] : "";
    for (std::size_t i = 2; i < label.size(); ++i) {
      unsigned long long bytes = 0;
      char kind[32] = "";
      if (std::sscanf(label[i].c_str(), "%llu bytes (%31[^)])", &bytes, kind) == 2) {
        function.defined = true;
        function.frame_bytes = std::max<std::uint64_t>(function.frame_bytes, bytes);
        // "dynamic,bounded" moves the stack pointer for arguments; its number is the maximum.
        function.dynamic = function.dynamic || std::string(kind) == "dynamic";
      }
    }
  }

  void complain(const Function& function, const char* what) {
    std::fprintf(stderr, "stack: %s (%s) %s\n", function.name.c_str(), function.place.c_str(), what);
    ++faults_;
  }

  // Stack of `id` and the deepest chain of calls below it. A cycle is a fault, reported once.
  std::uint64_t worst(const std::string& id) {
    if (const auto known = worst_.find(id); known != worst_.end()) {
      return known->second;
    }
    const Function& function = functions_[id];
    if (!active_.insert(id).second) {
      complain(function, "is recursive");
      return 0;
    }
    std::uint64_t below = 0;
    for (const std::string& callee : function.callees) {
      const std::uint64_t bytes = worst(callee);
      if (bytes > below) {
        below = bytes;
        deepest_[id] = callee;
      }
    }
    active_.erase(id);
    worst_[id] = function.frame_bytes + below;
    return worst_[id];
  }

  void print_chain(const std::string& id) {
    std::string at = id;
    // No longer than there are functions, so that a cycle cannot trap this.
    for (std::size_t i = 0; i < functions_.size(); ++i) {
      std::printf("        %6llu  %s\n", static_cast<unsigned long long>(functions_[at].frame_bytes),
                  functions_[at].name.c_str());
      const auto next = deepest_.find(at);
      if (next == deepest_.end()) {
        return;
      }
      at = next->second;
    }
  }

  static const Limit* find_limit(const std::string& name, const std::string& target,
                                 const std::vector<Limit>& limits) {
    for (const Limit& limit : limits) {
      if (matches(limit.pattern.c_str(), name.c_str()) && matches(limit.target.c_str(), target.c_str())) {
        return &limit;
      }
    }
    return nullptr;
  }

  std::map<std::string, Function> functions_;
  std::map<std::string, std::uint64_t> worst_;
  std::map<std::string, std::string> deepest_;
  std::set<std::string> active_;
  std::set<std::string> joined_;  // called, by another name
  int faults_ = 0;
};

// Rows `pattern,target,limit_bytes`; the pattern may hold commas (parameter lists do), so columns count from
// the right.
bool read_limits(const char* path, std::vector<Limit>& limits) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#' || line == "pattern,target,limit_bytes") {
      continue;
    }
    const std::size_t second = line.rfind(',');
    const std::size_t first =
        second == std::string::npos || second == 0 ? second : line.rfind(',', second - 1);
    Limit limit;
    unsigned long long bytes = 0;
    if (first == std::string::npos || std::sscanf(line.c_str() + second + 1, "%llu", &bytes) != 1) {
      std::fprintf(stderr, "stack: %s: not a row of pattern,target,limit_bytes: %s\n", path, line.c_str());
      return false;
    }
    limit.pattern = line.substr(0, first);
    limit.target = line.substr(first + 1, second - first - 1);
    limit.bytes = bytes;
    limits.push_back(limit);
  }
  return file.eof();
}

bool read_graphs(char** first, char** last, Graph& graph) {
  for (; first != last; ++first) {
    if (!graph.read(*first)) {
      std::fprintf(stderr, "stack: cannot read %s\n", *first);
      return false;
    }
  }
  graph.join_instantiations();
  graph.join_constructors();
  if (graph.empty()) {
    std::fprintf(stderr, "stack: no function in any call graph\n");
    return false;
  }
  return true;
}

int bound_image(int argc, char** argv) {
  std::set<std::string> kept;
  std::ifstream symbols(argv[4]);
  for (std::string name; std::getline(symbols, name);) {
    kept.insert(name);
  }
  Graph graph;
  if (!read_graphs(argv + 5, argv + argc, graph)) {
    return 1;
  }
  return graph.judge_image(argv[2], argv[3], kept) == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc >= 6 && std::string(argv[1]) == "--image") {
    return bound_image(argc, argv);
  }
  if (argc < 4) {
    std::fprintf(stderr,
                 "usage: stack_bound TARGET STACK.csv GRAPH.ci...\n"
                 "       stack_bound --image ROOT INTERRUPT SYMBOLS GRAPH.ci...\n");
    return 2;
  }
  std::vector<Limit> limits;
  if (!read_limits(argv[2], limits)) {
    std::fprintf(stderr, "stack: cannot read %s\n", argv[2]);
    return 1;
  }
  Graph graph;
  if (!read_graphs(argv + 3, argv + argc, graph)) {
    return 1;
  }
  return graph.judge(argv[1], limits) == 0 ? 0 : 1;
}
