// The eigenvalue of largest magnitude of a small upper Hessenberg matrix, by the shifted QR algorithm.
#pragma once

#include <complex>

namespace stillcut {

// `matrix`: order x order, column by column, nothing below the first subdiagonal; it is overwritten. Of a conjugate
// pair the one with positive imaginary part.
std::complex<double> largest_eigenvalue_of_hessenberg(double* matrix, int order);

}  // namespace stillcut
