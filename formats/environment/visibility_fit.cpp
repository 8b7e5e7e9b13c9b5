// SPDX-License-Identifier: Apache-2.0
#include "formats/environment/visibility_fit.h"

#include "formats/shared/filtered_samples.glsl.h"
#include "formats/shared/spherical_harmonics.glsl.h"

#include <cmath>

namespace nearfield::environment {
namespace {

constexpr std::size_t kCount = shared::kHarmonics;
// Of the normal matrix' diagonal for directions spread evenly: suns draw many directions to one
// place, which say nothing of the others.
constexpr double kRidge = 0.03;

using Column = std::array<double, kCount>;
using Matrix = std::array<Column, kCount>;

Column harmonics_at(glm::vec3 direction) {
    Column values{};
    for (std::size_t k = 0; k < kCount; ++k)
        values[k] = static_cast<double>(shared::harmonic(static_cast<int>(k), direction));
    return values;
}

/// Lower triangle L of a symmetric positive definite matrix L L^T.
Matrix cholesky(const Matrix& a) {
    Matrix lower{};
    for (std::size_t i = 0; i < kCount; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = a[i][j];
            for (std::size_t k = 0; k < j; ++k)
                sum -= lower[i][k] * lower[j][k];
            lower[i][j] = i == j ? std::sqrt(sum) : sum / lower[j][j];
        }
    return lower;
}

Column solve(const Matrix& lower, Column b) {
    for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t k = 0; k < i; ++k)
            b[i] -= lower[i][k] * b[k];
        b[i] /= lower[i][i];
    }
    for (std::size_t i = kCount; i-- > 0;) {
        for (std::size_t k = i + 1; k < kCount; ++k)
            b[i] -= lower[k][i] * b[k];
        b[i] /= lower[i][i];
    }
    return b;
}

}  // namespace

VisibilityFit make_visibility_fit(const LatLong& picture, const SkyTable& table, int count) {
    VisibilityFit result;
    const auto number = static_cast<shared::uint>(count);
    for (shared::uint i = 0; i < number; ++i) {
        const SkySample drawn = draw(table, shared::hammersley_point(i, number));
        if (!(drawn.density > 0.0F))
            continue;
        result.directions.push_back(drawn.direction);
        result.light.push_back(picture.radiance[picture.index(drawn.pixel)] /
                               (static_cast<float>(count) * drawn.density));
    }
    const std::size_t size = result.directions.size();
    Matrix normal{};
    const double even = static_cast<double>(count) / (4.0 * std::acos(-1.0));
    for (std::size_t i = 0; i < kCount; ++i)
        normal[i][i] = kRidge * even;
    for (const glm::vec3 direction : result.directions) {
        const Column y = harmonics_at(direction);
        for (std::size_t i = 0; i < kCount; ++i)
            for (std::size_t j = 0; j < kCount; ++j)
                normal[i][j] += y[i] * y[j];
    }
    const Matrix lower = cholesky(normal);
    result.fit.resize(kCount * size);
    for (std::size_t n = 0; n < size; ++n) {
        const Column column = solve(lower, harmonics_at(result.directions[n]));
        for (std::size_t k = 0; k < kCount; ++k)
            result.fit[k * size + n] = static_cast<float>(column[k]);
    }
    return result;
}

HarmonicValues harmonics_of(const VisibilityFit& fit, std::span<const float> values) {
    HarmonicValues harmonics{};
    for (std::size_t k = 0; k < kCount; ++k)
        for (std::size_t n = 0; n < values.size(); ++n)
            harmonics.at(k) += fit.fit[k * values.size() + n] * values[n];
    return harmonics;
}

float value_of(const HarmonicValues& harmonics, glm::vec3 direction) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < kCount; ++k)
        sum += harmonics.at(k) * shared::harmonic(static_cast<int>(k), direction);
    return sum;
}

}  // namespace nearfield::environment
