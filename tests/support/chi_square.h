// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>

namespace nearfield::support {

/// Logarithm of the gamma function at degrees / 2, by its recurrence (std::lgamma writes a global).
inline double log_gamma_of_half(int degrees) {
    double sum = degrees % 2 == 0 ? 0.0 : 0.5 * std::log(std::acos(-1.0));
    for (int k = degrees % 2 == 0 ? 2 : 1; k < degrees; k += 2)
        sum += std::log(0.5 * k);
    return sum;
}

/// Chance that a chi-square variable of `degrees` degrees of freedom exceeds x: the regularized
/// incomplete gamma function Q(degrees / 2, x / 2), by its series below the mean and its continued
/// fraction (Lentz) above.
inline double chi_square_tail(double x, int degrees) {
    const double a = 0.5 * degrees, y = 0.5 * x;
    if (!(y > 0.0))
        return 1.0;
    const double front = std::exp(a * std::log(y) - y - log_gamma_of_half(degrees));
    if (y < a + 1.0) {
        double term = 1.0 / a, sum = term;
        for (int k = 1; k < 10000 && term > 1e-17 * sum; ++k) {
            term *= y / (a + k);
            sum += term;
        }
        return 1.0 - front * sum;
    }
    double b = y + 1.0 - a, c = 1e300, d = 1.0 / b, fraction = d;
    for (int k = 1; k < 10000; ++k) {
        const double factor = -k * (k - a);
        b += 2.0;
        d = 1.0 / (factor * d + b);
        c = b + factor / c;
        fraction *= c * d;
        if (std::abs(c * d - 1.0) < 1e-15)
            break;
    }
    return front * fraction;
}

/// The chance of counts as uneven as these or more, if every bin is equally likely and counts are
/// of independent samples.
inline double even_counts_chance(std::span<const int> counts) {
    double total = 0.0;
    for (const int count : counts)
        total += count;
    const double expected = total / static_cast<double>(counts.size());
    double sum = 0.0;
    for (const int count : counts)
        sum += (count - expected) * (count - expected) / expected;
    return chi_square_tail(sum, static_cast<int>(counts.size()) - 1);
}

}  // namespace nearfield::support
