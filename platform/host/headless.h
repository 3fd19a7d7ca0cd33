/// @file headless.h
/// A screen that nobody looks at, for machines without one, for tests and for scripts.
#ifndef THIMBLE_PLATFORM_HOST_HEADLESS_H
#define THIMBLE_PLATFORM_HOST_HEADLESS_H

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "host/screen.h"

namespace thimble::host {

/// Keeps what was shown last and gives out the events that were pushed; never waits.
class HeadlessScreen final : public Screen {
 public:
  explicit HeadlessScreen(std::string fault = {}) : fault_(std::move(fault)) {}
  void push(const Event& event) { events_.push_back(event); }
  const std::vector<std::uint8_t>& shown() const { return shown_; }
  std::uint32_t pictures() const { return pictures_; }
  const std::string& status() const { return status_; }

  void show(const Picture& picture) override;
  void set_status(std::string_view text) override { status_ = text; }
  void set_overlay(std::string_view /*text*/) override {}
  void set_title(std::string_view /*text*/) override {}
  std::optional<Event> next_event(int timeout_ms) override;
  std::int32_t width_px() const override { return 0; }
  std::int32_t height_px() const override { return 0; }
  std::string fault() const override { return fault_; }
  const char* name() const override { return "none"; }

 private:
  std::deque<Event> events_;
  std::vector<std::uint8_t> shown_;
  std::string fault_;
  std::string status_;
  std::uint32_t pictures_ = 0;
};

}  // namespace thimble::host

#endif
