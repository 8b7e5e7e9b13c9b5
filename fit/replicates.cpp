// SPDX-License-Identifier: Apache-2.0
#include "fit/replicates.h"

#include "fit/noise.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <string>

namespace nearfield::fit {
namespace {

constexpr std::size_t kOfOptics = ~std::size_t{0};  // no texel has this number

// Deviations of all parameters together from their values; empty where nothing is known of them.
Eigen::VectorXd drawn_deviations(const rig::Rig& rig, Draw draw) {
    const auto count = static_cast<Eigen::Index>(rig.covariance_of.size());
    if (count == 0)
        return {};
    const Eigen::Map<const Eigen::MatrixXd> covariance(rig.covariance.data(), count, count);
    // Pixels and radians are far apart: scaled by its diagonal the matrix is easy.
    const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Eigen::VectorXd inverse =
        scale.unaryExpr([](double sigma) { return sigma > 0.0 ? 1.0 / sigma : 0.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(inverse.asDiagonal() * covariance *
                                                               inverse.asDiagonal());
    const NoiseKey key = noise_key(draw.seed, draw.replicate, 0, kOfOptics);
    Eigen::VectorXd numbers(count);
    for (Eigen::Index k = 0; k < count; ++k)
        numbers[k] = normal_number(key, static_cast<std::uint32_t>(k)) *
                     std::sqrt(std::max(0.0, eigen.eigenvalues()[k]));
    return scale.asDiagonal() * (eigen.eigenvectors() * numbers);
}

}  // namespace

void add_noise(const TileLayout& layout, TileRange rows, Draw draw, TileInput& tile) {
    for (std::size_t channel = 0; channel < layout.channels; ++channel)
        for (std::size_t row = 0; row < layout.rows; ++row)
            for (std::size_t i = 0; i < layout.width; ++i) {
                const std::size_t texel =
                    (static_cast<std::size_t>(rows.first_row) + row) * layout.width + i;
                const NoiseKey key = noise_key(draw.seed, draw.replicate,
                                               static_cast<std::uint32_t>(channel), texel);
                for (std::size_t k = 0; k < layout.measurements; ++k) {
                    const std::size_t at = layout.at(channel, k, layout.measurements, row, i);
                    if (std::isfinite(tile.variance[at]))
                        tile.value[at] +=
                            static_cast<float>(normal_number(key, static_cast<std::uint32_t>(k)) *
                                               std::sqrt(double(tile.variance[at])));
                }
            }
}

Optics drawn_optics(const Optics& optics, const rig::Rig& rig, Draw draw) {
    const Eigen::VectorXd deviations = drawn_deviations(rig, draw);
    const auto off = [&](const std::string& name) {
        const auto found = std::find(rig.covariance_of.begin(), rig.covariance_of.end(), name);
        return found == rig.covariance_of.end() ? 0.0
                                                : deviations[found - rig.covariance_of.begin()];
    };
    const glm::dvec2 tilt_rad(off("u_tilt_x_rad"), off("u_tilt_y_rad"));
    const glm::dvec2 pitch_rel =
        glm::dvec2(off("pitch_x_m"), off("pitch_y_m")) / rig.planes->pitch_m;
    const double skew_rad = off("skew_rad"), turn_rad = off("slab_turn_z_rad");
    const glm::dvec3 shift_m(off("slab_x_m"), off("slab_y_m"), -off("delta_m"));
    Optics drawn = optics;
    for (glm::dvec3& position_m : drawn.position_m) {
        const glm::dvec3 at_m = position_m;  // the grid's middle lies above the slab's origin
        position_m += shift_m;
        position_m.x += pitch_rel.x * at_m.x + (skew_rad - turn_rad) * at_m.y;
        position_m.y += pitch_rel.y * at_m.y + turn_rad * at_m.x;
        position_m.z += tilt_rad.x * at_m.y - tilt_rad.y * at_m.x;
    }
    drawn.filter_slope += glm::dvec2(-tilt_rad.y, tilt_rad.x);
    return drawn;
}

}  // namespace nearfield::fit
