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

struct ButtonKey {
  uint16_t code;
  uint32_t button;
};
constexpr ButtonKey kButtonKeys[] = {
    {KEY_UP, port::kUp},       {KEY_DOWN, port::kDown},    {KEY_LEFT, port::kLeft},
    {KEY_RIGHT, port::kRight}, {KEY_ENTER, port::kSelect}, {KEY_SPACE, port::kSelect},
};

// The keys that applications read as letters from their UART.
struct LetterKey {
  uint16_t code;
  char letter;
};
constexpr LetterKey kLetterKeys[] = {
    {KEY_B, 'b'}, {KEY_P, 'p'}, {KEY_Q, 'q'}, {KEY_R, 'r'},
    {KEY_S, 's'}, {KEY_H, 'h'}, {KEY_N, 'n'}, {KEY_ESC, 'q'},
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
  for (const ButtonKey& key : kButtonKeys) {
    if (key.code == code) {
      buttons_ = value != 0 ? buttons_ | key.button : buttons_ & ~key.button;
    }
  }
  if (value == 1) {  // not when it repeats
    for (const LetterKey& key : kLetterKeys) {
      if (key.code == code) {
        typed_.push_back(key.letter);
      }
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
