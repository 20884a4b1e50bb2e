#include "models/hessenberg.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace stillcut {
namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();

// Column by column, like the caller's.
struct Hessenberg {
  double* data;
  int order;
  double& operator()(int i, int j) const { return data[static_cast<std::ptrdiff_t>(j) * order + i]; }
};

// The eigenvalue of larger magnitude of the 2 x 2 block at (low, low).
std::complex<double> larger_of_pair(const Hessenberg& h, int low) {
  const double a = h(low, low), d = h(low + 1, low + 1), product = h(low, low + 1) * h(low + 1, low);
  const double middle = 0.5 * (a + d), half = 0.5 * (a - d), square = half * half + product;
  if (square < 0.0) return {middle, std::sqrt(-square)};
  return middle + std::copysign(std::sqrt(square), middle);
}

// First row of the last unreduced block that ends at `high`; subdiagonals that are rounding become 0.
int start_of_block(const Hessenberg& h, int high) {
  int low = high;
  for (; low > 0; --low) {
    const double beside = std::abs(h(low - 1, low - 1)) + std::abs(h(low, low));
    if (std::abs(h(low, low - 1)) <= kRounding * beside) {
      h(low, low - 1) = 0.0;
      break;
    }
  }
  return low;
}

// One double-shift step of Francis on the block low..high (at least three rows); only the block itself is turned, as
// eigenvalues ask for no more. sum and product of the two shifts.
void francis_step(const Hessenberg& h, int low, int high, double sum, double product) {
  double x = h(low, low) * h(low, low) + h(low, low + 1) * h(low + 1, low) - sum * h(low, low) + product;
  double y = h(low + 1, low) * (h(low, low) + h(low + 1, low + 1) - sum);
  double z = h(low + 1, low) * h(low + 2, low + 1);
  for (int k = low; k < high; ++k) {
    const bool three = k + 2 <= high;
    if (!three) z = 0.0;
    const double norm = std::sqrt(x * x + y * y + z * z);
    if (norm > 0.0) {
      // The reflection that turns (x, y, z) onto its first axis: 1 - (1, v, w)^T (f, g, e).
      const double alpha = std::copysign(norm, x);
      const double f = (x + alpha) / alpha, v = y / (x + alpha), w = z / (x + alpha), g = f * v, e = f * w;
      if (k > low) {
        h(k, k - 1) = -alpha;
        h(k + 1, k - 1) = 0.0;
        if (three) h(k + 2, k - 1) = 0.0;
      }
      for (int j = k; j <= high; ++j) {
        double* column = &h(k, j);
        const double sum_of = f * column[0] + g * column[1] + (three ? e * column[2] : 0.0);
        column[0] -= sum_of;
        column[1] -= sum_of * v;
        if (three) column[2] -= sum_of * w;
      }
      const int last = std::min(high, k + 3);
      for (int i = low; i <= last; ++i) {
        const double sum_of = h(i, k) + v * h(i, k + 1) + (three ? w * h(i, k + 2) : 0.0);
        h(i, k) -= f * sum_of;
        h(i, k + 1) -= g * sum_of;
        if (three) h(i, k + 2) -= e * sum_of;
      }
    }
    if (k + 1 < high) {
      x = h(k + 1, k);
      y = h(k + 2, k);
      z = k + 3 <= high ? h(k + 3, k) : 0.0;
    }
  }
}

}  // namespace

std::complex<double> largest_eigenvalue_of_hessenberg(double* matrix, int order) {
  const Hessenberg h{matrix, order};
  std::complex<double> best = 0.0;
  const auto offer = [&](std::complex<double> value) {
    if (std::norm(value) > std::norm(best)) best = value;
  };
  constexpr int kMostSteps = 60;     // for one eigenvalue; a handful is usual
  constexpr int kUnusualEvery = 10;  // steps without success before a shift from outside breaks a cycle
  constexpr double kUnusual = 0.9375;
  int steps = 0;
  for (int high = order - 1; high >= 0;) {
    const int low = start_of_block(h, high);
    if (low == high) {
      offer(h(high, high));
      high -= 1, steps = 0;
    } else if (low + 1 == high || steps == kMostSteps) {
      offer(larger_of_pair(h, high - 1));
      high -= 2, steps = 0;
    } else {
      double sum = h(high - 1, high - 1) + h(high, high);
      double product = h(high - 1, high - 1) * h(high, high) - h(high - 1, high) * h(high, high - 1);
      if (++steps % kUnusualEvery == 0) {
        const double size = std::abs(h(high, high - 1)) + std::abs(h(high - 1, high - 2));
        sum = 1.5 * size, product = kUnusual * size * size;
      }
      francis_step(h, low, high, sum, product);
    }
  }
  return best;
}

}  // namespace stillcut
