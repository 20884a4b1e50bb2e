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
  double residual = 0.0;       // |map v - value v| of its unit vector v
};

// Keeps its memory from call to call; one thread at a time.
class Arnoldi {
 public:
  // `least` vectors are always taken (twice the number of modes plus a few), and about as many as the last call needed;
  // more until the residual is a tenth of tolerance x max(1, magnitude). The starting vector is fixed: the same calls
  // give the same bits.
  LeadingMultiplier leading(const LinearMap& map, int least, double tolerance);

  // The first `count` components of the eigenvector of the last leading().
  [[nodiscard]] std::vector<std::complex<double>> eigenvector(int count) const;

 private:
  std::complex<double> largest_ritz_value(int order);
  void find_ritz_vector();

  int size_ = 0, order_ = 0, last_order_ = 0;
  std::complex<double> value_;
  std::vector<double> basis_;       // vectors of size_, one after another
  std::vector<double> hessenberg_;  // column by column, kMostVectors + 1 rows
  std::vector<std::complex<double>> ritz_vector_;
  std::vector<double> scratch_;
};

}  // namespace stillcut
