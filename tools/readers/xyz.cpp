// `.xyz` and `.csv` point clouds: one point a line.
//
// Columns are separated by blanks and tabs, by commas or by semicolons (with or without blanks around
// them): one of the three for the whole file, decided by the first line of points or by the header that
// names x, y and z. Two commas or semicolons in a row are an empty column; one at the end of a line is an
// empty column or nothing; in a column that begins with a double quote they stand for themselves. All lines have the same number of columns. Blank lines are skipped, and so is
// everything from # to the end of a line. A byte order mark is skipped.
//
// Numbers have a decimal point, never a decimal comma. A line that could be read either way, such as
// "1,5, 2,5, 3,5", is an error; "1,5,2,5,3,5" is six columns.
//
// In order, each optional:
// 1. A first line that is a single whole number announces the number of points (as in chemistry's files and
//    `.pts`); it must then be right, which finds files that were cut off.
// 2. A line whose first column is not a number is a header, once, before all points. Columns named x, y, z
//    (any case, quotes allowed, a leading // allowed) are the coordinates; without these three names they
//    are the first three columns of what follows. Columns named r, g, b, red, green, blue or Rf, Gf, Bf are the colour.
//    Columns named ra and dec (raj2000, ra_icrs, dec, de, ...) are a catalogue of stars: right ascension in degrees, or
//    in hours where none of the file is above 24; declination in degrees; both as 12:34:56.7, too; dist, distance or dist_pc in parsecs, or
//    parallax or plx in thousandths of an arc second, from which the distance is 1000 / parallax; a sphere without
//    either. x points to 0 h, z to the north pole. A star whose number is empty, null or no distance is left out.
// 3. Points. Columns that mean nothing are not read, whatever they hold.
//
// Colour without a header: columns 4 to 6, of 7 and 9 columns the last three, when in the whole file all are from 0
// to 1, or whole numbers up to 255. Otherwise they are normals or something else and ignored. A header that names no
// colour says that there is none.
// Colour by a header: 0 to 1 where no value of the file is above 1, else 0 to 255, or to 65535 when one is above 255.
//
// A count, a comment and lines that begin with an element's symbol are a molecule: its atoms are points.
// Points that are not finite are left out.
#include "output/units.h"
#include "readers/color_scale.h"

namespace thimble::tools {

namespace {

/// Columns of x, y, z, r, g, b. Of a catalogue the first three are right ascension, declination and distance.
constexpr std::size_t kFields = 6;
constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);

constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
/// What stands between the columns of a whole file. One for all lines: a reader that took any of them
/// anywhere would cut decimal commas into columns.
enum class Separator : char { kBlanks = ' ', kComma = ',', kSemicolon = ';' };

/// The separator of the line that decides for the file.
Separator separator_of(std::string_view line) {
  line = without_comment(line);
  if (line.find(';') != std::string_view::npos) {
    return Separator::kSemicolon;
  }
  return line.find(',') != std::string_view::npos ? Separator::kComma : Separator::kBlanks;
}

constexpr const char* name_of(Separator separator) {
  return separator == Separator::kBlanks ? "blanks"
                                         : (separator == Separator::kComma ? "commas" : "semicolons");
}

/// Cuts a line into columns.
class ColumnReader {
 public:
  ColumnReader(std::string_view line, Separator separator)
      : rest_(without_comment(line)), separator_(separator) {
    skip_blanks();
  }

  /// The next column without blanks around it; false at the end. It is empty where two separators meet.
  bool next(std::string_view& column) {
    if (rest_.empty()) {
      return false;
    }
    const bool has_quotes = separator_ != Separator::kBlanks && rest_.front() == '"';
    bool is_quoted = false;
    std::size_t end = 0;
    while (end < rest_.size() && (is_quoted || !ends_column(rest_[end]))) {
      is_quoted = has_quotes && is_quoted != (rest_[end] == '"');
      ++end;
    }
    column = rest_.substr(0, end);
    rest_.remove_prefix(end);
    while (!column.empty() && is_blank(column.back())) {
      column.remove_suffix(1);
    }
    if (separator_ != Separator::kBlanks && !rest_.empty()) {
      rest_.remove_prefix(1);
      skip_blanks();
      ends_open_ = rest_.empty();
    }
    skip_blanks();
    return true;
  }

  /// After the last column: whether a separator followed it.
  bool ends_open() const { return ends_open_; }

 private:
  bool ends_column(char c) const {
    return separator_ == Separator::kBlanks ? is_blank(c) : c == static_cast<char>(separator_);
  }
  void skip_blanks() {
    while (!rest_.empty() && is_blank(rest_.front())) {
      rest_.remove_prefix(1);
    }
  }
  std::string_view rest_;
  Separator separator_;
  bool ends_open_ = false;
};

std::size_t count_columns(ColumnReader& columns) {
  std::size_t count = 0;
  for (std::string_view column; columns.next(column);) {
    ++count;
  }
  return count;
}

/// Whether a line cut at commas could be numbers with decimal commas and a comma and a blank between them, as
/// in "1,5, 2,5, 3,5": at least three pieces, none with more than one comma between bare digits, one with.
bool could_be_decimal_commas(std::string_view line) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  line = without_comment(line);
  std::size_t pieces = 0;
  bool found = false;
  while (!line.empty()) {
    std::size_t end = 0;
    std::size_t commas = 0;
    std::size_t points = 0;
    while (end < line.size() && !is_blank(line[end])) {
      const bool inside = end > 0 && end + 1 < line.size() && is_digit(line[end - 1]);
      commas += line[end] == ',' && inside && is_digit(line[end + 1]) ? 1U : 0U;
      points += line[end] == '.' ? 1U : 0U;
      ++end;
    }
    if (commas > 1 || points > 0) {
      return false;
    }
    pieces += end > 0 ? 1U : 0U;
    found = found || commas == 1;
    line.remove_prefix(end < line.size() ? end + 1 : end);
  }
  return found && pieces >= 3;
}

/// Where things are in a file, found by the first pass and used by all others.
struct Layout {
  std::array<std::size_t, kFields> columns{0, 1, 2, kNoColumn, kNoColumn, kNoColumn};
  bool has_color = false;
  ColorScale scale;
  explicit Layout(const ReadOptions& options) : scale(options) {}
  Separator separator = Separator::kBlanks;
  /// The line that all others must have as many columns as: a header that names x, y and z, or else the
  /// first point.
  std::uint64_t model_line = 0;
  std::size_t model_columns = 0;
  bool model_ends_open = false;
  std::size_t first_point_offset = 0;
  std::uint64_t first_point_line = 1;
  /// Each line begins with an element: a molecule.
  bool has_elements = false;
  /// How a catalogue says how far away its stars are.
  enum class Distance : std::uint8_t {
    kNoCatalogue,
    kNone,
    kParsecs,
    kParallax
  } distance = Distance::kNoCatalogue;
  double ascension_degrees = 1;  ///< of a unit of its right ascensions: 15 of an hour
  bool is_catalogue() const { return distance != Distance::kNoCatalogue; }
  /// A line of words before the points that names no x, y and z; 0 when there is none.
  std::uint64_t title_line = 0;
  bool has_header = false;
  std::int64_t announced = -1;  ///< number of points, or -1
  /// Of the first line of points, where no header stands before it.
  std::size_t unnamed_columns = 0;
  /// Columns that the header names and nothing is taken from, and the first of them.
  std::size_t unread_columns = 0;
  std::string unread;
};

constexpr std::array<const char*, kFields> kFieldNames{"x", "y", "z", "red", "green", "blue"};

/// Degrees or hours, minutes and seconds: "-12:34:56.7".
bool parse_sexagesimal(std::string_view word, double& value) {
  const bool is_below = word.starts_with('-');
  word.remove_prefix(is_below || word.starts_with('+') ? 1 : 0);
  double whole = 0;
  double unit = 1;
  for (int part = 0; part < 3; ++part) {
    const std::size_t colon = std::min(word.find(':'), word.size());
    double number = 0;
    if (parse_number(word.substr(0, colon), number) != NumberKind::kFinite || !(number >= 0)) {
      return false;
    }
    whole += number * unit;
    unit /= 60;
    if (colon == word.size()) {
      value = is_below ? -whole : whole;
      return part != 0;
    }
    word.remove_prefix(colon + 1);
  }
  return false;
}

/// A coordinate as a number, NaN for one that is not finite. Where it is no number because of another separator, the
/// error says what was expected.
double coordinate(std::string_view word, std::uint64_t line, const char* name, const Layout& layout) {
  double value = 0;
  const NumberKind kind = parse_number(word, value);
  if (kind == NumberKind::kFinite) {
    return value;
  }
  if (kind == NumberKind::kNotFinite ||
      (layout.is_catalogue() && (word.empty() || equals_ignoring_case(word, "null")))) {
    return std::nan("");
  }
  if (layout.is_catalogue() && parse_sexagesimal(word, value)) {
    return value;
  }
  const Separator separator = layout.separator;
  const std::string_view marks =
      separator == Separator::kBlanks ? ",;" : (separator == Separator::kComma ? " \t;" : " \t,");
  fail_at_line_if(word.find_first_of(marks) != std::string_view::npos, line, name, " is ", quoted(word),
                  ", which is not a number with a decimal point (the columns of this file are "
                  "separated by ",
                  name_of(separator), ")");
  fail_at_line_if(kind == NumberKind::kGarbage && layout.title_line != 0 && !word.empty(), line, name, " is ",
                  quoted(word), ", which is not a number (the first three columns are read, since line ",
                  layout.title_line, " names no columns x, y and z)");
  return finite_number(word, line, name);
}

/// From right ascension, declination and what says the distance to a place; NaN where that says none.
void place_star(const Layout& layout, CloudPoint& point) {
  constexpr double kRadians = 3.14159265358979323846 / 180;
  const double ascension = point.x * layout.ascension_degrees * kRadians;
  const double declination = point.y * kRadians;
  const double distance = layout.distance == Layout::Distance::kNone       ? 1
                          : layout.distance == Layout::Distance::kParallax ? 1000 / point.z
                                                                           : point.z;
  const double known = distance > 0 && std::isfinite(distance) ? distance : std::nan("");
  point.x = known * std::cos(declination) * std::cos(ascension);
  point.y = known * std::cos(declination) * std::sin(ascension);
  point.z = known * std::sin(declination);
}

/// Reads the points of `text` and calls `visit(point, words, line)`; the words of columns that a line does
/// not have are empty.
template <class VisitLine>
void read_points(std::string_view text, const Layout& layout, ProgressMeter& meter, const VisitLine& visit) {
  LineReader lines(text.substr(layout.first_point_offset));
  std::size_t last_needed = 0;
  for (const std::size_t column : layout.columns) {
    last_needed = column == kNoColumn ? last_needed : std::max(last_needed, column);
  }
  std::string_view line;
  CloudPoint point;
  while (lines.next(line)) {
    meter.at(layout.first_point_offset + lines.offset());
    ColumnReader columns(line, layout.separator);
    std::string_view column;
    std::array<std::string_view, kFields> words{};
    std::size_t count = 0;
    for (; count <= last_needed && columns.next(column); ++count) {
      for (std::size_t field = 0; field < kFields; ++field) {
        if (layout.columns[field] == count) {
          words[field] = column;
        }
      }
    }
    if (count == 0) {
      continue;
    }
    point.line = layout.first_point_line + lines.line_number() - 1;
    point.x = coordinate(words[0], point.line, kFieldNames[0], layout);
    point.y = coordinate(words[1], point.line, kFieldNames[1], layout);
    point.z = layout.columns[2] == kNoColumn ? 1 : coordinate(words[2], point.line, kFieldNames[2], layout);
    visit(point, words, line);
  }
}

class XyzCloud final : public PointCloud {
 public:
  XyzCloud(SharedBytes file, const Layout& layout) : file_(std::move(file)), layout_(layout) {}

  void for_each(const Visit& visit) const override {
    ProgressMeter meter;
    read_points(file_.text(), layout_, meter,
                [&](CloudPoint& point, const std::array<std::string_view, kFields>& words, std::string_view) {
                  if (layout_.is_catalogue()) {
                    place_star(layout_, point);
                  }
                  if (!point.is_finite()) {
                    return;
                  }
                  if (has_color()) {
                    std::array<double, 3> color{};
                    for (std::size_t i = 0; i < 3; ++i) {
                      parse_number(words[3 + i], color[i]);
                    }
                    point.color = layout_.scale.color(color[0], color[1], color[2]);
                  }
                  visit(point);
                });
  }
  bool has_color() const override { return layout_.has_color; }
  const char* counts_in() const override { return "line"; }

 private:
  SharedBytes file_;
  Layout layout_;
};

std::string_view without_quotes(std::string_view name) {
  if (name.starts_with("//")) {
    name.remove_prefix(2);
    name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
  }
  if (name.size() >= 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front()) {
    name = name.substr(1, name.size() - 2);
  }
  return name;
}

/// Finds the columns that a header names; true when those of places are among them.
bool read_header(std::string_view line, Layout& layout) {
  enum : std::size_t { kAscension = kFields, kDeclination, kParsecs, kParallax, kKnown };
  // By field.
  static constexpr std::array<std::string_view, kKnown> kNames{"x",
                                                               "y",
                                                               "z",
                                                               "r red rf",
                                                               "g green gf",
                                                               "b blue bf",
                                                               "ra ra_deg raj2000 ra_icrs",
                                                               "dec de dec_deg dej2000 de_icrs",
                                                               "dist distance dist_pc",
                                                               "parallax plx"};
  std::array<std::size_t, kKnown> found{};
  found.fill(kNoColumn);
  // "// x y z": the slashes are no column.
  const std::size_t slashes = line.find("//");
  if (slashes != std::string_view::npos &&
      std::all_of(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(slashes), is_blank)) {
    line.remove_prefix(slashes + 2);
  }
  ColumnReader columns(line, separator_of(line));
  std::string_view column;
  std::size_t i = 0;
  for (; columns.next(column); ++i) {
    const std::string_view name = without_quotes(column);
    bool is_read = false;
    for (std::size_t field = 0; field < kKnown; ++field) {
      std::string_view names = kNames[field];
      for (std::string_view known = take_word(names); !known.empty(); known = take_word(names)) {
        if (equals_ignoring_case(name, known) && found[field] == kNoColumn) {
          found[field] = i;
          is_read = true;
        }
      }
    }
    if (!is_read && layout.unread_columns++ == 0) {
      layout.unread = name;
    }
  }
  bool names_position = std::find(found.begin(), found.begin() + 3, kNoColumn) == found.begin() + 3;
  if (!names_position && found[kAscension] != kNoColumn && found[kDeclination] != kNoColumn) {
    names_position = true;
    layout.distance = found[kParsecs] != kNoColumn    ? Layout::Distance::kParsecs
                      : found[kParallax] != kNoColumn ? Layout::Distance::kParallax
                                                      : Layout::Distance::kNone;
    found[0] = found[kAscension];
    found[1] = found[kDeclination];
    found[2] = found[kParsecs] != kNoColumn ? found[kParsecs] : found[kParallax];
  }
  if (names_position) {
    layout.separator = separator_of(line);
    layout.model_columns = i;
    layout.model_ends_open = columns.ends_open();
    std::copy(found.begin(), found.begin() + 3, layout.columns.begin());
  }
  if (std::find(found.begin() + 3, found.begin() + kFields, kNoColumn) == found.begin() + kFields) {
    std::copy(found.begin() + 3, found.begin() + kFields, layout.columns.begin() + 3);
  }
  return names_position;
}

/// An element's symbol and three numbers, as a line of a molecule is.
bool is_atom(std::string_view line) {
  ColumnReader columns(line, Separator::kBlanks);
  std::string_view column;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (!columns.next(column) || column.size() > 2 || !std::all_of(column.begin(), column.end(), is_letter)) {
    return false;
  }
  double value = 0;
  for (int i = 0; i < 3; ++i) {
    if (!columns.next(column) || parse_number(column, value) == NumberKind::kGarbage) {
      return false;
    }
  }
  return true;
}

/// Reads what stands before the points.
void read_preamble(std::string_view text, Layout& layout) {
  const std::size_t begin = mark_bytes(text);
  layout.first_point_offset = begin;
  LineReader lines(text.substr(begin));
  std::string_view line;
  while (lines.next(line)) {
    const Separator separator = separator_of(line);
    ColumnReader columns(line, separator);
    std::string_view first;
    std::string_view second;
    if (!columns.next(first)) {
      continue;
    }
    double value = 0;
    const bool is_single = !columns.next(second);
    if (layout.announced < 0 && !layout.has_header && is_single && parse_integer(first, layout.announced) &&
        layout.announced >= 0) {
      layout.first_point_offset = begin + lines.offset();
      layout.first_point_line = lines.line_number() + 1;
      LineReader after = lines;
      if (after.next(line)) {  // a molecule's comment
        LineReader ahead = after;
        std::string_view atom;
        if (ahead.next(atom) && is_atom(atom)) {
          layout.has_header = true;
          layout.has_elements = true;
          layout.columns = {1, 2, 3, kNoColumn, kNoColumn, kNoColumn};
          layout.first_point_offset = begin + after.offset();
          layout.first_point_line = after.line_number() + 1;
          break;
        }
      }
      continue;
    }
    layout.announced = std::max<std::int64_t>(layout.announced, -1);
    // "nan" in the first column is a bad coordinate rather than a name.
    if (parse_number(first, value) == NumberKind::kGarbage) {
      const std::string_view name = without_quotes(first);
      const char c = name.empty() ? '\0' : name.front();
      const bool is_name = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '/';
      // That of the rows' names may be empty, and a name may begin with any letter, where x, y and z are named.
      Layout named = layout;
      const bool names_places = read_header(line, named);
      // Of a second one, reading it as a point says what is wrong.
      if ((is_name || names_places) && !layout.has_header) {
        layout = named;
        layout.has_header = true;
        layout.first_point_offset = begin + lines.offset();
        layout.first_point_line = lines.line_number() + 1;
        if (names_places) {
          layout.model_line = lines.line_number();
          break;
        }
        layout.title_line = lines.line_number();
        continue;  // a title; the first point settles the separator
      }
    }
    layout.separator = separator;
    layout.unnamed_columns = layout.has_header ? 0 : count_columns(columns) + (is_single ? 1 : 2);
    break;
  }
}

/// Refuses a line that is cut otherwise than the model line: what it means would be a guess.
void check_columns(std::string_view line, std::uint64_t number, Layout& layout) {
  ColumnReader columns(line, layout.separator);
  const std::size_t count = count_columns(columns);
  if (layout.model_line == 0) {
    layout.model_line = number;
    layout.model_columns = count;
    layout.model_ends_open = columns.ends_open();
  }
  // A separator at the end may stand for an empty last column, or for nothing.
  const bool fits = count == layout.model_columns ||
                    (columns.ends_open() && count + 1 == layout.model_columns) ||
                    (layout.model_ends_open && count == layout.model_columns + 1);
  if (!fits) {
    fail_at_line(number, counted(count, "column"), ", but line ", layout.model_line, " has ",
                 layout.model_columns);
  }
  // A header that names the columns has settled it by their number.
  const bool has_names = layout.model_line < layout.first_point_line;
  fail_at_line_if(!has_names && layout.separator == Separator::kComma && could_be_decimal_commas(line),
                  number,
                  "the commas may be decimal commas; write decimal points, or the same blanks after "
                  "every comma");
}

}  // namespace

/// No memory depends on the number of points. `CloudPoint::line` is the line in the file.
/// @throws InputError  naming the line: a column that is missing, empty or no number, a colour out of
///   range, a number of columns that differs; an announced number of points that
///   is wrong; no point that is finite
Source read_xyz(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  Layout layout(options);
  read_preamble(file.text(), layout);
  const bool names_color = layout.columns[3] != kNoColumn;
  const std::size_t columns = layout.unnamed_columns;
  if (!layout.has_header) {
    // Of x y z intensity r g b, and of x y z nx ny nz r g b.
    const std::size_t color = columns == 7 || columns == 9 ? columns - 3 : 3;
    layout.columns = {0, 1, 2, color, color + 1, color + 2};
  }
  ProgressMeter meter(progress, file.bytes.size());
  std::uint64_t bad_line = 0;  // whose colour is no colour
  std::uint64_t count = 0;
  std::uint64_t finite = 0;
  double last_ascension = 0;
  read_points(
      file.text(), layout, meter,
      [&](const CloudPoint& read, const std::array<std::string_view, kFields>& words, std::string_view line) {
        ++count;
        CloudPoint point = read;
        check_columns(line, point.line, layout);
        if (layout.is_catalogue()) {
          last_ascension = std::max(last_ascension, point.x);
          place_star(layout, point);
        }
        if (!point.is_finite()) {
          return;
        }
        ++finite;
        // Without a header, one line that does not look like a colour settles the matter.
        for (std::size_t i = 3; i < kFields && bad_line == 0; ++i) {
          double value = 0;
          const bool is_good = parse_number(words[i], value) == NumberKind::kFinite && value >= 0;
          bad_line = is_good ? 0 : point.line;
          layout.scale.see(is_good ? value : 0);
        }
      });
  fail_if(finite == 0, count == 0 ? "the file holds no points" : "no point of the file is finite");
  fail_if(layout.announced >= 0 && static_cast<std::uint64_t>(layout.announced) != count,
          "the first line announces ", layout.announced, " points, but the file holds ", count);
  if (names_color) {
    fail_at_line_if(bad_line != 0, bad_line, "the color is missing, negative or not a number");
    fail_if(!layout.scale.is_valid(), "the columns of the color hold values above 65535");
    layout.has_color = true;
  } else {
    layout.has_color = columns >= 6 && bad_line == 0 && layout.scale.looks_like_colors();
  }
  if (!layout.has_color) {
    std::fill(layout.columns.begin() + 3, layout.columns.end(), kNoColumn);
  }
  layout.ascension_degrees = last_ascension <= 24 ? 15 : 1;
  auto cloud = std::make_unique<XyzCloud>(file, layout);
  if (layout.is_catalogue()) {
    cloud->notes.push_back(std::string("it is a catalogue of stars: right ascensions are ") +
                           (last_ascension <= 24 ? "hours" : "degrees") + ", " +
                           (layout.distance == Layout::Distance::kNone ? "all are drawn as far away"
                            : layout.distance == Layout::Distance::kParsecs
                                ? "distances are as they are"
                                : "distances are 1000 / parallax") +
                           (count == finite ? ""
                                            : "; " + std::to_string(count - finite) + " of " +
                                                  std::to_string(count) + " have none and are left out"));
  } else {
    note_left_out(cloud->notes, count - finite);
  }
  if (layout.has_color) {
    layout.scale.add_note(cloud->notes);
  }
  note_if(layout.title_line != 0, cloud->notes, "line ", layout.title_line,
          " names no columns x, y and z: the first three are taken for places");
  note_if(layout.title_line == 0 && layout.unread_columns != 0 && !layout.is_catalogue(), cloud->notes,
          layout.unread.empty() ? "the column without a name" : "the column " + quoted(layout.unread),
          layout.unread_columns == 1 ? " is" : concat(" and ", layout.unread_columns - 1, " more are"),
          " not read");
  const std::size_t color = layout.columns[3] + 1;
  note_if(layout.has_elements, cloud->notes,
          "it is a molecule: its atoms are points, their elements are not shown");
  note_if(!layout.has_elements && columns > (layout.has_color ? 6U : 3U), cloud->notes, "no line names the ",
          columns, " columns: 1 to 3 are taken for places, ",
          layout.has_color ? concat(color, " to ", color + 2) : "none", " for colors");
  return cloud;
}

}  // namespace thimble::tools
