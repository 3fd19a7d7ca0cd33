/// @file svg.h
/// What the plots are written with: numbers, lines and words of an SVG document.
#ifndef THIMBLE_TOOLS_OUTPUT_SVG_H
#define THIMBLE_TOOLS_OUTPUT_SVG_H

#include <string>

namespace thimble::tools {

/// A coordinate, to a tenth of a pixel.
std::string number(double value);

/// Words as XML takes them: what would be markup is written otherwise, and what is no UTF-8 or no character
/// of XML (a file's name may hold any bytes) as U+FFFD.
std::string xml_text(const std::string& plain);

/// A line of the style class `kind`.
std::string line(double x1, double y1, double x2, double y2, const char* kind);

/// Words at a place; `anchor` is start, middle or end, `more` attributes with a blank before each.
std::string label(double x, double y, const char* anchor, const std::string& text,
                  const std::string& more = {});

}  // namespace thimble::tools

#endif
