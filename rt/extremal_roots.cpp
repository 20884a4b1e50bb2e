#include "rt/extremal_roots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

struct ValueSlope {
  double value = 0.0, slope = 0.0;
};

// The root of a function that is <= 0 at `low` and >= 0 at `high` (in that order, low > high allowed), from a guess
// between: Newton's step where it stays between the bounds, else the middle.
template <class Function>
double bracketed_root(Function function, double low, double high, double x) noexcept {
  for (int i = 0; i < 100; ++i) {
    const auto [value, slope] = function(x);
    (value < 0 ? low : high) = x;
    const double step = value / slope;
    double next = x - step;
    if (std::abs(step) <= 2 * std::numeric_limits<double>::epsilon() * std::abs(x)) return next;
    if (!((next - low) * (next - high) <= 0)) {
      next = (low + high) / 2;
      if (next == low || next == high) return next;
    }
    x = next;
  }
  return x;
}

}  // namespace

// Peak and trough free. With u = A - B: u^4 + 4 sigma u^2 - 4 D u - c^2 = 0, and A + B = c/u.
ExtremalMove root_free(const FarthestMoves& f, double distance, double low, double high) noexcept {
  const double four_sigma = 4 * f.sigma, four_d = 4 * distance, c_squared = f.c * f.c;
  // No root lies above this bound; each term that can balance u^4 has its part.
  double bound = std::max(2 * std::cbrt(std::max(distance, 0.0)), 1.1892071150027212 * std::sqrt(f.c));
  if (f.sigma < 0) bound = std::max(1.1447142425533319 * bound, std::sqrt(-3 * four_sigma));
  const double guess = std::max(std::min(bound, high), low);
  const double u = bracketed_root(
      [=](double x) {
        const double square = x * x + four_sigma;
        return ValueSlope{(square * x - four_d) * x - c_squared, 2 * x * (square + x * x) - four_d};
      },
      low, high, guess);
  const double sum = u > 0 ? f.c / u : 0.0;
  ExtremalMove move;
  move.peak = std::min((sum + u) / 2, f.m);
  move.trough = std::max((sum - u) / 2, -f.n);
  return move;
}

ExtremalMove root_peak_held(const FarthestMoves& f, double distance, double low, double high) noexcept {
  const double inverse = 1 / f.m;
  const double b = bracketed_root(
      [&](double x) {
        return ValueSlope{distance_peak_held(f, x) - distance, (f.wf + x * x - f.m * x / 2) * (2 * x * inverse - 2)};
      },
      low, high, high);
  ExtremalMove move;
  move.peak = f.m;
  move.trough = b;
  move.peak_hold = std::max(0.0, (f.c - (f.m - b) * (f.m + b)) * inverse);
  return move;
}

ExtremalMove root_trough_held(const FarthestMoves& f, double distance, double low, double high) noexcept {
  const double squared = f.c + f.n * f.n;
  const double hold = bracketed_root(
      [&](double x) {
        const double a = std::sqrt(squared + f.n * x);
        return ValueSlope{distance_trough_held(f, a, x) - distance, (f.w0 + a * a + f.n * a / 2) * (1 + f.n / a)};
      },
      low, high, high);
  ExtremalMove move;
  move.peak = std::min(std::sqrt(squared + f.n * hold), f.m);
  move.trough = -f.n;
  move.trough_hold = hold;
  return move;
}

// Both held: a quadratic for the gain g from w0 to the speed between them, with p = 1/m + 1/n:
// p g^2 + (2 w0 p + m + n) g + 2 m w0 + sigma (n - c/n) - 2 D = 0.
ExtremalMove root_both_held(const FarthestMoves& f, double distance) noexcept {
  const double p = 1 / f.m + 1 / f.n, q = f.w0 * p + (f.m + f.n) / 2;
  const double r = 2 * (f.m * f.w0 - distance) + f.sigma * (f.n - f.c / f.n);
  const double root = std::sqrt(std::max(0.0, q * q - p * r));
  // At least what the ramps between the limits gain, or rounding would take it from one hold only.
  const double least = std::max(f.m * f.m, f.c + f.n * f.n);
  const double gain = std::max(q > 0 ? -r / (q + root) : (root - q) / p, least);
  ExtremalMove move;
  move.peak = f.m;
  move.trough = -f.n;
  move.peak_hold = std::max(0.0, gain / f.m - f.m);
  move.trough_hold = std::max(0.0, (gain - f.c) / f.n - f.n);
  return move;
}

}  // namespace stillcut
