// The eigenvalue of largest magnitude of a linear map that can only be applied, by Arnoldi's method. The period maps of
// milling smooth what they are applied to, so their eigenvalues fall off so fast that a dozen applications give the
// leading one to many digits, whatever the size of the map.
#pragma once

#include <complex>
#include <vector>

namespace stillcut {

class LinearMap {
 public:
  virtual ~LinearMap() = default;
  [[nodiscard]] virtual int size() const = 0;
  virtual void apply(const double* in, double* out) const = 0;
};

struct LeadingMultiplier {
  std::complex<double> value;  // of a conjugate pair the one with positive imaginary part
  double change = 0.0;         // of its magnitude with the last vectors added: an estimate of the error
};

// Keeps its memory from call to call; one thread at a time.
class Arnoldi {
 public:
  // `least` vectors are always taken (twice the number of modes plus a few); more until the magnitude moves by less
  // than tolerance x max(1, magnitude). The starting vector is fixed: same map, same bits.
  LeadingMultiplier leading(const LinearMap& map, int least, double tolerance);

  // The first `count` components of the eigenvector of the last leading().
  [[nodiscard]] std::vector<std::complex<double>> eigenvector(int count) const;

 private:
  std::complex<double> largest_ritz_value(int order);

  int size_ = 0, order_ = 0;
  std::complex<double> value_;
  std::vector<double> basis_;       // vectors of size_, one after another
  std::vector<double> hessenberg_;  // column by column, kMostVectors + 1 rows
  std::vector<double> scratch_;
};

}  // namespace stillcut
