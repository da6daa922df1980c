#pragma once

/// \file
/// Random numbers that are the same with every standard library. The generators of <random> are defined to the bit, its
/// distributions are not: with those, the same seed would give another log, another study and another verdict
/// elsewhere. The distributions below give the numbers of the GNU library. They are called as those of <random> are,
/// with a generator such as std::mt19937_64.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace deltadyn {

/// Uniform in [0, 1): the definition of std::generate_canonical<double, 53>.
/// \param random  a generator of whole numbers of 32 or 64 bits
template <class Generator>
[[nodiscard]] double canonical(Generator& random) {
  constexpr std::uint64_t kLargest = Generator::max();
  static_assert(Generator::min() == 0 && (kLargest == std::numeric_limits<std::uint32_t>::max() ||
                                          kLargest == std::numeric_limits<std::uint64_t>::max()));
  double value = 0;
  if constexpr (kLargest == std::numeric_limits<std::uint64_t>::max()) {
    value = static_cast<double>(random()) * 0x1.0p-64;
  } else {
    const auto low = static_cast<double>(random());  // two draws, in this order
    value = (low + static_cast<double>(random()) * 0x1.0p32) * 0x1.0p-64;
  }
  return value < 1 ? value : 0x1.fffffffffffffp-1;  // the largest numbers are rounded to 1
}

/// Uniform in [0, 1), one of the 2^53 multiples of 2^-53. \param random  a generator of 64 bits
template <class Generator>
[[nodiscard]] double unit_of_53_bits(Generator& random) {
  static_assert(Generator::min() == 0 && Generator::max() == std::numeric_limits<std::uint64_t>::max());
  return static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// Uniform in [low, high).
class UniformDistribution {
 public:
  explicit UniformDistribution(double low = 0, double high = 1) : low_(low), high_(high) {}

  template <class Generator>
  [[nodiscard]] double operator()(Generator& random) const {
    return canonical(random) * (high_ - low_) + low_;
  }

 private:
  double low_, high_;
};

/// Normal, by the polar method of Marsaglia (SIAM Review 6, 1964), which gives two numbers at a time: the second is
/// kept for the next call, so that each generator should have a distribution of its own.
class NormalDistribution {
 public:
  explicit NormalDistribution(double mean = 0, double std = 1) : mean_(mean), std_(std) {}

  template <class Generator>
  [[nodiscard]] double operator()(Generator& random) {
    return standard(random) * std_ + mean_;
  }

 private:
  template <class Generator>
  double standard(Generator& random) {
    if (has_second_) {
      has_second_ = false;
      return second_;
    }
    double x = 0, y = 0, square = 0;
    do {
      x = 2.0 * canonical(random) - 1.0;
      y = 2.0 * canonical(random) - 1.0;
      square = x * x + y * y;
    } while (square > 1.0 || square == 0.0);
    const double scale = std::sqrt(-2 * std::log(square) / square);
    second_ = x * scale;
    has_second_ = true;
    return y * scale;
  }

  double mean_, std_, second_ = 0;
  bool has_second_ = false;
};

/// Whole numbers 0 .. count - 1, each as likely as the other, by the method of Lemire (ACM TOMACS 29, 2019).
class UniformIndex {
 public:
  /// \param count  above 0
  explicit UniformIndex(std::size_t count) : count_(count) {}

  /// \param random  a generator of 64 bits
  template <class Generator>
  [[nodiscard]] std::size_t operator()(Generator& random) const {
    static_assert(Generator::min() == 0 && Generator::max() == std::numeric_limits<std::uint64_t>::max());
    // The upper half of the product is the number; draws that would make some numbers likelier are thrown away.
    Product product = times(random(), count_);
    if (product.low < count_) {
      const std::uint64_t threshold = (0 - count_) % count_;
      while (product.low < threshold) product = times(random(), count_);
    }
    return static_cast<std::size_t>(product.high);
  }

 private:
  struct Product {
    std::uint64_t high, low;
  };
  static Product times(std::uint64_t a, std::uint64_t b) {
    constexpr std::uint64_t kLow32 = 0xFFFFFFFFU;
    const std::uint64_t low = (a & kLow32) * (b & kLow32), left = (a >> 32U) * (b & kLow32),
                        right = (a & kLow32) * (b >> 32U);
    const std::uint64_t middle = (low >> 32U) + (left & kLow32) + (right & kLow32);
    return {(a >> 32U) * (b >> 32U) + (left >> 32U) + (right >> 32U) + (middle >> 32U), a * b};
  }

  std::uint64_t count_;
};

}  // namespace deltadyn
