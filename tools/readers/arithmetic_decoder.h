/// The arithmetic coder of LASzip: symbols, bits and integers out of bytes, by models that learn as they go.
///
/// Source: A. Said, "Introduction to Arithmetic Coding - Theory and Practice" (HPL-2004-76), and his FastAC.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "readers/input_error.h"

namespace thimble::tools {

[[noreturn]] inline void refuse_damaged() {
  throw InputError("its compressed points are damaged or cut off");
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
    if (value >> count != 0) {
      refuse_damaged();
    }
    value_ -= value * length_;
    refill();
    return value;
  }

 private:
  std::uint8_t next_byte() {
    if (at_ == bytes_.size()) {
      refuse_damaged();
    }
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

}  // namespace thimble::tools
