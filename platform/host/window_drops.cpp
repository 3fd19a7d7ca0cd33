#include "host/window_drops.h"

#include <X11/Xatom.h>

#include "host/uri_list.h"

namespace thimble::host {
namespace {

constexpr long kVersion = 5;
constexpr long kOldestVersion = 3;
constexpr long kMostWords = 1 << 16;  // of a property that is read, 4 bytes each

// What XGetWindowProperty gives; freed with it.
struct Property {
  Property(::Display* display, ::Window window, Atom name, Bool removes, Atom type) {
    Atom found = 0;
    unsigned long left = 0;
    if (XGetWindowProperty(display, window, name, 0, kMostWords, removes, type, &found, &bits, &count, &left,
                           &data) != Success ||
        found != type) {
      count = 0;
    }
  }
  ~Property() {
    if (data != nullptr) {
      XFree(data);
    }
  }
  Property(const Property&) = delete;
  Property& operator=(const Property&) = delete;

  int bits = 0;
  unsigned long count = 0;
  unsigned char* data = nullptr;
};

}  // namespace

void WindowDrops::announce(::Display* display, ::Window window) {
  display_ = display;
  window_ = window;
  enter_ = atom("XdndEnter");
  position_ = atom("XdndPosition");
  status_ = atom("XdndStatus");
  leave_ = atom("XdndLeave");
  drop_ = atom("XdndDrop");
  finished_ = atom("XdndFinished");
  selection_ = atom("XdndSelection");
  copy_ = atom("XdndActionCopy");
  types_ = atom("XdndTypeList");
  uri_list_ = atom("text/uri-list");
  const Atom version = kVersion;
  XChangeProperty(display, window, atom("XdndAware"), XA_ATOM, 32, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(&version), 1);
}

// What is dragged is offered in up to three types in the message, or else in a list at the source's window.
void WindowDrops::enter(const XClientMessageEvent& message) {
  const long version = message.data.l[1] >> 24 & 0xFF;
  source_ = version >= kOldestVersion ? static_cast<::Window>(message.data.l[0]) : 0;
  has_files_ = false;
  if ((message.data.l[1] & 1) == 0) {
    for (int i = 2; i < 5; ++i) {
      has_files_ = has_files_ || static_cast<Atom>(message.data.l[i]) == uri_list_;
    }
    return;
  }
  const Property offered(display_, source_, types_, False, XA_ATOM);
  const Atom* const types = reinterpret_cast<const Atom*>(offered.data);
  for (unsigned long i = 0; offered.bits == 32 && i < offered.count; ++i) {
    has_files_ = has_files_ || types[i] == uri_list_;
  }
}

void WindowDrops::answer(Atom type, long accepts, Atom action) const {
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = source_;
  event.xclient.message_type = type;
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(window_);
  event.xclient.data.l[1] = accepts;
  // Of a status: no rectangle within which the source need not ask again, then the action; of a finish: the
  // action.
  event.xclient.data.l[type == status_ ? 4 : 2] = static_cast<long>(action);
  XSendEvent(display_, source_, False, NoEventMask, &event);
}

void WindowDrops::ask_for_files(const XClientMessageEvent& message) {
  if (!has_files_) {
    answer(finished_, 0, 0);
    source_ = 0;
    return;
  }
  XConvertSelection(display_, selection_, uri_list_, selection_, window_,
                    static_cast<Time>(message.data.l[2]));
}

std::string WindowDrops::received(const XSelectionEvent& event) const {
  if (event.property == 0) {
    return {};
  }
  const Property list(display_, window_, event.property, True, uri_list_);
  return list.bits == 8 ? std::string(reinterpret_cast<const char*>(list.data), list.count) : std::string();
}

bool WindowDrops::take(const XEvent& event, std::optional<std::string>* path) {
  if (event.type == SelectionNotify && event.xselection.selection == selection_ && source_ != 0) {
    *path = first_file_of(received(event.xselection));
    answer(finished_, *path ? 1 : 0, *path ? copy_ : 0);
    source_ = 0;
    return true;
  }
  if (event.type != ClientMessage) {
    return false;
  }
  const XClientMessageEvent& message = event.xclient;
  const Atom type = message.message_type;
  if (type == enter_) {
    enter(message);
    return true;
  }
  if (type != position_ && type != drop_ && type != leave_) {
    return false;
  }
  if (source_ == 0 || static_cast<::Window>(message.data.l[0]) != source_) {
    return true;  // of no drag that has entered
  }
  if (type == position_) {
    answer(status_, has_files_ ? 1 : 0, has_files_ ? copy_ : 0);
  } else if (type == drop_) {
    ask_for_files(message);
  } else {
    source_ = 0;
  }
  return true;
}

}  // namespace thimble::host
