/// Files that are dragged onto a window from another program: the receiver's part of XDND, version 5, the
/// protocol of file managers (freedesktop.org). Nothing is written: the window's program gets a path.
#pragma once

#include <X11/Xlib.h>

#include <optional>
#include <string>

namespace thimble::host {

class WindowDrops {
 public:
  /// Says to other programs that files may be dropped on the window.
  void announce(::Display* display, ::Window window);
  /// Whether the event is part of a drag or drop; then it has been answered. `path` gets the first file of a
  /// drop that is complete.
  bool take(const XEvent& event, std::optional<std::string>* path);

 private:
  Atom atom(const char* name) const { return XInternAtom(display_, name, False); }
  void enter(const XClientMessageEvent& message);
  void ask_for_files(const XClientMessageEvent& message);
  std::string received(const XSelectionEvent& event) const;
  void answer(Atom type, long accepts, Atom action) const;

  ::Display* display_ = nullptr;
  ::Window window_ = 0;
  ::Window source_ = 0;  // of the drag; 0: none
  bool has_files_ = false;
  Atom enter_ = 0;
  Atom position_ = 0;
  Atom status_ = 0;
  Atom leave_ = 0;
  Atom drop_ = 0;
  Atom finished_ = 0;
  Atom selection_ = 0;
  Atom copy_ = 0;
  Atom types_ = 0;
  Atom uri_list_ = 0;
};

}  // namespace thimble::host
