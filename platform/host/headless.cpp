#include "host/headless.h"

namespace thimble::host {

void HeadlessScreen::show(const Picture& picture) {
  const std::size_t bytes =
      3 * static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px);
  shown_.assign(picture.rgb, picture.rgb + bytes);
  ++pictures_;
}

std::optional<Event> HeadlessScreen::next_event(int /*timeout_ms*/) {
  if (events_.empty()) {
    return std::nullopt;
  }
  const Event event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace thimble::host
