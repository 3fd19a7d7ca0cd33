/// Whether a text is XML such as a plot writes it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace thimble::tests {

/// The number of elements, or -1 where not every tag is closed in order with its attributes in quotes.
inline int elements_of(const std::string& xml) {
  std::vector<std::string> open;
  int elements = 0;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos || xml.find('<', at + 1) < end ||
        std::count(xml.begin() + static_cast<std::ptrdiff_t>(at),
                   xml.begin() + static_cast<std::ptrdiff_t>(end), '"') %
                2 !=
            0) {
      return -1;
    }
    const std::string tag = xml.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag.front() == '/') {
      if (open.empty() || "/" + open.back() != tag) {
        return -1;
      }
      open.pop_back();
    } else {
      ++elements;
      if (tag.back() != '/') {
        open.push_back(name);
      }
    }
    at = end;
  }
  return open.empty() ? elements : -1;
}

}  // namespace thimble::tests
