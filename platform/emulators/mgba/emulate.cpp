// Runs an image as a Game Boy Advance would, by libmgba, without a display: the serial port on stdin and
// stdout, the exit status the application's.
//
//   emulate IMAGE.gba [-qmp unix:SOCKET,...] [-shot PICTURE.ppm]
//
// -qmp answers as QEMU's machine protocol does to tests/boards/qemu_screen.cpp: screendump, input-send-event,
// quit. -shot writes what the display shows at the end. libmgba leaves the serial port's UART out, so it is
// modelled here, from the halfwords that the core reads and writes; it takes no time.
#include <mgba-util/vfs.h>
#include <mgba/core/config.h>
#include <mgba/core/core.h>
#include <mgba/core/log.h>
#include <mgba/gba/core.h>
#include <mgba/internal/arm/arm.h>
#include <mgba/internal/gba/input.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

constexpr int kRefused = 96;
constexpr uint32_t kSerialControl = 0x04000128;
constexpr uint32_t kSerialData = 0x0400012A;
constexpr uint16_t kReceiveEmpty = 1U << 5;
constexpr uint16_t kSends = 1U << 10;
constexpr uint16_t kReceives = 1U << 11;
constexpr uint16_t kUart = 3U << 12;
constexpr int kStop = 3;  // the boot ROM's call with which an image ends
constexpr unsigned kWidth = 240;
constexpr unsigned kHeight = 160;

// What libmgba's callbacks, which take no context, work on.
struct Console {
  mCore* core = nullptr;
  ARMMemory bus = {};  // as libmgba has it
  ARMInterruptHandler calls = {};
  uint16_t serial_control = 0;
  std::deque<uint8_t> keys;  // wait until the board reads
  std::string said;
  int status = -1;  // once it has ended
  std::vector<color_t> picture = std::vector<color_t>(kWidth * kHeight);
};
Console console;

void tell(const std::string& text) {
  std::fprintf(stderr, "mgba: %s\n", text.c_str());
}

void store16(ARMCore* cpu, uint32_t address, int16_t value, int* cycles) {
  if (address == kSerialControl) {
    console.serial_control = static_cast<uint16_t>(value);
  } else if (address == kSerialData) {
    if ((console.serial_control & (kUart | kSends)) == (kUart | kSends) && console.status < 0) {
      console.said += static_cast<char>(value & 0xFF);
    }
  } else {
    console.bus.store16(cpu, address, value, cycles);
  }
}

uint32_t load16(ARMCore* cpu, uint32_t address, int* cycles) {
  const bool hears = (console.serial_control & (kUart | kReceives)) == (kUart | kReceives);
  if (address == kSerialControl) {
    const bool is_empty = !hears || console.keys.empty();
    return static_cast<uint32_t>(console.serial_control) | (is_empty ? kReceiveEmpty : 0U);
  }
  if (address == kSerialData) {
    if (!hears || console.keys.empty()) {
      return 0;
    }
    const uint8_t key = console.keys.front();
    console.keys.pop_front();
    return key;
  }
  return console.bus.load16(cpu, address, cycles);
}

// r0 is the status of an image that ends.
void call(ARMCore* cpu, int number) {
  if (number != kStop) {
    console.calls.swi16(cpu, number);
  } else if (console.status < 0) {
    console.status = cpu->gprs[0] & 0xFF;
  }
}

[[gnu::format(printf, 4, 0)]] void be_quiet(mLogger* /*logger*/, int /*category*/, mLogLevel level,
                                            const char* format, va_list values) {
  if (level == mLOG_FATAL) {
    std::vfprintf(stderr, format, values);
    std::fputc('\n', stderr);
  }
}

// What the boot ROM looks at before it starts a cartridge, but for the picture (platform/boards/gba/header.cpp).
std::string refusal_of(const std::vector<uint8_t>& image) {
  if (image.size() < 0xC0) {
    return "shorter than a cartridge's header";
  }
  unsigned sum = 0x19;
  for (size_t i = 0xA0; i <= 0xBD; ++i) {
    sum += image[i];
  }
  if (image[0xB2] != 0x96 || (sum & 0xFF) != 0) {
    return "the header has a wrong checksum: a console would not start it";
  }
  return "";
}

bool write_picture(const std::string& name) {
  std::ofstream file(name, std::ios::binary);
  file << "P6\n" << kWidth << ' ' << kHeight << "\n255\n";
  for (const color_t pixel : console.picture) {
    const char bytes[3] = {static_cast<char>(pixel), static_cast<char>(pixel >> 8),
                           static_cast<char>(pixel >> 16)};
    file.write(bytes, sizeof(bytes));
  }
  return file.good();
}

// The answer to a wish of one line.
nlohmann::json answer(const std::string& line) {
  const auto wish = nlohmann::json::parse(line, nullptr, false);
  const auto error = [](const std::string& why) { return nlohmann::json{{"error", {{"desc", why}}}}; };
  if (!wish.is_object()) {
    return error("no JSON object");
  }
  const std::string name = wish.value("execute", "");
  if (name == "screendump") {
    const std::string file = wish["arguments"].value("filename", "");
    if (!write_picture(file)) {
      return error("cannot write " + file);
    }
  } else if (name == "input-send-event") {
    const std::map<std::string, int> keys = {
        {"up", GBA_KEY_UP},       {"down", GBA_KEY_DOWN}, {"left", GBA_KEY_LEFT},
        {"right", GBA_KEY_RIGHT}, {"ctrl", GBA_KEY_A},    {"a", GBA_KEY_A},
        {"b", GBA_KEY_B},         {"ret", GBA_KEY_START}, {"spc", GBA_KEY_SELECT}};
    for (const auto& event : wish["arguments"]["events"]) {
      const auto found = keys.find(event["data"]["key"].value("data", ""));
      if (found == keys.end()) {
        return error("the console has no such key");
      }
      const uint32_t key = 1U << found->second;
      if (event["data"].value("down", false)) {
        console.core->addKeys(console.core, key);
      } else {
        console.core->clearKeys(console.core, key);
      }
    }
  } else if (name == "quit") {
    console.status = console.status < 0 ? 0 : console.status;
  } else if (name != "qmp_capabilities") {
    return error("no such wish: " + name);
  }
  return {{"return", nlohmann::json::object()}};
}

// One client at a time, as qemu_screen is.
class Wishes {
 public:
  bool listen_on(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof(address.sun_path)) {
      return false;
    }
    std::memcpy(address.sun_path, path.c_str(), path.size());
    unlink(path.c_str());
    listener_ = socket(AF_UNIX, SOCK_STREAM, 0);
    return bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 &&
           listen(listener_, 4) == 0;
  }

  void serve() {
    pollfd ready = {client_ >= 0 ? client_ : listener_, POLLIN, 0};
    if (ready.fd < 0 || poll(&ready, 1, 0) <= 0) {
      return;
    }
    if (client_ < 0) {
      client_ = accept(listener_, nullptr, nullptr);
      text_.clear();
      send("{\"QMP\":{}}\n");
      return;
    }
    char bytes[4096];
    const ssize_t count = read(client_, bytes, sizeof(bytes));
    if (count <= 0) {
      close(client_);
      client_ = -1;
      return;
    }
    text_.append(bytes, static_cast<size_t>(count));
    for (size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      send(answer(text_.substr(0, end)).dump() + "\n");
      text_.erase(0, end + 1);
    }
  }

 private:
  void send(const std::string& line) {
    if (client_ >= 0 && write(client_, line.data(), line.size()) < 0) {
      close(client_);
      client_ = -1;
    }
  }

  int listener_ = -1;
  int client_ = -1;
  std::string text_;
};

void take_keys() {
  static bool is_open = true;
  pollfd ready = {STDIN_FILENO, POLLIN, 0};
  if (!is_open || poll(&ready, 1, 0) <= 0) {
    return;
  }
  uint8_t bytes[256];
  const ssize_t count = read(STDIN_FILENO, bytes, sizeof(bytes));
  is_open = count > 0;
  console.keys.insert(console.keys.end(), bytes, bytes + (count > 0 ? count : 0));
}

void flush() {
  std::string_view rest = console.said;
  while (!rest.empty()) {
    const ssize_t count = write(STDOUT_FILENO, rest.data(), rest.size());
    if (count <= 0) {
      console.status = console.status < 0 ? 0 : console.status;  // nobody listens any more
      break;
    }
    rest.remove_prefix(static_cast<size_t>(count));
  }
  console.said.clear();
}

bool start(const std::vector<uint8_t>& image) {
  mCore* const core = GBACoreCreate();
  console.core = core;
  if (core == nullptr || !core->init(core)) {
    return false;
  }
  mCoreInitConfig(core, nullptr);
  mCoreConfigSetValue(&core->config, "idleOptimization", "ignore");
  mCoreConfigSetIntValue(&core->config, "useBios", 0);
  mCoreLoadConfig(core);
  core->setVideoBuffer(core, console.picture.data(), kWidth);
  if (!core->loadROM(core, VFileFromConstMemory(image.data(), image.size()))) {
    return false;
  }
  core->reset(core);
  auto* const cpu = static_cast<ARMCore*>(core->cpu);
  console.bus = cpu->memory;
  console.calls = cpu->irqh;
  cpu->memory.store16 = store16;
  cpu->memory.load16 = load16;
  cpu->irqh.swi16 = call;
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> options;
  for (int i = 2; i + 1 < argc; i += 2) {
    options[argv[i]] = argv[i + 1];
  }
  if (argc < 2 || argc % 2 != 0) {
    std::fprintf(stderr, "usage: emulate IMAGE.gba [-qmp unix:SOCKET,...] [-shot PICTURE.ppm]\n");
    return 2;
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::ifstream file(argv[1], std::ios::binary);
  const std::vector<uint8_t> image((std::istreambuf_iterator<char>(file)), {});
  const std::string refusal = refusal_of(image);
  if (!refusal.empty()) {
    tell(std::string(argv[1]) + ": " + refusal);
    return kRefused;
  }
  mLogger quiet = {be_quiet, nullptr};
  mLogSetDefaultLogger(&quiet);
  if (!start(image)) {
    tell(std::string(argv[1]) + ": libmgba does not take it");
    return kRefused;
  }
  Wishes wishes;
  std::string socket = options["-qmp"];
  if (!socket.empty()) {
    socket = socket.substr(0, socket.find(',')).substr(socket.rfind("unix:", 0) == 0 ? 5 : 0);
    if (!wishes.listen_on(socket)) {
      tell("cannot listen on " + socket);
      return 2;
    }
  }
  while (console.status < 0) {
    take_keys();
    console.core->runFrame(console.core);
    flush();
    wishes.serve();
  }
  const std::string shot = options["-shot"];
  if (!shot.empty()) {
    console.core->runFrame(console.core);  // what was drawn last
    if (!write_picture(shot)) {
      tell("cannot write " + shot);
      return 2;
    }
  }
  return console.status;
}
