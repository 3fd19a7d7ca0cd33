// The first process of a Linux that holds nothing else: starts thimble-fb on /dev/fb0 twice, and looks at the
// console afterwards. The first run ends by a key, the second by a signal. It reports on the serial line and
// switches off.
#include <fcntl.h>
#include <linux/kd.h>
#include <linux/reboot.h>
#include <signal.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

FILE* serial;

void say(const char* what, long value) {
  fprintf(serial, "init: %s %ld\n", what, value);
  fflush(serial);
}

pid_t start(const char* console) {
  const pid_t child = fork();
  if (child == 0) {
    setsid();
    const int terminal = open(console, O_RDWR);
    ioctl(terminal, TIOCSCTTY, 0);
    dup2(terminal, 0);
    dup2(fileno(serial), 1);
    dup2(fileno(serial), 2);
    execl("/thimble-fb", "/thimble-fb", "/scene.oct", nullptr);
    _exit(127);
  }
  return child;
}

int ended(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

void look_at_console() {
  const int terminal = open("/dev/tty0", O_RDWR);
  int mode = -1;
  int keyboard = -1;
  ioctl(terminal, KDGETMODE, &mode);
  ioctl(terminal, KDGKBMODE, &keyboard);
  say("console is text:", mode == KD_TEXT ? 1 : 0);
  say("keyboard speaks:", keyboard != K_OFF ? 1 : 0);
  close(terminal);
}

}  // namespace

int main() {
  mkdir("/dev", 0755);
  mount("dev", "/dev", "devtmpfs", 0, nullptr);
  serial = fopen("/dev/ttyS0", "w");
  const int module_file = open("/evdev.ko", O_RDONLY);
  say("evdev loaded:", module_file < 0 ? 0 : syscall(SYS_finit_module, module_file, "", 0) == 0);
  usleep(500000);  // the devices appear

  say("start", 1);
  say("status", ended(start("/dev/tty1")));
  look_at_console();

  say("start", 2);
  const pid_t child = start("/dev/tty1");
  sleep(2);
  kill(child, SIGTERM);
  say("status", ended(child));
  look_at_console();
  sync();
  reboot(LINUX_REBOOT_CMD_POWER_OFF);
}
