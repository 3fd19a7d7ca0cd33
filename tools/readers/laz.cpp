// `.laz`: the points of a `.las` file, compressed as LASzip does it. What is unpacked is what `las.cpp` reads.
#include "output/units.h"
#include "readers/formats.h"

namespace thimble::tools {
namespace {

// The arithmetic coder of LASzip: symbols, bits and integers out of bytes, by models that learn as they go.

void refuse_damaged_if(bool is_damaged) {
  fail_if(is_damaged, "its compressed points are damaged or cut off");
}

/// How often each symbol came, and from that its share of the interval. Counts are halved at 2^15.
class SymbolModel {
 public:
  explicit SymbolModel(std::uint32_t symbols) : symbols_(symbols) {}

 private:
  friend class ArithmeticDecoder;
  static constexpr unsigned kShareBits = 15;

  // A model that no symbol needs takes no memory.
  void begin() {
    counts_.assign(symbols_, 1);
    starts_.resize(symbols_);
    cycle_ = symbols_;
    update();
    cycle_ = left_ = (symbols_ + 6) / 2;
  }
  void count(std::uint32_t symbol) {
    ++counts_[symbol];
    if (--left_ == 0) {
      update();
    }
  }
  void update() {
    total_ += cycle_;
    if (total_ > 1U << kShareBits) {
      total_ = 0;
      for (std::uint32_t& count : counts_) {
        count = (count + 1) / 2;
        total_ += count;
      }
    }
    const std::uint32_t scale = 0x80000000U / total_;
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < symbols_; ++i) {
      starts_[i] = scale * sum >> (31 - kShareBits);
      sum += counts_[i];
    }
    cycle_ = left_ = std::min(5 * cycle_ / 4, (symbols_ + 6) * 8);
  }

  std::uint32_t symbols_;
  std::vector<std::uint32_t> counts_{}, starts_{};  ///< starts in parts of 2^kShareBits, ascending
  std::uint32_t total_ = 0, cycle_ = 0, left_ = 0;
};

/// The same of two symbols, with counts up to 2^13.
class BitModel {
  friend class ArithmeticDecoder;
  static constexpr unsigned kShareBits = 13;

  void count(bool bit) {
    zeros_ += bit ? 0 : 1;
    if (--left_ == 0) {
      total_ += cycle_;
      if (total_ > 1U << kShareBits) {
        total_ = (total_ + 1) / 2;
        zeros_ = (zeros_ + 1) / 2;
        total_ += zeros_ == total_ ? 1 : 0;
      }
      share_ = zeros_ * (0x80000000U / total_) >> (31 - kShareBits);
      cycle_ = left_ = std::min(5 * cycle_ / 4, 64U);
    }
  }

  std::uint32_t zeros_ = 1, total_ = 2, share_ = 1U << (kShareBits - 1), cycle_ = 4, left_ = 4;
};

/// Reads symbols from bytes. Each read is bounded; damaged bytes give wrong symbols or the error.
class ArithmeticDecoder {
 public:
  /// @param bytes  what may be read; may be longer than what this stream takes
  explicit ArithmeticDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) {
      value_ = value_ << 8 | next_byte();
    }
  }
  std::size_t taken_bytes() const { return at_; }

  std::uint32_t symbol(SymbolModel& model) {
    if (model.starts_.empty()) {
      model.begin();
    }
    const std::uint32_t unit = length_ >> SymbolModel::kShareBits;
    const auto& starts = model.starts_;
    const auto behind = std::upper_bound(starts.begin(), starts.end(), value_ / unit);
    const std::uint32_t first = *(behind - 1) * unit;
    length_ = (behind == starts.end() ? length_ : *behind * unit) - first;
    value_ -= first;
    refill();
    const auto symbol = static_cast<std::uint32_t>(behind - starts.begin() - 1);
    model.count(symbol);
    return symbol;
  }
  bool bit(BitModel& model) {
    const std::uint32_t zeros = model.share_ * (length_ >> BitModel::kShareBits);
    const bool is_one = value_ >= zeros;
    value_ -= is_one ? zeros : 0;
    length_ = is_one ? length_ - zeros : zeros;
    refill();
    model.count(is_one);
    return is_one;
  }
  /// `count` bits, 1 to 32, as they are.
  std::uint32_t bits(unsigned count) {
    if (count > 19) {
      const std::uint32_t low = bits(16);
      return bits(count - 16) << 16 | low;
    }
    length_ >>= count;
    const std::uint32_t value = value_ / length_;
    refuse_damaged_if(value >> count != 0);
    value_ -= value * length_;
    refill();
    return value;
  }

 private:
  std::uint8_t next_byte() {
    refuse_damaged_if(at_ == bytes_.size());
    return bytes_[at_++];
  }
  void refill() {
    for (; length_ < 1U << 24; length_ <<= 8) {
      value_ = value_ << 8 | next_byte();
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::uint32_t value_ = 0;
  std::uint32_t length_ = 0xFFFFFFFFU;
};

/// Integers as what they differ from a prediction: the bits of the difference by context, then its place among those
/// of so many bits, of which the upper eight have models.
class IntegerModel {
 public:
  IntegerModel(unsigned bits, std::size_t contexts) : bits_(bits), lengths_(contexts, SymbolModel(bits + 1)) {
    for (unsigned k = 1; k <= bits; ++k) {
      places_.emplace_back(1U << std::min(k, kModelBits));
    }
  }

  /// The integer of `bits` bits, wrapped.
  std::uint32_t decode(ArithmeticDecoder& decoder, std::uint32_t predicted, std::size_t context) {
    length_ = decoder.symbol(lengths_[context]);
    const std::uint32_t real = predicted + difference(decoder);
    return bits_ < 32 ? real & ((1U << bits_) - 1) : real;
  }
  /// Of the difference that was read last.
  unsigned length() const { return length_; }

 private:
  static constexpr unsigned kModelBits = 8;

  std::uint32_t difference(ArithmeticDecoder& decoder) {
    if (length_ == 0) {
      return decoder.bit(bit_) ? 1 : 0;
    }
    if (length_ == 32) {
      return 0x80000000U;
    }
    std::uint32_t place = decoder.symbol(places_[length_ - 1]);
    if (length_ > kModelBits) {
      const unsigned low_bits = length_ - kModelBits;
      const std::uint32_t low = decoder.bits(low_bits);
      place = place << low_bits | low;
    }
    // The lower half of the places are the negative differences.
    return place >= 1U << (length_ - 1) ? place + 1 : place - ((1U << length_) - 1);
  }

  unsigned bits_;
  unsigned length_ = 0;
  std::vector<SymbolModel> lengths_, places_{};
  BitModel bit_{};
};

/// The median of the last five numbers, roughly: in turns the highest or the lowest makes room.
class StreamingMedian {
 public:
  std::int32_t get() const { return sorted_[2]; }
  void add(std::int32_t number) {
    std::size_t at = drops_highest_ ? 4 : 0;
    drops_highest_ = drops_highest_ ? number < sorted_[2] : number <= sorted_[2];
    for (; at > 0 && sorted_[at - 1] > number; --at) {
      sorted_[at] = sorted_[at - 1];
    }
    for (; at < 4 && sorted_[at + 1] < number; ++at) {
      sorted_[at] = sorted_[at + 1];
    }
    sorted_[at] = number;
  }

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool drops_highest_ = true;
};

struct Point {
  std::uint32_t x = 0, y = 0, z = 0;
  std::array<std::uint16_t, 3> color{};
  std::uint8_t mark = 0;  ///< byte 15 of the record
};

/// x, y and z of both families of formats: differences by the medians of those before.
class PlaceModel {
 public:
  /// @param median  which of the medians
  void decode_xy(ArithmeticDecoder& decoder, std::size_t median, bool is_single, Point* point) {
    point->x += step(decoder, dx_, medians_[median][0], is_single ? 1 : 0);
    point->y += step(decoder, dy_, medians_[median][1], context(is_single, dx_.length(), 20));
  }
  std::uint32_t decode_z(ArithmeticDecoder& decoder, std::uint32_t predicted, bool is_single) {
    return z_.decode(decoder, predicted, context(is_single, (dx_.length() + dy_.length()) / 2, 18));
  }

 private:
  static std::size_t context(bool is_single, unsigned length, unsigned most) {
    return (is_single ? 1U : 0U) + std::min(length & ~1U, most);
  }
  static std::uint32_t step(ArithmeticDecoder& decoder, IntegerModel& model, StreamingMedian& median,
                            std::size_t context) {
    const std::uint32_t step = model.decode(decoder, static_cast<std::uint32_t>(median.get()), context);
    median.add(static_cast<std::int32_t>(step));
    return step;
  }

  IntegerModel dx_{32, 2}, dy_{32, 22}, z_{32, 20};
  std::array<std::array<StreamingMedian, 2>, 16> medians_{};
};

/// Colours: which of the six bytes changed, then by how much; green and blue follow what red did.
class ColorModel {
 public:
  void decode(ArithmeticDecoder& decoder, std::array<std::uint16_t, 3>* color) {
    const std::uint32_t changed = decoder.symbol(changed_);
    std::array<std::array<int, 2>, 3> bytes{};  // [r, g or b][low, high]
    const auto byte = [&](std::size_t component, std::size_t half, int shift) {
      const int last = (*color)[component] >> (8 * half) & 255;
      const std::size_t i = 2 * component + half;
      bytes[component][half] =
          (changed >> i & 1) == 0
              ? last
              : (std::clamp(last + shift, 0, 255) + static_cast<int>(decoder.symbol(bytes_[i]))) & 255;
      return bytes[component][half] - last;
    };
    std::array<int, 2> shift{};
    shift[0] = byte(0, 0, 0);
    shift[1] = byte(0, 1, 0);
    const bool is_grey = (changed & 64) == 0;
    for (std::size_t half = 0; half < 2; ++half) {
      if (is_grey) {
        bytes[1][half] = bytes[2][half] = bytes[0][half];
      } else {
        const int green = byte(1, half, shift[half]);
        byte(2, half, (shift[half] + green) / 2);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      (*color)[i] = static_cast<std::uint16_t>(bytes[i][0] | bytes[i][1] << 8);
    }
  }

 private:
  SymbolModel changed_{128};
  std::vector<SymbolModel> bytes_{6, SymbolModel(256)};
};

/// Times, which are passed over: where one ends depends on whether steps are 0, so that these are kept.
class TimeModel {
 public:
  void skip(ArithmeticDecoder& decoder) {
    for (int switches = 0;; ++switches) {
      const bool is_still = steps_[now_] == 0;
      const std::uint32_t way = decoder.symbol(is_still ? still_ : multiples_);
      const std::uint32_t full = is_still ? 2 : kFull;
      if (way == full) {
        time_.decode(decoder, 0, 8);
        decoder.bits(16);
        decoder.bits(16);
        newest_ = now_ = (newest_ + 1) & 3;
        steps_[now_] = 0;
        extremes_[now_] = 0;
      } else if (way > full) {
        refuse_damaged_if(switches == 3);  // there are four sequences
        now_ = (now_ + way - full) & 3;
        continue;
      } else if (is_still) {
        if (way == 1) {
          steps_[now_] = time_.decode(decoder, 0, 0);
          extremes_[now_] = 0;
        }
      } else {
        step(decoder, way);
      }
      return;
    }
  }

 private:
  static constexpr std::uint32_t kMost = 500, kLeast = 10, kUnchanged = kMost + kLeast + 1,
                                 kFull = kUnchanged + 1;

  // A multiple of the step before, 0 to 500, or -1 to -10; where it is often an extreme, the step is a new one.
  void step(ArithmeticDecoder& decoder, std::uint32_t way) {
    if (way == kUnchanged) {
      return;
    }
    const std::uint32_t multiple = way <= kMost ? way : kMost - way;
    const std::size_t context = way == 0               ? 7
                                : way == 1             ? 1
                                : way < 10             ? 2
                                : way < kMost          ? 3
                                : way == kMost         ? 4
                                : way < kMost + kLeast ? 5
                                                       : 6;
    const std::uint32_t found = time_.decode(decoder, multiple * steps_[now_], context);
    if (way == 1) {
      extremes_[now_] = 0;
    } else if ((way == 0 || way == kMost || way == kMost + kLeast) && ++extremes_[now_] > 3) {
      steps_[now_] = found;
      extremes_[now_] = 0;
    }
  }

  SymbolModel still_{6}, multiples_{kMost + kLeast + 6};
  IntegerModel time_{32, 9};
  std::size_t now_ = 0, newest_ = 0;
  std::array<std::uint32_t, 4> steps_{};
  std::array<int, 4> extremes_{};
};

int distance(unsigned a, unsigned b) {
  return a > b ? static_cast<int>(a - b) : static_cast<int>(b - a);
}

/// What a point's format keeps in its items.
struct Layout {
  bool has_time = false;
  std::size_t color_offset = 0;  ///< in the raw record, 0 without
  std::size_t extra_bytes = 0;
  std::size_t record_bytes = 0;
  std::size_t layers = 0;  ///< of the new formats
};

std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<std::uint32_t>(load_bits(&bytes[offset], 4, false));
}

// What the first record of a chunk says, which is not packed.
Point raw_point(std::span<const std::uint8_t> record, const Layout& layout) {
  Point point{u32_at(record, 0), u32_at(record, 4), u32_at(record, 8), {}, record[15]};
  for (std::size_t i = 0; i < 3 && layout.color_offset != 0; ++i) {
    point.color[i] = static_cast<std::uint16_t>(load_bits(&record[layout.color_offset + 2 * i], 2, false));
  }
  return point;
}

/// A chunk of formats 0 to 5: all of a point, then the next one, from one stream.
class PointwiseChunk {
 public:
  PointwiseChunk(std::span<const std::uint8_t> bytes, const Layout& layout)
      : layout_(layout),
        point_(raw_point(bytes, layout)),
        flags_(bytes[14]),
        user_(bytes[17]),
        extra_(layout.extra_bytes, SymbolModel(256)),
        decoder_(bytes.subspan(layout.record_bytes)) {}

  const Point& first() const { return point_; }
  const Point& next() {
    const std::uint32_t changed = decoder_.symbol(changed_);
    if ((changed & 32) != 0) {
      flags_ = static_cast<std::uint8_t>(decoder_.symbol(flag_models_[flags_]));
    }
    const unsigned number = flags_ & 7U;
    const unsigned returns = flags_ >> 3 & 7U;
    // Which return of how many a point is, as one number: LASzip's table, which maps what cannot be as well.
    static constexpr std::array<std::string_view, 8> kReturnMaps{
        "fedcba98", "e0136aa9", "d1247bba", "c3458ccb", "b6789ddc", "aabcdeed", "9abcdefe", "89abcdef"};
    const char digit = kReturnMaps[returns][number];
    const auto map = static_cast<std::size_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
    if ((changed & 16) != 0) {
      intensity_.decode(decoder_, 0, std::min<std::size_t>(map, 3));
    }
    if ((changed & 8) != 0) {
      point_.mark = static_cast<std::uint8_t>(decoder_.symbol(classes_[point_.mark]));
    }
    if ((changed & 4) != 0) {
      decoder_.symbol(angles_[flags_ >> 6 & 1]);
    }
    if ((changed & 2) != 0) {
      user_ = static_cast<std::uint8_t>(decoder_.symbol(users_[user_]));
    }
    if ((changed & 1) != 0) {
      source_.decode(decoder_, 0, 0);
    }
    place_.decode_xy(decoder_, map, returns == 1, &point_);
    std::uint32_t& height = heights_[static_cast<std::size_t>(distance(returns, number))];
    height = point_.z = place_.decode_z(decoder_, height, returns == 1);
    if (layout_.has_time) {
      time_.skip(decoder_);
    }
    if (layout_.color_offset != 0) {
      color_.decode(decoder_, &point_.color);
    }
    for (SymbolModel& extra : extra_) {
      decoder_.symbol(extra);
    }
    return point_;
  }
  std::size_t bytes() const { return layout_.record_bytes + decoder_.taken_bytes(); }

 private:
  Layout layout_;
  Point point_;
  std::uint8_t flags_, user_;
  SymbolModel changed_{64};
  std::vector<SymbolModel> flag_models_{256, SymbolModel(256)}, classes_{flag_models_}, users_{flag_models_};
  std::vector<SymbolModel> angles_{2, SymbolModel(256)};
  IntegerModel intensity_{16, 4}, source_{16, 1};
  PlaceModel place_{};
  TimeModel time_{};
  ColorModel color_{};
  std::vector<SymbolModel> extra_;
  std::array<std::uint32_t, 8> heights_{};
  ArithmeticDecoder decoder_;
};

/// A chunk of formats 6 to 10: layers of their own for x and y, heights, flags and colours; of the other layers
/// nothing is wanted. Each of four scanners has its own models.
class LayeredChunk {
 public:
  LayeredChunk(std::span<const std::uint8_t> bytes, const Layout& layout) : layout_(layout) {
    ByteReader sizes(bytes, "a chunk of points");
    sizes.skip(layout.record_bytes + 4);  // how many points it has is known already
    std::uint64_t offset = layout.record_bytes + 4 + 4 * layout.layers;
    for (std::size_t i = 0; i < layout.layers; ++i) {
      const std::uint32_t size = sizes.u32();
      refuse_damaged_if(size > bytes.size() - std::min<std::uint64_t>(offset, bytes.size()));
      const auto layer = bytes.subspan(static_cast<std::size_t>(offset), size);
      offset += size;
      if (size != 0 && (i == kXy || i == kHeights || i == kFlags || i == kColors)) {
        decoders_[i].emplace(layer);
      }
    }
    bytes_ = static_cast<std::size_t>(offset);
    scanner_ = unsigned{bytes[15]} >> 4U & 3U;
    begin(scanner_, {raw_point(bytes, layout), unsigned{bytes[14]} & 15U, unsigned{bytes[14]} >> 4U, false});
  }

  const Point& first() const { return scanners_[scanner_]->last.point; }
  const Point& next() {
    refuse_damaged_if(!decoders_[kXy]);
    ArithmeticDecoder& decoder = *decoders_[kXy];
    Scanner* scanner = scanners_[scanner_].get();
    const Last& before = scanner->last;
    const std::size_t context = (before.number == 1 ? 1U : 0U) | (before.number >= before.returns ? 2U : 0U) |
                                (before.time_changed ? 4U : 0U);
    const std::uint32_t changed = decoder.symbol(scanner->changed[context]);
    if ((changed & 64) != 0) {
      const std::size_t other = (scanner_ + decoder.symbol(scanner->scanner) + 1) & 3;
      if (!scanners_[other]) {
        begin(other, before);
      }
      scanner_ = other;
      scanner = scanners_[other].get();
    }
    Last& last = scanner->last;
    const bool time_changed = (changed & 16) != 0;
    if ((changed & 4) != 0) {
      last.returns = decoder.symbol(scanner->returns[last.returns]);
    }
    if ((changed & 3) == 3) {
      last.number = time_changed ? decoder.symbol(scanner->numbers[last.number])
                                 : (last.number + decoder.symbol(scanner->number_steps) + 2) & 15U;
    } else {
      static constexpr std::array<std::uint32_t, 3> kSteps{0, 1, 15};
      last.number = (last.number + kSteps[changed & 3]) & 15U;
    }
    const bool is_single = last.returns == 1;
    scanner->place.decode_xy(decoder, 2 * return_map(last.returns, last.number) + (time_changed ? 1 : 0),
                             is_single, &last.point);
    if (decoders_[kHeights]) {
      const auto level = static_cast<std::size_t>(std::min(distance(last.returns, last.number), 7));
      std::uint32_t& height = scanner->heights[level];
      height = last.point.z = scanner->place.decode_z(*decoders_[kHeights], height, is_single);
    }
    if (decoders_[kFlags]) {
      // The record's byte is classification flags (4 bits), scanner (2), direction, edge; the layer's has no scanner.
      const unsigned flags = (last.point.mark & 15U) | (last.point.mark >> 2 & 0x30U);
      const std::uint32_t now = decoders_[kFlags]->symbol(scanner->flags[flags]);
      last.point.mark = static_cast<std::uint8_t>((now & 15U) | (now & 0x30U) << 2);
    }
    if (decoders_[kColors] && layout_.color_offset != 0) {
      scanner->color.decode(*decoders_[kColors], &last.point.color);
    }
    last.time_changed = time_changed;
    return last.point;
  }
  std::size_t bytes() const { return bytes_; }

 private:
  enum : std::size_t { kXy = 0, kHeights = 1, kFlags = 3, kColors = 9, kLayers = 10 };
  struct Last {
    Point point;
    std::uint32_t number = 0, returns = 0;  ///< 0 to 15
    bool time_changed = false;
  };
  struct Scanner {
    Last last;
    std::vector<SymbolModel> changed{8, SymbolModel(128)}, returns{16, SymbolModel(16)}, numbers{returns},
        flags{64, SymbolModel(64)};
    SymbolModel scanner{3}, number_steps{13};
    PlaceModel place{};
    ColorModel color{};
    std::array<std::uint32_t, 8> heights{};
  };

  void begin(std::size_t scanner, const Last& last) {
    scanners_[scanner] = std::make_unique<Scanner>();
    scanners_[scanner]->last = last;
    scanners_[scanner]->last.time_changed = false;
    scanners_[scanner]->heights.fill(last.point.z);
  }
  // LASzip's six contexts of a return among others.
  static std::size_t return_map(unsigned returns, unsigned number) {
    static constexpr std::array<std::string_view, 16> kMaps{
        "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
        "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
        "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
        "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455"};
    return static_cast<std::size_t>(kMaps[returns][number] - '0');
  }

  Layout layout_;
  std::array<std::optional<ArithmeticDecoder>, kLayers> decoders_{};
  std::array<std::unique_ptr<Scanner>, 4> scanners_{};
  std::size_t scanner_ = 0;
  std::size_t bytes_ = 0;
};

struct Packing {
  bool is_layered = false;
  bool is_chunked = true;
  std::uint32_t chunk_points = 0;  ///< all ones where the table of chunks says
  Layout layout{};
};

// The items of a point, in their order; each of the new formats has layers of its own.
Layout read_items(ByteReader& record) {
  enum Item : unsigned {
    kByte,
    kPoint10 = 6,
    kTime11,
    kColor12,
    kPoint14 = 10,
    kColor14,
    kColorNir14,
    kWave14,
    kByte14
  };
  Layout layout;
  const unsigned count = record.u16();
  for (unsigned i = 0; i < count; ++i) {
    const unsigned type = record.u16();
    const std::size_t size = record.u16();
    const unsigned version = record.u16();
    const bool is_old = type == kByte || (type >= kPoint10 && type <= kColor12);
    const bool is_new = type >= kPoint14 && type <= kByte14;
    const bool is_first = type == kPoint10 || type == kPoint14;
    fail_if((!is_old || version != 2) && (!is_new || version < 2 || version > 4), "item ", type,
            " of version ", version,
            " in its compressed points is not read (waveforms, or LASzip before 2.0)");
    const std::size_t least = type == kPoint10 ? 20 : type == kPoint14 ? 30 : type == kTime11 ? 8 : 6;
    refuse_damaged_if(is_first != (i == 0) || (type != kByte && type != kByte14 && size < least));
    if (type == kColor12 || type == kColor14 || type == kColorNir14) {
      layout.color_offset = layout.record_bytes;
    }
    layout.has_time = layout.has_time || type == kTime11;
    layout.extra_bytes += type == kByte ? size : 0;
    layout.layers += type == kPoint14 ? 9 : type == kColorNir14 ? 2 : type == kByte14 ? size : is_new ? 1 : 0;
    layout.record_bytes += size;
  }
  return layout;
}

Packing read_packing(const SharedBytes& file, const LasPoints& points) {
  ByteReader header(file.bytes, "the header");
  header.skip(94);
  const std::uint64_t header_bytes = header.u16();
  header.skip(4);
  const std::uint32_t records = header.u32();
  ByteReader all(file.bytes, "the records before the points");
  all.skip(header_bytes);
  for (std::uint32_t i = 0; i < records && all.offset() < points.first_offset; ++i) {
    all.skip(18);
    const unsigned id = all.u16();
    const std::uint16_t size = all.u16();
    all.skip(32);
    const std::uint64_t behind = all.offset() + size;
    if (id == 22204) {
      Packing packing;
      const unsigned compressor = all.u16();
      const unsigned coder = all.u16();
      fail_if(compressor < 1 || compressor > 3 || coder != 0, "compressor ", compressor, " with coder ",
              coder, " of its points is not read");
      packing.is_layered = compressor == 3;
      packing.is_chunked = compressor != 1;
      all.skip(8);
      packing.chunk_points = all.u32();
      all.skip(16);
      packing.layout = read_items(all);
      refuse_damaged_if(packing.layout.record_bytes != points.record_bytes ||
                        packing.is_layered != (packing.layout.layers != 0));
      return packing;
    }
    all.skip(static_cast<std::size_t>(behind - all.offset()));
  }
  throw InputError("its points are compressed, but no record says how");
}

// How many points each chunk has, from the table behind them.
std::vector<std::uint32_t> read_chunk_table(const SharedBytes& file, std::uint64_t table_offset) {
  const std::uint64_t size = file.bytes.size();
  if (table_offset == UINT64_MAX && size >= 8) {  // written to a pipe: the end says where
    table_offset = load_bits(&file.bytes[static_cast<std::size_t>(size - 8)], 8, false);
  }
  refuse_damaged_if(table_offset > size || size - table_offset < 8);
  ByteReader table(file.bytes.subspan(static_cast<std::size_t>(table_offset)), "the table of chunks",
                   table_offset);
  table.skip(4);
  const std::uint32_t count = table.u32();
  refuse_damaged_if(count > size / 16);  // no chunk takes less than its first point
  ArithmeticDecoder decoder(file.bytes.subspan(static_cast<std::size_t>(table_offset) + 8));
  IntegerModel model(32, 2);
  std::vector<std::uint32_t> counts(count);
  std::uint32_t bytes = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    counts[i] = model.decode(decoder, i == 0 ? 0 : counts[i - 1], 0);
    bytes = model.decode(decoder, bytes, 1);
  }
  return counts;
}

void put_point(std::string* out, const Point& point, bool has_color) {
  for (const std::uint32_t number : {point.x, point.y, point.z, std::uint32_t{point.mark} << 24}) {
    append_little(out, number);
  }
  for (std::size_t i = 0; i < 3 && has_color; ++i) {
    append_little(out, point.color[i], 2);
  }
}

/// The records of `points` points from the chunk that begins at `bytes`. @return how many bytes it took
template <class Chunk>
std::size_t unpack_chunk(std::span<const std::uint8_t> bytes, const Layout& layout, std::uint64_t points,
                         bool has_color, std::string* out) {
  refuse_damaged_if(bytes.size() < layout.record_bytes);
  Chunk chunk(bytes, layout);
  put_point(out, chunk.first(), has_color);
  for (std::uint64_t i = 1; i < points; ++i) {
    put_point(out, chunk.next(), has_color);
  }
  return chunk.bytes();
}

}  // namespace

SharedBytes unpack_laz(const SharedBytes& file, const LasPoints& points, bool has_color,
                       const Progress& progress) {
  const Packing packing = read_packing(file, points);
  const std::uint64_t record_bytes = has_color ? kColoredPointBytes : kPlainPointBytes;
  // Real scans take two to ten bytes a point; what was made to take none costs time all the same.
  constexpr std::uint64_t kBelievedPoints = 2'000'000;
  constexpr std::uint64_t kBelievedPerByte = 5;
  fail_if(points.count > kBelievedPoints + kBelievedPerByte * file.bytes.size(), "the header counts ",
          points.count, " points in ", file.bytes.size(), " bytes, more than they are believed to hold");
  std::uint64_t offset = points.first_offset;
  std::vector<std::uint32_t> table;
  if (packing.is_chunked) {
    ByteReader start(file.bytes, "where the table of chunks is");
    start.skip(static_cast<std::size_t>(offset));
    const std::uint64_t table_offset = start.u64();
    offset += 8;
    if (packing.chunk_points == UINT32_MAX) {
      table = read_chunk_table(file, table_offset);
    }
    refuse_damaged_if(packing.chunk_points == 0);
  }
  std::string out;
  out.reserve(static_cast<std::size_t>(points.count * record_bytes));
  ProgressMeter meter(progress, file.bytes.size());
  std::uint64_t left = points.count;
  for (std::size_t i = 0; left != 0; ++i) {
    const bool is_in_table = packing.is_chunked && packing.chunk_points == UINT32_MAX;
    const std::uint64_t chunk = is_in_table          ? (i < table.size() ? table[i] : 0)
                                : packing.is_chunked ? packing.chunk_points
                                                     : left;
    refuse_damaged_if(chunk == 0 || chunk > left + (is_in_table ? 0 : chunk) || offset > file.bytes.size());
    const std::uint64_t count = std::min(chunk, left);
    const auto bytes = file.bytes.subspan(static_cast<std::size_t>(offset));
    offset += packing.is_layered
                  ? unpack_chunk<LayeredChunk>(bytes, packing.layout, count, has_color, &out)
                  : unpack_chunk<PointwiseChunk>(bytes, packing.layout, count, has_color, &out);
    left -= count;
    meter.at(offset);
  }
  return SharedBytes::own(std::move(out));
}

}  // namespace thimble::tools
