#include "predicates.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#ifdef __FAST_MATH__
#error "the filters of the predicates need IEEE arithmetic: compile without -ffast-math"
#endif

namespace meshgraft {

namespace {

// A finite double as ± mantissa · 2^exponent, the mantissa below 2^53. Zero has the mantissa 0.
struct DoubleParts {
  std::uint64_t mantissa = 0;
  int exponent = 0;
  bool negative = false;
};

DoubleParts double_parts(double x) {
  constexpr int mantissa_bits = 52, bias = 1075;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const auto biased = static_cast<int>((bits >> mantissa_bits) & 0x7ff);
  const std::uint64_t fraction = bits & ((std::uint64_t{1} << mantissa_bits) - 1);
  if (biased == 0) return {fraction, 1 - bias, x < 0};
  return {fraction | (std::uint64_t{1} << mantissa_bits), biased - bias, x < 0};
}

int sign_of(auto value) { return (value > 0) - (value < 0); }

// The exact sum of products of up to three doubles, in fixed point: two's complement over the exponents of
// the products. Always decides the sign, at the cost of hundreds of operations.
class ProductSum {
 public:
  // The `products`, at most 24, have exponents from `least` to `largest`.
  ProductSum(int least, int largest) : least_(least) {
    constexpr int product_bits = 3 * 53, carry_bits = 6;
    size_ = static_cast<std::size_t>(largest - least + product_bits + carry_bits) / 32 + 1;
    std::fill_n(limbs_.begin(), size_, 0u);
  }

  void add(const DoubleParts& a, const DoubleParts& b, const DoubleParts& c, bool negate) {
    if (a.mantissa == 0 || b.mantissa == 0 || c.mantissa == 0) return;
    std::array<std::uint32_t, 6> product{1};
    multiply(product, a.mantissa);
    multiply(product, b.mantissa);
    multiply(product, c.mantissa);
    const int shift = a.exponent + b.exponent + c.exponent - least_;
    add_shifted(product, shift, (a.negative != b.negative) != (c.negative != negate));
  }

  int sign() const {
    if (limbs_[size_ - 1] >> 31) return -1;
    return std::any_of(limbs_.begin(), limbs_.begin() + static_cast<std::ptrdiff_t>(size_),
                       [](std::uint32_t limb) { return limb != 0; });
  }

 private:
  static void multiply(std::array<std::uint32_t, 6>& number, std::uint64_t factor) {
    const std::uint64_t low = factor & limb_mask, high = factor >> 32;
    std::uint64_t carry = 0, before = 0;
    for (std::uint32_t& limb : number) {
      const std::uint64_t of_low = limb * low, of_high = before * high;
      const std::uint64_t sum = (of_low & limb_mask) + (of_high & limb_mask) + carry;
      carry = (of_low >> 32) + (of_high >> 32) + (sum >> 32);
      before = limb;
      limb = static_cast<std::uint32_t>(sum);
    }
  }

  void add_shifted(const std::array<std::uint32_t, 6>& number, int shift, bool subtract) {
    const int bits = shift % 32;
    std::uint64_t below = 0, carry = subtract ? 1 : 0;
    std::size_t k = 0;
    for (std::size_t limb = static_cast<std::size_t>(shift) / 32; limb < size_; ++limb, ++k) {
      const std::uint64_t here = k < number.size() ? number[k] : 0;
      const auto shifted = static_cast<std::uint32_t>((here << bits) | (below >> (32 - bits)));
      below = here;
      carry += std::uint64_t{limbs_[limb]} + (subtract ? ~shifted : shifted);
      limbs_[limb] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
      if (k >= number.size() && carry == (subtract ? 1u : 0u)) return;  // nothing changes above
    }
  }

  static constexpr std::uint64_t limb_mask = 0xffffffff;
  // Exponents of a product lie between 3 · -1074 and 3 · 971.
  static constexpr std::size_t most_limbs = (3 * (971 + 1074) + 3 * 53 + 6) / 32 + 1;
  int least_;
  std::size_t size_;
  std::array<std::uint32_t, most_limbs> limbs_;
};

// Smallest and largest exponent of the nonzero coordinates along one axis.
struct Exponents {
  int least = std::numeric_limits<int>::max(), largest = std::numeric_limits<int>::min();
  void include(const DoubleParts& number) {
    if (number.mantissa == 0) return;
    least = std::min(least, number.exponent);
    largest = std::max(largest, number.exponent);
  }
  bool empty() const { return least > largest; }
};

#ifdef __SIZEOF_INT128__
__extension__ using Int128 = __int128;
__extension__ using UnsignedInt128 = unsigned __int128;

// Returns the differences x_k − x_0 of coordinates along one axis as integers, in units of a power of two.
// The unit does not change the sign of a determinant. Returns nothing if they need more than 62 bits.
template <std::size_t n>
std::optional<std::array<std::int64_t, n - 1>> integer_differences(const std::array<double, n>& x) {
  constexpr int most_bits = 61;
  std::array<DoubleParts, n> parts;
  int least = std::numeric_limits<int>::max(), end = std::numeric_limits<int>::min();
  for (std::size_t k = 0; k < n; ++k) {
    parts[k] = double_parts(x[k]);
    if (parts[k].mantissa == 0) continue;
    least = std::min(least, parts[k].exponent + std::countr_zero(parts[k].mantissa));
    end = std::max(end, parts[k].exponent + static_cast<int>(std::bit_width(parts[k].mantissa)));
  }
  std::array<std::int64_t, n - 1> differences{};
  if (end < least) return differences;
  if (end - least > most_bits) return std::nullopt;
  std::array<std::int64_t, n> integers;
  for (std::size_t k = 0; k < n; ++k) {
    const int shift = parts[k].exponent - least;
    const std::uint64_t magnitude = parts[k].mantissa == 0 ? 0
                                    : shift >= 0           ? parts[k].mantissa << shift
                                                           : parts[k].mantissa >> -shift;
    integers[k] =
        parts[k].negative ? -static_cast<std::int64_t>(magnitude) : static_cast<std::int64_t>(magnitude);
  }
  for (std::size_t k = 1; k < n; ++k) differences[k - 1] = integers[k] - integers[0];
  return differences;
}

// Returns the sign of w · m over three components, |w| < 2^62 and |m| < 2^125: 189 bits.
int sign_of_dot(const std::array<std::int64_t, 3>& w, const std::array<Int128, 3>& m) {
  Int128 high = 0;
  UnsignedInt128 low = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Int128 of_low = Int128{w[k]} * static_cast<std::uint64_t>(m[k]);
    high += Int128{w[k]} * static_cast<std::int64_t>(m[k] >> 64) + (of_low >> 64);
    low += static_cast<std::uint64_t>(of_low);
  }
  high += static_cast<Int128>(low >> 64);
  return high != 0 ? sign_of(high) : static_cast<std::uint64_t>(low) != 0;
}
#endif

}  // namespace

int exact_orient2d(const Point2& a, const Point2& b, const Point2& c) {
#ifdef __SIZEOF_INT128__
  const auto x = integer_differences<3>({a[0], b[0], c[0]}), y = integer_differences<3>({a[1], b[1], c[1]});
  if (x && y) return sign_of(Int128{(*x)[0]} * (*y)[1] - Int128{(*x)[1]} * (*y)[0]);
#endif
  return fixed_point_orient2d(a, b, c);
}

int exact_orient3d(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  // Flat faces perpendicular to an axis are the most frequent query.
  for (std::size_t k = 0; k < 3; ++k)
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k]) return 0;
#ifdef __SIZEOF_INT128__
  const auto x = integer_differences<4>({a[0], b[0], c[0], d[0]});
  const auto y = integer_differences<4>({a[1], b[1], c[1], d[1]});
  const auto z = integer_differences<4>({a[2], b[2], c[2], d[2]});
  if (x && y && z) {
    const auto minor = [](const auto& s, const auto& t) { return Int128{s[0]} * t[1] - Int128{s[1]} * t[0]; };
    return sign_of_dot({(*x)[2], (*y)[2], (*z)[2]}, {minor(*y, *z), minor(*z, *x), minor(*x, *y)});
  }
#endif
  return fixed_point_orient3d(a, b, c, d);
}

// det [b − a, c − a] = [b, c] − [a, c] + [a, b], where [p, q] = p₀q₁ − p₁q₀.
int fixed_point_orient2d(const Point2& a, const Point2& b, const Point2& c) {
  const std::array<const Point2*, 3> points{&a, &b, &c};
  std::array<std::array<DoubleParts, 2>, 3> p;
  std::array<Exponents, 2> exponents;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      p[k][axis] = double_parts((*points[k])[axis]);
      exponents[axis].include(p[k][axis]);
    }
  if (exponents[0].empty() || exponents[1].empty()) return 0;
  constexpr DoubleParts one{1, 0, false};
  ProductSum sum(exponents[0].least + exponents[1].least, exponents[0].largest + exponents[1].largest);
  const auto add = [&](std::size_t i, std::size_t j, bool negate) {
    sum.add(p[i][0], p[j][1], one, negate);
    sum.add(p[i][1], p[j][0], one, !negate);
  };
  add(1, 2, false);
  add(0, 2, true);
  add(0, 1, false);
  return sum.sign();
}

// det [b − a, c − a, d − a] = [b, c, d] − [a, c, d] + [a, b, d] − [a, b, c], where [p, q, r] is the determinant
// of the coordinates themselves.
int fixed_point_orient3d(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  const std::array<const Point3*, 4> points{&a, &b, &c, &d};
  std::array<std::array<DoubleParts, 3>, 4> p;
  std::array<Exponents, 3> exponents;
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[k][axis] = double_parts((*points[k])[axis]);
      exponents[axis].include(p[k][axis]);
    }
  int least = 0, largest = 0;
  for (const Exponents& axis : exponents) {
    if (axis.empty()) return 0;
    least += axis.least;
    largest += axis.largest;
  }
  ProductSum sum(least, largest);
  const auto add = [&](std::size_t i, std::size_t j, std::size_t k, bool negate) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
      sum.add(p[i][axis], p[j][next], p[k][last], negate);
      sum.add(p[i][axis], p[j][last], p[k][next], !negate);
    }
  };
  add(1, 2, 3, false);
  add(0, 2, 3, true);
  add(0, 1, 3, false);
  add(0, 1, 2, true);
  return sum.sign();
}

}  // namespace meshgraft
