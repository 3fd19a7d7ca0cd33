#include "linux/keys.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "port.h"

namespace thimble::linux_port {
namespace {

// What a key is to applications: a button, or a letter that they read from their UART.
struct KnownKey {
  uint16_t code;
  uint32_t button;
  char letter;
};
constexpr KnownKey kKeys[] = {
    {KEY_UP, port::kUp, 0},
    {KEY_DOWN, port::kDown, 0},
    {KEY_LEFT, port::kLeft, 0},
    {KEY_RIGHT, port::kRight, 0},
    {KEY_ENTER, port::kSelect, 0},
    {KEY_SPACE, port::kSelect, 0},
    {KEY_B, 0, 'b'},
    {KEY_P, 0, 'p'},
    {KEY_Q, 0, 'q'},
    {KEY_R, 0, 'r'},
    {KEY_S, 0, 's'},
    {KEY_H, 0, 'h'},
    {KEY_N, 0, 'n'},
    {KEY_ESC, 0, 'q'},
};

// Whether a device has keys at all: a mouse or a lid switch is not for us.
bool has_keys(int file) {
  unsigned long kinds = 0;
  return ioctl(file, EVIOCGBIT(0, sizeof kinds), &kinds) >= 0 && (kinds >> EV_KEY & 1) != 0;
}

}  // namespace

Keys::~Keys() {
  for (const int file : devices_) {
    close(file);
  }
}

int Keys::open_all(const std::string& folder) {
  DIR* listing = opendir(folder.c_str());
  if (listing == nullptr) {
    return 0;
  }
  while (const dirent* entry = readdir(listing)) {
    const std::string name = entry->d_name;
    if (name.rfind("event", 0) != 0) {
      continue;
    }
    const int file = open((folder + "/" + name).c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) {
      continue;
    }
    if (has_keys(file)) {
      devices_.push_back(file);
    } else {
      close(file);
    }
  }
  closedir(listing);
  return static_cast<int>(devices_.size());
}

void Keys::take(uint16_t code, int32_t value) {
  for (const KnownKey& key : kKeys) {
    if (key.code != code) {
      continue;
    }
    buttons_ = value != 0 ? buttons_ | key.button : buttons_ & ~key.button;
    if (value == 1 && key.letter != 0) {  // not when it repeats
      typed_.push_back(key.letter);
    }
  }
}

void Keys::poll() {
  for (size_t i = 0; i < devices_.size();) {
    input_event events[64];
    const ssize_t bytes = ::read(devices_[i], events, sizeof events);
    if (bytes < 0 && errno == ENODEV) {  // it was pulled out: nothing on it is down any more
      close(devices_[i]);
      devices_.erase(devices_.begin() + static_cast<std::ptrdiff_t>(i));
      buttons_ = 0;
      continue;
    }
    const size_t count = bytes > 0 ? static_cast<size_t>(bytes) / sizeof events[0] : 0;
    for (size_t e = 0; e < count; ++e) {
      if (events[e].type == EV_KEY) {
        take(events[e].code, events[e].value);
      }
    }
    if (count < sizeof events / sizeof events[0]) {
      ++i;
    }
  }
  // A pipe or a terminal may type as well. (The console itself is silent while we draw.)
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char letters[64];
  while (input_open_ && ::poll(&input, 1, 0) == 1 && input.revents != 0) {
    const ssize_t bytes = ::read(STDIN_FILENO, letters, sizeof letters);
    input_open_ = bytes > 0;
    typed_.insert(typed_.end(), letters, letters + (bytes > 0 ? bytes : 0));
  }
}

int Keys::read() {
  if (typed_.empty()) {
    return -1;
  }
  const char letter = typed_.front();
  typed_.pop_front();
  return static_cast<unsigned char>(letter);
}

}  // namespace thimble::linux_port
