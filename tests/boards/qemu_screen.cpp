// What a person at an emulated board does: presses buttons and looks at the display, over QEMU's machine
// protocol (QMP, JSON lines on a Unix socket).
//
//   qemu_screen SOCKET press|release KEY     KEY as QEMU names it: up, down, left, right, ctrl
//   qemu_screen SOCKET shot FILE.ppm N       the display; N x N equal pixels of QEMU's window are one of the
//   display's qemu_screen SOCKET quit
//   qemu_screen ONE.ppm same OTHER.ppm N     whether two pictures agree in the highest N bits of each channel
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "qemu_screen: %s\n", why.c_str());
  std::exit(1);
}

class Machine {
 public:
  explicit Machine(const char* path) : socket_(socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (std::strlen(path) >= sizeof(address.sun_path)) {
      fail(std::string(path) + " is too long a name for a socket");
    }
    std::memcpy(address.sun_path, path, std::strlen(path));
    // QEMU may still be starting.
    int tries = 100;
    while (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
      if (--tries == 0) {
        fail(std::string("nobody listens on ") + path);
      }
      usleep(50000);
    }
    line();  // the greeting
    ask(R"({"execute":"qmp_capabilities"})");
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;
  ~Machine() { close(socket_); }

  // Sends a command and waits for its answer; events in between are passed over.
  void ask(const std::string& command) {
    const std::string text = command + "\n";
    if (write(socket_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
      fail("QEMU went away");
    }
    for (;;) {
      const std::string answer = line();
      if (answer.find("\"error\"") != std::string::npos) {
        fail(answer);
      }
      if (answer.find("\"return\"") != std::string::npos) {
        return;
      }
    }
  }

 private:
  std::string line() {
    std::string text;
    char next = 0;
    while (read(socket_, &next, 1) == 1) {
      if (next == '\n') {
        return text;
      }
      text += next;
    }
    fail("QEMU went away");
  }

  int socket_;
};

struct Picture {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<char> pixels;
};

// A P6 picture.
Picture read_picture(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  Picture picture;
  int most = 0;
  file >> magic >> picture.width >> picture.height >> most;
  file.get();
  picture.pixels.assign(std::istreambuf_iterator<char>(file), {});
  if (magic != "P6" || most != 255 || picture.pixels.size() != picture.width * picture.height * 3) {
    fail(path + " is no picture of whole pixels");
  }
  return picture;
}

// For displays that drop the lowest bits: whether what is left is the same.
bool agree(const Picture& one, const Picture& other, int bits) {
  if (bits < 1 || bits > 8 || one.width != other.width || one.height != other.height) {
    return false;
  }
  for (std::size_t i = 0; i < one.pixels.size(); ++i) {
    const int different =
        static_cast<unsigned char>(one.pixels[i]) ^ static_cast<unsigned char>(other.pixels[i]);
    if (different >> (8 - bits) != 0) {
      return false;
    }
  }
  return !one.pixels.empty();
}

// Every `scale`-th pixel of a P6 picture, in place; the others must be copies of it.
void shrink(const std::string& path, std::size_t scale) {
  const auto [width, height, pixels] = read_picture(path);
  if (width % scale != 0 || height % scale != 0) {
    fail(path + " is no picture of whole pixels");
  }
  const char* const first = pixels.data();
  const std::size_t row = width * 3;
  const auto at = [&](std::size_t x, std::size_t y) { return first + y * row + x * 3; };
  std::ofstream out(path, std::ios::binary);
  out << "P6\n" << width / scale << ' ' << height / scale << "\n255\n";
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      if (std::memcmp(at(x, y), at(x - x % scale, y - y % scale), 3) != 0) {
        fail(path + ": its pixels are not " + std::to_string(scale) + " wide");
      }
      if (x % scale == 0 && y % scale == 0) {
        out.write(at(x, y), 3);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 2 ? argv[2] : "";
  if (argc == 4 && (what == "press" || what == "release")) {
    Machine(argv[1]).ask(
        R"({"execute":"input-send-event","arguments":{"events":[{"type":"key","data":{"down":)" +
        std::string(what == "press" ? "true" : "false") + R"(,"key":{"type":"qcode","data":")" + argv[3] +
        R"("}}}]}})");
  } else if (argc == 5 && what == "shot") {
    Machine(argv[1]).ask(R"({"execute":"screendump","arguments":{"filename":")" + std::string(argv[3]) +
                         R"("}})");
    shrink(argv[3], static_cast<std::size_t>(std::atoi(argv[4])));
  } else if (argc == 5 && what == "same") {
    return agree(read_picture(argv[1]), read_picture(argv[3]), std::atoi(argv[4])) ? 0 : 1;
  } else if (argc == 3 && what == "quit") {
    Machine(argv[1]).ask(R"({"execute":"quit"})");
  } else {
    std::fprintf(
        stderr,
        "usage: qemu_screen SOCKET press KEY|release KEY|shot FILE.ppm N|quit; ONE.ppm same OTHER.ppm N\n");
    return 2;
  }
  return 0;
}
